"""A recorded session as a film: each view's picture with its target, and beside it the scene in
which the board comes there, under what was known then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import annotate, small_picture
from venus3d.render.describe import SceneOptions, describe
from venus3d.render.film import mp4
from venus3d.render.framing import content_of
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import picture_background, step_style
from venus3d.render.projections import Picture, with_header
from venus3d.render.scene_picture import scene_picture
from venus3d.render.shapes import Shape
from venus3d.render.viewpoints import OUTSIDE, SceneCamera, view_along
from venus3d.scene.pages.guide import replay_texts as say
from venus3d.scene.pages.guide.replay import Worker, picture_of
from venus3d.scene.pages.guide.replay_scene import seen_from, steps_to, way_of
from venus3d.scene.pages.guide.uncertainty.captured_views import captured_view_shapes
from venus3d.storage.session_moments import Moment

_SIZE, _FPS = (960, 540), 10
"""Of the camera's picture, and of the scene beside it; pictures a second."""
_ASPECT, _STILL_S = _SIZE[0] / _SIZE[1], 2


def replay_film(moments: Sequence[Moment], settings: Settings) -> bytes:
    """MP4: the board's way to each view, then for two seconds what it gave. Takes as long as the
    calibrations and searches, and seconds for each view."""
    with closing(Worker(moments, settings)) as worker:
        snapshots = worker.finish()
    with closing(Offscreen()) as offscreen:
        return mp4(_pictures(moments, snapshots, offscreen), _FPS)


def _pictures(
    moments: Sequence[Moment], snapshots: Sequence[Snapshot], offscreen: Offscreen
) -> Iterator[Picture]:
    last: Snapshot | None = None
    for moment, snapshot in zip(moments, snapshots, strict=True):
        if moment.kind == "captured":
            steps = steps_to(snapshot, last)
            way = list(way_of(snapshot, steps, _FPS, dark=True))
            seen, last = seen_from(way, steps, _FPS, _ASPECT), snapshot
        else:
            way = [_calibrated(snapshot)] * (_STILL_S * _FPS)
            seen = view_along(OUTSIDE, content_of(way[0]).points, _ASPECT)
        camera, drawn = camera_picture(moment, snapshot), way[0]
        picture = _frame(moment, snapshot, camera, _scene(offscreen, drawn, seen))
        for shapes in way:
            if shapes is not drawn:
                drawn = shapes
                picture = _frame(moment, snapshot, camera, _scene(offscreen, drawn, seen))
            yield picture


def _calibrated(snapshot: Snapshot) -> tuple[Shape, ...]:
    """The scene with all views, and the target that was then found."""
    views = captured_view_shapes(snapshot.board, snapshot.views, None, True)
    return (*describe(replace(snapshot, remaining=None, pose=None), SceneOptions()), *views)


def _scene(offscreen: Offscreen, shapes: tuple[Shape, ...], seen: SceneCamera) -> Picture:
    return scene_picture(offscreen, shapes, seen, _SIZE, dark=True).result()


def camera_picture(moment: Moment, snapshot: Snapshot) -> Picture:
    """The view as captured (RGB), with its corners and the target; bars where it is not as wide as
    the film."""
    width, height = snapshot.camera.image_size
    image = picture_of(moment)
    if image is None:
        image = np.full((height, width, 3), 40, np.uint8)
    rgb = small_picture(image, round(min(_SIZE[0], _SIZE[1] * width / height)))[: _SIZE[1]]
    annotate(rgb, snapshot, moment.seen, 4, step_style(4).colour(True))
    whole = np.empty((_SIZE[1], _SIZE[0], 3), np.uint8)
    whole[:] = picture_background(True)
    top, left = ((_SIZE[1] - rgb.shape[0]) // 2, (_SIZE[0] - rgb.shape[1]) // 2)
    whole[top : top + rgb.shape[0], left : left + rgb.shape[1]] = rgb
    return whole


def _frame(moment: Moment, snapshot: Snapshot, camera: Picture, scene: Picture) -> Picture:
    """Both pictures under what was known at this moment, with even sides."""
    step = 4 if snapshot.remaining is None else snapshot.remaining.active
    title = say.FILM_TITLES[moment.kind].format(number=moment.number)
    picture = with_header(
        np.concatenate([camera, scene], axis=1),
        str(moment.number),
        step_style(step).colour(True),
        title,
        known_sentence(moment, snapshot),
        True,
    )
    return picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2]


def known_sentence(moment: Moment, snapshot: Snapshot) -> str:
    """What was known then, in figures."""
    known, at = snapshot.calibration, f"{moment.at:%H:%M:%S}"
    if known is None or not all(known.free):
        return say.FILM_UNKNOWN.format(at=at)
    return say.FILM_KNOWN.format(
        at=at,
        views=len(known.views),
        rms=f"{known.rms_px:.3f}",
        fx=f"{known.camera.fx:.1f}",
        sigma=figure(float(known.sigma[0])),
        error=figure(known.uncertainty_px),
    )
