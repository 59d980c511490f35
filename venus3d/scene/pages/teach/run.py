"""The teaching page: opens camera, board and lessons, works poses out, serves until stopped."""

from __future__ import annotations

from contextlib import closing
from functools import partial
from pathlib import Path

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.decomposition import decompose_vector, home_pose
from venus3d.engine.geometry.rotation_orders import is_almost_locked, turns
from venus3d.engine.planning.focal_uncertainty import focal_sigma, focal_words
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.refusals import refusals
from venus3d.lessons.lesson import Lesson
from venus3d.lessons.reading import lesson_of, shipped_lessons
from venus3d.scene.pages.teach.export.files import KINDS, Kind, exported, kind_of, lesson_of_pose
from venus3d.scene.pages.teach.options import TeachOptions
from venus3d.scene.pages.teach.state import TeachState, Vector
from venus3d.scene.pages.teach.view_model import TeachMoment
from venus3d.scene.pages.teach.viewer import TeachViewer
from venus3d.scene.render.offscreen import Offscreen
from venus3d.storage.camera_yaml import read_camera_yaml
from venus3d.threads.latency import low_latency


class PoseStudy:
    """Takes poses of one board apart, as one camera sees it."""

    def __init__(self, camera: Camera, board: Board) -> None:
        """The limits are the board's and the camera's own."""
        self._camera, self._board = camera, board
        self._limits = Limits.for_board(board, camera)

    def __call__(self, vector: Vector, order: str = "zyx") -> TeachMoment:
        """All that is shown of a pose: degrees and millimetres; `order` is compared with xyz."""
        camera, board = self._camera, self._board
        p = np.array([*vector[:3], *(length / 1000 for length in vector[3:])])
        steps = decompose_vector(p, camera, board)
        pose = steps[3].after
        sigma = focal_sigma(camera, board, pose)
        return TeachMoment(
            camera=camera,
            board=board,
            pose=pose,
            steps=steps,
            refusals=refusals(self._limits, camera, board, p),
            fixed=turns(home_pose(), p[:3]),
            own=turns(home_pose(), p[:3], axes="own"),
            reordered=turns(home_pose(), p[:3], order=order),
            order=order,
            locked=is_almost_locked(p[1]),
            sigma_px=sigma,
            sigma_words=focal_words(sigma, camera),
        )


def run_teach(options: TeachOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can mend."""
    board = options.board.board()
    camera = PAPER_CAMERA if options.camera is None else read_camera_yaml(options.camera)
    lessons, chosen = _lessons(options.lesson)
    study = PoseStudy(camera, board)
    with closing(Offscreen()) as offscreen:
        viewer = TeachViewer(
            study,
            offscreen,
            camera,
            host=options.host,
            port=options.port,
            lessons=lessons,
            lesson=chosen,
            save=partial(_saved, study, offscreen),
            kinds=KINDS,
        )
        with closing(viewer), low_latency():
            for note in viewer.notes:
                print(note, flush=True)
            print(f"Lessons: {viewer.url}   (Ctrl-C ends it)", flush=True)
            while True:
                viewer.wait(1.0)


def _saved(
    study: PoseStudy, offscreen: Offscreen, state: TeachState, kind: str
) -> tuple[str, bytes]:
    """Name and content of a file of what the page shows: the lesson, or the pose if none is open;
    a picture is always of the pose."""
    lesson = state.current_lesson
    if lesson is None or kind == "png":
        lesson = lesson_of_pose(state.vector)
    files = exported(lesson, kind_of(Path(f"lesson.{kind}")), study, offscreen, dark=state.dark)
    return f"venus3d-{lesson.name}.{kind}", files[0]


def export_lesson(options: TeachOptions, kind: Kind) -> tuple[tuple[bytes, ...], str]:
    """The chosen lesson's files of this kind, and why the painter drew them if OpenGL did not.

    Raises `VenusError` for whatever the user can mend.
    """
    board = options.board.board()
    camera = PAPER_CAMERA if options.camera is None else read_camera_yaml(options.camera)
    lesson = lesson_of(options.lesson)
    with closing(Offscreen()) as offscreen:
        study = PoseStudy(camera, board)
        note = offscreen.note  # one that comes later is logged
        return exported(lesson, kind, study, offscreen, dark=options.dark), note


def _lessons(choice: str) -> tuple[tuple[Lesson, ...], int | None]:
    """All lessons, an own one first, and the number of the one that was chosen."""
    shipped = shipped_lessons()
    if not choice and not shipped:
        return (), None
    lesson = lesson_of(choice)
    if lesson in shipped:
        return shipped, shipped.index(lesson)
    return (lesson, *shipped), 0
