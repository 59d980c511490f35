"""Signs that the model does not describe these pictures: lens, focal length, board or shutter.

Part of `checks.diagnose`. The patterns are measured in `residual_patterns`, the board's bow and
stretch are estimated by `board_shape`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.board_diagnoses import MEASURE_TAGS
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.focal_changes import FocalChange, focal_change
from venus3d.engine.calibration.picture_checks import MOST_NAMED, name_of
from venus3d.engine.calibration.residual_patterns import (
    ALIKE,
    ALIKE_FAR_OFF,
    FAR_OFF,
    ON_THE_LENS,
    WHILE_READ,
    board_share,
    lens_share,
    neighbour_correlation,
    rolling_motion,
)
from venus3d.engine.sentences import Sentence, listed

ON_THE_BOARD = 0.5
"""Share of the residuals that a bent board must explain to be named."""
SOME = 1 / 3
"""Share of the views up to which those in motion are named: of more, others explain as much."""
_BOWED: tuple[tuple[Sentence, Sentence], ...] = (
    (
        Sentence(
            "The board is bowed by {bow} mm: its middle lies behind its left and right ends. The "
            "calibration allows for it."
        ),
        Sentence(
            "The board is bowed by {bow} mm: its middle lies in front of its left and right ends. "
            "The calibration allows for it."
        ),
    ),
    (
        Sentence(
            "The board is bowed by {bow} mm: its middle lies behind its upper and lower ends. The "
            "calibration allows for it."
        ),
        Sentence(
            "The board is bowed by {bow} mm: its middle lies in front of its upper and lower ends. "
            "The calibration allows for it."
        ),
    ),
)
"""Across and down; bowed away from the camera, and towards it."""
_LONG_ROWS = Sentence(
    "The print is stretched: its squares are {share} % longer along the rows than along the "
    "columns. The calibration allows for it."
)
_LONG_COLUMNS = Sentence(
    "The print is stretched: its squares are {share} % longer along the columns than along the "
    "rows. The calibration allows for it."
)
_SQUARE_AFTER_ALL = Sentence(
    "The squares are equally long along the rows and the columns, not as given. The calibration "
    "allows for it."
)
_TAGS_MEASURED = Sentence(
    "In the pictures the tags are {found} mm wide where it is {square} mm from one tag to the "
    "next, which is not as given. The calibration allows for it."
)
_ALIKE = Sentence(
    "neighbouring corners are off alike (correlation {correlation:.2f}; rms {rms} px where the "
    "corners are good for {noise} px)"
)
_ROLLING = Sentence(
    "Each picture is bent in its own way: {alike}, as a rolling shutter shears them when the board "
    "or the camera moves, or a loose board bends in the hand."
)
_HOLD_STILL = Sentence(
    "Hold still for each picture, or use a camera with a global shutter; fix the board to a flat "
    "plate."
)
_ROLLING_SOME = (
    Sentence(
        "The picture of view {views} is bent in its own way: {alike}, as a rolling shutter shears "
        "it when the board or the camera moves, or a loose board bends in the hand."
    ),
    Sentence(
        "The pictures of views {views} are bent, each in its own way: {alike}, as a rolling "
        "shutter shears them when the board or the camera moves, or a loose board bends in the "
        "hand."
    ),
)
_TAKE_AGAIN = (
    Sentence("Leave it out, or take it again while nothing moves."),
    Sentence("Leave them out, or take them again while nothing moves."),
)

_OTHER_FOCAL = (
    Sentence(
        "The picture of view {views} has a focal length that is {share} % {than} that of the "
        "others; the estimate lies in between."
    ),
    Sentence(
        "The pictures of views {views} have a focal length that is {share} % {than} that of the "
        "others; the estimate lies in between."
    ),
)
_UNFIT = (
    Sentence(
        "The picture of view {views} does not fit the others: the board or the camera moved, the "
        "board was bent, or the lens focused anew."
    ),
    Sentence(
        "The pictures of views {views} do not fit the others: the board or the camera moved, the "
        "board was bent, or the lens focused anew."
    ),
)
_UNFIT_AGAIN = (
    Sentence("Leave it out, or take it again while nothing moves, with autofocus off."),
    Sentence("Leave them out, or take them again while nothing moves, with autofocus off."),
)
_LONGER, _SHORTER = Sentence("longer than"), Sentence("shorter than")
_ONE_FOCAL = Sentence(
    "Switch autofocus and zoom off; take pictures of one camera that nothing has resized, and "
    "calibrate those of each focal length by themselves."
)

_BENDS = Sentence("The lens bends in a way that the model {lens} does not describe: {alike}.")
_ANY_LENS = Sentence("Calibrate with --lens auto, which finds the model.")


def shape(calibration: Calibration) -> Iterator[Diagnosis]:
    """A bow of the board, a stretch of its print and a side of its tags that the calibration
    found."""
    board, (across, down, stretch) = calibration.board, calibration.shape_sigma
    if calibration.marker_sigma > 0:
        found = _measured(1000 * board.marker, 1000 * calibration.marker_sigma)
        square = f"{1000 * board.square:g}"
        yield Diagnosis(
            "wrong-marker-size",
            _TAGS_MEASURED.format(found=found, square=square),
            MEASURE_TAGS.format(found=found.split()[0], square=square),
        )
    for bow, sigma, (behind, before) in zip(board.bow, (across, down), _BOWED, strict=True):
        if sigma > 0:
            yield Diagnosis(
                "bowed-board",
                (behind if bow > 0 else before).format(
                    bow=_measured(1000 * abs(bow), 1000 * sigma)
                ),
                Sentence(
                    "Fix the board to a flat plate (glass, aluminium) and calibrate again if you "
                    "need the last tenth of a pixel."
                ),
            )
    if stretch > 0 and abs(board.stretch) < 2 * stretch:
        yield Diagnosis(
            "stretched-print",
            _SQUARE_AFTER_ALL,
            Sentence("Measure squares both ways, and give --board.square-mm alone."),
        )
    elif stretch > 0:
        yield Diagnosis(
            "stretched-print",
            (_LONG_ROWS if board.stretch > 0 else _LONG_COLUMNS).format(
                share=_measured(
                    100 * abs(board.stretch) / (1 - abs(board.stretch) / 2), 100 * stretch
                )
            ),
            Sentence(
                "Measure squares both ways, and print the board again at 100 %, without fitting it "
                "to the page."
            ),
        )


def pattern(calibration: Calibration) -> Iterator[Diagnosis]:
    """Residuals that neighbouring corners share, by the lens, the board or the shutter; or pictures
    of another focal length."""
    correlation = neighbour_correlation(calibration)
    noise = np.sqrt(2) * calibration.corner_errors.noise_px
    alike = _ALIKE.format(
        correlation=correlation, rms=figure(calibration.rms_px), noise=figure(noise)
    )
    is_alike = correlation >= (ALIKE if calibration.rms_px < FAR_OFF * noise else ALIKE_FAR_OFF)
    if is_alike and lens_share(calibration) >= ON_THE_LENS:
        lens = calibration.camera.lens.name
        yield Diagnosis("wrong-lens", _BENDS.format(lens=lens, alike=alike), _ANY_LENS)
        return
    change = focal_change(calibration)
    if change is not None and change.is_sure:
        yield _other_focal(calibration, change)
        return
    unfit = change is not None and len(change.numbers) <= SOME * len(calibration.views)
    if not is_alike:
        if change is not None and unfit:
            yield _unfit(calibration, change.numbers)
        return
    if board_share(calibration) >= ON_THE_BOARD:
        yield Diagnosis(
            "bent-board",
            Sentence(
                "The board is not flat, in a way that is no simple bow: {alike}, and in the same "
                "way in every view."
            ).format(alike=alike),
            Sentence("Fix it to a flat plate (glass, aluminium) and take the views again."),
        )
        return
    motion = rolling_motion(calibration)
    if motion.share >= WHILE_READ:
        yield _rolling(calibration, motion.numbers, alike)
    elif change is not None and unfit:
        yield _unfit(calibration, change.numbers)
    else:
        yield Diagnosis(
            "poor-fit",
            Sentence("The model does not describe these pictures: {alike}.").format(alike=alike),
            Sentence(
                "Check that the board is flat, nothing moves and the pictures are neither cropped "
                "nor stabilised; a very wide lens needs another model."
            ),
        )


def _other_focal(calibration: Calibration, change: FocalChange) -> Diagnosis:
    names = [name_of(view) for view in calibration.views if view.number in change.numbers]
    cause = _OTHER_FOCAL[len(names) > 1].format(
        views=listed(names, MOST_NAMED),
        share=figure(100 * abs(change.factor - 1)),
        than=_LONGER if change.factor > 1 else _SHORTER,
    )
    return Diagnosis("changed-focal-length", cause, _ONE_FOCAL, change.numbers)


def _unfit(calibration: Calibration, numbers: tuple[int, ...]) -> Diagnosis:
    """That views were in motion, or what looks like it."""
    names = [name_of(view) for view in calibration.views if view.number in numbers]
    return Diagnosis(
        "rolling-shutter",
        _UNFIT[len(names) > 1].format(views=listed(names)),
        _UNFIT_AGAIN[len(names) > 1],
        numbers,
    )


def _rolling(calibration: Calibration, numbers: tuple[int, ...], alike: str) -> Diagnosis:
    """That all views, or those of these numbers, were in motion."""
    moved = [view for view in calibration.views if view.number in numbers]
    if not moved or len(moved) > SOME * len(calibration.views):
        return Diagnosis("rolling-shutter", _ROLLING.format(alike=alike), _HOLD_STILL)
    return Diagnosis(
        "rolling-shutter",
        _ROLLING_SOME[len(moved) > 1].format(
            views=listed([name_of(view) for view in moved]), alike=alike
        ),
        _TAKE_AGAIN[len(moved) > 1],
        numbers,
    )


def _measured(value: float, sigma: float) -> str:
    """A value and its standard deviation to one place of the latter: "1.41 ± 0.03"."""
    places = int(np.clip(-np.floor(np.log10(max(sigma, 1e-9))), 0, 2))
    return f"{value:.{places}f} ± {max(sigma, 10.0**-places):.{places}f}"
