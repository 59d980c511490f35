"""Signs that the model does not describe these pictures: what was left out, and what is wrong.

Part of `checks.diagnose`. The patterns are measured in `residual_patterns`, the board's bow and
stretch are estimated by `board_shape`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.adjustment import Calibration, LeftOut, LeftOutReason
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.residual_patterns import (
    board_share,
    neighbour_correlation,
    rolling_share,
)
from venus3d.engine.sentences import listed

ALIKE = 0.6
"""Correlation of neighbouring corners' residuals from which the model lacks something."""
ON_THE_BOARD, WHILE_READ = 0.5, 0.9
"""Shares of the residuals that a bent board and a rolling shutter must explain to be named."""
MANY_LEFT_OUT = 0.1
"""Share of the corners of one view, or of all, that is not left out without a word."""
_MOST_NAMED = 5

_WHY: dict[LeftOutReason, str] = {
    "undetermined": "shows too few corners, or corners on one line only, and fixes no pose",
    "misfit": "fits no pose of this board",
}
_RETAKE: dict[LeftOutReason, str] = {
    "undetermined": "Show more of the board there, or leave it out.",
    "misfit": "Look at it: is it another board, or was it misread or blurred? Take it again.",
}


def shape(calibration: Calibration) -> Iterator[Diagnosis]:
    """A bow of the board and a stretch of its print that the calibration found."""
    board, (across, down, stretch) = calibration.board, calibration.shape_sigma
    for bow, sigma, along in (
        (board.bow[0], across, "left and right ends"),
        (board.bow[1], down, "upper and lower ends"),
    ):
        if sigma > 0:
            where = "behind" if bow > 0 else "in front of"
            yield Diagnosis(
                "bowed-board",
                f"The board is bowed by {_measured(1000 * abs(bow), 1000 * sigma)} mm: its middle "
                f"lies {where} its {along}. The calibration allows for it.",
                "Fix the board to a flat plate (glass, aluminium) and calibrate again if you need "
                "the last tenth of a pixel.",
            )
    if stretch > 0:
        long, short = ("rows", "columns") if board.stretch > 0 else ("columns", "rows")
        yield Diagnosis(
            "stretched-print",
            f"The print is stretched: its squares are "
            f"{_measured(100 * abs(board.stretch), 100 * stretch)} % longer along the {long} than "
            f"along the {short}. The calibration allows for it.",
            "Measure squares both ways, and print the board again at 100 %, without fitting it to "
            "the page.",
        )


def left_out(calibration: Calibration) -> Iterator[Diagnosis]:
    """Views and many corners that the calibration does without."""
    for reason in _WHY:
        ones = [one for one in calibration.left_out if one.reason == reason]
        if ones:
            several = len(ones) > 1
            why = _WHY[reason] if not several else f"each {_WHY[reason]}"
            yield Diagnosis(
                "left-out-view",
                f"View{'s' if several else ''} {listed([_name(o) for o in ones], _MOST_NAMED)} "
                f"{'were' if several else 'was'} left out: {why if several else f'it {why}'}.",
                _RETAKE[reason].replace(" it", " them") if several else _RETAKE[reason],
                tuple(one.number for one in ones),
            )
    counts = {
        v.number: (0 if v.left_out is None else v.left_out.count, v.observation.count)
        for v in calibration.views
    }
    out = sum(gone for gone, _ in counts.values())
    every = out + sum(kept for _, kept in counts.values())
    worst = tuple(n for n, (gone, kept) in counts.items() if gone > MANY_LEFT_OUT * (gone + kept))
    if worst or out > MANY_LEFT_OUT * every:
        yield Diagnosis(
            "left-out-corners",
            f"{out} of {every} corners fit no view and were left out, most of them in view"
            f"{'s' if len(worst) != 1 else ''} "
            f"{listed([str(n) for n in worst or counts], _MOST_NAMED)}.",
            "Look for glare, a hand over the board or blur there, and take those views again.",
            worst,
        )


def pattern(calibration: Calibration) -> Iterator[Diagnosis]:
    """Residuals that neighbouring corners share: the board, the shutter or the lens."""
    correlation = neighbour_correlation(calibration)
    if not correlation >= ALIKE:
        return
    noise = np.sqrt(2) * calibration.corner_errors.noise_px
    alike = (
        f"neighbouring corners are off alike (correlation {correlation:.2f}; rms "
        f"{figure(calibration.rms_px)} px where the corners are good for {figure(noise)} px)"
    )
    if board_share(calibration) >= ON_THE_BOARD:
        yield Diagnosis(
            "bent-board",
            f"The board is not flat, in a way that is no simple bow: {alike}, and in the same way "
            "in every view.",
            "Fix it to a flat plate (glass, aluminium) and take the views again.",
        )
    elif rolling_share(calibration) >= WHILE_READ:
        yield Diagnosis(
            "rolling-shutter",
            f"The board or the camera moved while pictures were read row by row: {alike}, as a "
            "rolling shutter shears them.",
            "Hold still for each picture, use shorter exposures, or a camera with a global "
            "shutter.",
        )
    else:
        yield Diagnosis(
            "poor-fit",
            f"The model does not describe these pictures: {alike}.",
            "Check that the board is flat, nothing moves and the pictures are neither cropped nor "
            "stabilised; a very wide lens needs another model.",
        )


def _name(one: LeftOut) -> str:
    return f"{one.number} ({one.observation.name})" if one.observation.name else f"{one.number}"


def _measured(value: float, sigma: float) -> str:
    """A value and its standard deviation to one place of the latter: "1.41 ± 0.03"."""
    places = int(np.clip(-np.floor(np.log10(max(sigma, 1e-9))), 0, 2))
    return f"{value:.{places}f} ± {max(sigma, 10.0**-places):.{places}f}"
