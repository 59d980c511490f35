"""Calibration from existing images or a video, without guidance."""

from __future__ import annotations

import warnings as python_warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import cast

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.diagnosis import Diagnosis, joined
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.refusals import FEWEST_VIEWS, calibrate_or_refuse
from venus3d.engine.calibration.view_selection import select_views
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.lenses import AUTO, lens_chosen
from venus3d.engine.sentences import listed
from venus3d.sources.recording import Images, OnCount, Recording, observe_recording


@dataclass(frozen=True, eq=False)
class ImagesCalibration:
    """A calibration with remarks on the images it was made from."""

    calibration: Calibration
    warnings: tuple[str, ...]
    diagnoses: tuple[Diagnosis, ...]
    """On the board and the set of views, worst first."""


def calibrate_images(
    images: Images | Sequence[Observation],
    board: Board,
    *,
    max_frames: int = 40,
    every: int | None = None,
    flip: bool = False,
    lens: str = AUTO,
) -> Calibration:
    """Detect the board in images or a video, and calibrate the camera from all that show it.

    Args:
        images: a folder, a pattern such as "shots/*.png", a video; or a list of image files, or
            one of arrays (H, W) grey or (H, W, 3) BGR, 8 or 16 bit; or observations from a
            `Detector`. One size, one camera.
        board: as printed. The other layout, white on black, another first id and another size of
            the markers are detected: `Calibration.board` is the board as it was read.
        max_frames: of a video, the maximum number of frames, the most informative ones.
        every: of a video, take every n-th frame that shows the board instead.
        flip: exchange left and right, for mirrored images; the camera is that of the flipped ones.
        lens: name of a lens model (`LENSES`); "auto": it is found out, `Calibration.lens_reason`.

    Images that cannot be read or do not show the board are left out, with a Python warning that
    names them: `len(calibration.views)` tells, and each view's `observation.name`. See `diagnose`
    for what may be wrong with the calibration.

    Raises:
        SourceError: none can be read, or they have several sizes.
        CalibrationError: fewer than three different views of the board, or views that do not
            determine the camera; or the observations are of another board.
    """
    listed = images if isinstance(images, Sequence) and not isinstance(images, str) else ()
    observations = [image for image in listed if isinstance(image, Observation)]
    if observations:
        return calibrate_or_refuse(
            _board_of(observations, board), observations, lens=lens_chosen(lens)
        )
    recorded = cast(Images, images)
    made = calibrate_recording(
        recorded, board, max_frames=max_frames, every=every, flip=flip, lens=lens
    )
    for warning in made.warnings:
        python_warnings.warn(warning, stacklevel=2)
    return made.calibration


def calibrate_recording(
    images: Images,
    board: Board,
    *,
    max_frames: int = 40,
    every: int | None = None,
    flip: bool = False,
    lens: str = AUTO,
    on_progress: Callable[[str], None] = lambda _: None,
    on_count: OnCount | None = None,
) -> ImagesCalibration:
    """`calibrate_images`, with warnings and diagnoses; `on_progress` is called with sentences,
    `on_count` after every image."""
    lens_chosen(lens)  # a wrong name is said before the work
    detector = Detector(board)
    recording = observe_recording(images, detector, on_count, flip=flip)
    seen = [o for o in recording.observations if o.count]
    warnings = [*recording.notes, *detector.notes]
    if recording.is_video:
        chosen = (
            select_views(detector.board, seen, limit=max_frames)
            if every is None
            else range(0, len(seen), every)
        )
        on_progress(
            f"Of {len(recording.observations)} frames {len(seen)} show the board; {len(chosen)} "
            f"{'is' if len(chosen) == 1 else 'are'} taken."
        )
        if len(chosen) >= FEWEST_VIEWS:  # else all of them tell why
            seen = [seen[index] for index in chosen]
    else:
        missed = [o.name for o in recording.observations if not o.count]
        if missed and seen:
            warnings.append(
                f"The board was not found in {listed(missed, most=5)}, or no more than one row of "
                "its corners, which fixes no pose."
            )
    diagnoses = _board_diagnoses(detector, recording)
    # How small the board is, the pictures that show it tell as well, with how many there are.
    another = [d for d in diagnoses if not (seen and d.kind == "small-board")]
    if len(seen) < FEWEST_VIEWS and another:
        raise CalibrationError(str(another[0]))
    calibration = calibrate_or_refuse(
        detector.board, seen, len(recording.observations), lens_chosen(lens)
    )
    found = joined(diagnoses, diagnose(calibration))
    return ImagesCalibration(calibration, tuple(warnings), found)


def _board_of(observations: Sequence[Observation], board: Board) -> Board:
    """The board as it was read, or as given if an observation does not say."""
    boards = {o.board or board for o in observations if o.count}
    if len(boards) > 1:
        raise CalibrationError(
            "The board was read in more than one layout before it was settled; detect it again in "
            "all images with the same detector."
        )
    read = boards.pop() if boards else board
    as_read = {"legacy": read.legacy, "inverted": read.inverted, "first_id": read.first_id}
    if replace(board, **as_read, marker=read.marker) != read:
        raise CalibrationError(
            "The observations are of a board with other sizes or another dictionary than the one "
            "given; use the board that the detector has."
        )
    return read


def _board_diagnoses(detector: Detector, recording: Recording) -> tuple[Diagnosis, ...]:
    return tuple(dict.fromkeys((*recording.instead, *detector.diagnoses)))
