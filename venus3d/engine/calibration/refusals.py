"""Why observations give no calibration: the true cause, in one sentence with its cure.

A fit that fails knows only that it failed. What is looked at instead, in this order: how many
pictures show the board and how large, how many of them are different, and which camera the corners
fit: a fisheye lens, or a picture that was cut out of a larger one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from venus3d.engine.calibration.adjustment import CroppedError, calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.legibility import legible_square_px, squares_px, too_small_px
from venus3d.engine.calibration.lens_choice import calibrate_with_any_lens
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.other_cameras import explained, other_cameras
from venus3d.engine.calibration.repeats import repeated
from venus3d.engine.calibration.turned_pictures import without_turned
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.lenses import LensModel
from venus3d.engine.sentences import Sentence

FEWEST_VIEWS = 3
"""Two views determine all parameters in theory only; three can contradict each other."""


_NEEDED = Sentence(
    "a calibration needs at least {fewest} different views, better 10 with the board tilted in "
    "different directions"
).format(fewest=FEWEST_VIEWS)
_NONE = Sentence(
    "The board was found in none of {looked} pictures; check its size (columns and rows swapped?), "
    "its dictionary, that the pictures are sharp, and that its squares are at least {legible} px "
    "wide."
)
_ALL_ALIKE = Sentence(
    "{counted}, but all are alike: they make 1 view, and {needed}; move the board or the camera in "
    "between."
)
_MOST_ALIKE = Sentence(
    "{counted}, but most are alike: they make {count} different views, and {needed}; move the "
    "board or the camera in between."
)
_SMALL = Sentence(
    "{counted}, and its squares are only {width} px wide there, where {legible} px are needed to "
    "read it reliably; bring it nearer, or take pictures with more pixels."
)
_FEW = Sentence("{counted}, and {needed}.")
_VIEWS = Sentence("There are {count} views of the board")
_SHOW = Sentence("{count} of {looked} pictures show the board")
_ONLY_VIEWS = (
    Sentence("There is only {count} view of the board"),
    Sentence("There are only {count} views of the board"),
)
_ONLY_SHOW = (
    Sentence("Only {count} picture shows the board"),
    Sentence("Only {count} pictures show the board"),
)
_ONLY_SHOW_OF = (
    Sentence("Only {count} of {looked} pictures shows the board"),
    Sentence("Only {count} of {looked} pictures show the board"),
)
_WITH_ENOUGH = Sentence("{counted} (a single row of its corners is not enough)")


class OtherCameraError(CalibrationError):
    """The views are from a camera that the model does not describe, however few of them fit it."""


@dataclass(frozen=True)
class _Kept:
    """What a refusal counts."""

    looked: int | None
    """Pictures looked at; None: the observations were chosen by a person or a program."""
    seen: tuple[Observation, ...]
    different: int


def calibrate_or_refuse(
    board: Board,
    observations: Sequence[Observation],
    looked: int | None = None,
    lens: LensModel | None = None,
) -> Calibration:
    """`calibrate` all parameters from at least three different views.

    Args:
        board, observations: see `calibrate`; observations without a board are not used.
        looked: the number of pictures in which the board was looked for.
        lens: None: it is found out (`lens_choice`).

    Raises:
        CalibrationError: with the cause that the observations themselves show.
    """
    seen = tuple(o for o in observations if o.count)
    if not seen and looked is not None and looked > 1:
        legible = f"{legible_square_px(board):.0f}"
        raise CalibrationError(_NONE.format(looked=looked, legible=legible))
    kept = _Kept(looked, seen, len(seen) - len(repeated(seen)))
    if seen and kept.different < FEWEST_VIEWS:
        raise CalibrationError(_too_few(board, kept))
    small_px = too_small_px(board, seen)
    try:
        if lens is None:
            calibration = calibrate_with_any_lens(board, seen)
        else:
            calibration = calibrate(board, seen, lens=lens)
    except CalibrationError as error:
        if small_px is not None:
            raise CalibrationError(_too_small(board, _counted(kept), small_px)) from error
        cause = explained(board, seen, float("inf"))
        if cause is None and isinstance(error, CroppedError):
            cause = error.diagnosis
        raise error if cause is None else OtherCameraError(str(cause)) from error
    calibration = without_turned(board, calibration)
    for cause in other_cameras(calibration):
        if small_px is not None:
            raise CalibrationError(_too_small(board, _counted(kept), small_px))
        raise OtherCameraError(str(cause))
    return calibration


def _too_few(board: Board, kept: _Kept) -> Sentence:
    count, looked = len(kept.seen), kept.looked
    if count > kept.different:
        counted = _counted(kept)
        if kept.different == 1:
            return _ALL_ALIKE.format(counted=counted, needed=_NEEDED)
        return _MOST_ALIKE.format(counted=counted, needed=_NEEDED, count=kept.different)
    said = _ONLY_VIEWS if looked is None else _ONLY_SHOW if looked == count else _ONLY_SHOW_OF
    counted = said[count > 1].format(count=count, looked=looked)
    small = min(squares_px(board, kept.seen), default=float("inf"))
    if small < legible_square_px(board):
        return _too_small(board, counted, small)
    if looked is not None and looked > count:
        counted = _WITH_ENOUGH.format(counted=counted)
    return _FEW.format(counted=counted, needed=_NEEDED)


def _counted(kept: _Kept) -> Sentence:
    said = _VIEWS if kept.looked is None else _SHOW
    return said.format(count=len(kept.seen), looked=kept.looked)


def _too_small(board: Board, counted: Sentence, width_px: float) -> Sentence:
    legible = f"{legible_square_px(board):.0f}"
    return _SMALL.format(counted=counted, width=f"{width_px:.0f}", legible=legible)
