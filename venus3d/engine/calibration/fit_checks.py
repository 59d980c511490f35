"""Signs that the model does not describe these pictures: what was left out, and what is wrong.

Part of `checks.diagnose`. The patterns are measured in `residual_patterns`, the board's bow and
stretch are estimated by `board_shape`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.board_diagnoses import MEASURE_TAGS
from venus3d.engine.calibration.calibration import Calibration, LeftOut, LeftOutReason
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.focal_changes import focal_change
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.residual_patterns import (
    ALIKE,
    ON_THE_LENS,
    WHILE_READ,
    board_share,
    lens_share,
    neighbour_correlation,
    rolling_motion,
)
from venus3d.engine.calibration.turned_pictures import turned_views
from venus3d.engine.sentences import Sentence, listed

ON_THE_BOARD = 0.5
"""Share of the residuals that a bent board must explain to be named."""
SOME = 1 / 3
"""Share of the views up to which those in motion are named: of more, others explain as much."""
MANY_LEFT_OUT = 0.1
"""Share of the corners of one view, or of all, that is not left out without a word."""
_MOST_NAMED = 5

_LEFT_OUT: dict[LeftOutReason, tuple[tuple[Sentence, Sentence], tuple[Sentence, Sentence]]] = {
    "undetermined": (
        (
            Sentence(
                "View {views} was left out: it shows too few corners, or corners on one line only, "
                "and fixes no pose."
            ),
            Sentence("Show more of the board there, or leave it out."),
        ),
        (
            Sentence(
                "Views {views} were left out: each shows too few corners, or corners on one line "
                "only, and fixes no pose."
            ),
            Sentence("Show more of the board there, or leave them out."),
        ),
    ),
    "misfit": (
        (
            Sentence("View {views} was left out: it fits no pose of this board."),
            Sentence(
                "Look at it: is it another board, or was it misread or blurred? Take it again."
            ),
        ),
        (
            Sentence("Views {views} were left out: each fits no pose of this board."),
            Sentence(
                "Look at them: is it another board, or was it misread or blurred? Take them again."
            ),
        ),
    ),
}
"""Cause and cure, for one view and for several."""
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
_GONE_FROM_ONE = Sentence(
    "{out} of {every} corners fit no view and were left out, most of them in view {views}."
)
_GONE_FROM_MANY = Sentence(
    "{out} of {every} corners fit no view and were left out, most of them in views {views}."
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

_TURNED_OUT = (
    Sentence(
        "View {views} was left out: its picture is turned by 180° against the others. The "
        "principal point is at ({x}, {y}) px in it and at ({cx}, {cy}) px in the others."
    ),
    Sentence(
        "Views {views} were left out: their pictures are turned by 180° against the others. The "
        "principal point is at ({x}, {y}) px in them and at ({cx}, {cy}) px in the others."
    ),
)
_TURNED_IN = (
    Sentence(
        "The picture of view {views} is turned by 180° against the others, and so is the "
        "principal point: the estimate of it lies in between."
    ),
    Sentence(
        "The pictures of views {views} are turned by 180° against the others, and so is the "
        "principal point: the estimate of it lies in between."
    ),
)
_TURN_BACK = Sentence(
    "Turn back what a phone or a program turned, so that all pictures lie as the camera read "
    "them, and calibrate again; a camera held upside down turns nothing."
)
_MOST_TURNED = 12
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
_LONGER, _SHORTER = Sentence("longer than"), Sentence("shorter than")
_ONE_FOCAL = Sentence(
    "Switch autofocus and zoom off; take pictures of one camera that nothing has resized, and "
    "calibrate those of each focal length by themselves."
)


_BENDS = Sentence("The lens bends in a way that the model {lens} does not describe: {alike}.")
_ANY_LENS = Sentence("Calibrate with --lens auto, which finds the model.")
_REPEATED = Sentence(
    "Of {every} views {different} are different: views {views} repeat others and do not count, as "
    "what repeats brings nothing new."
)
_REPEATED_ONE = Sentence(
    "Of {every} views {different} are different: view {views} repeats another one and does not "
    "count, as what repeats brings nothing new."
)


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


def left_out(calibration: Calibration) -> Iterator[Diagnosis]:
    """Views and many corners that the calibration does without."""
    for reason, (single, plural) in _LEFT_OUT.items():
        ones = [one for one in calibration.left_out if one.reason == reason]
        if ones:
            cause, cure = plural if len(ones) > 1 else single
            yield Diagnosis(
                "left-out-view",
                cause.format(views=listed([_name(one) for one in ones], _MOST_NAMED)),
                cure,
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
            (_GONE_FROM_ONE if len(worst) == 1 else _GONE_FROM_MANY).format(
                out=out,
                every=every,
                views=listed([str(n) for n in worst or counts], _MOST_NAMED),
            ),
            Sentence(
                "Look for glare, a hand over the board or blur there, and take those views again."
            ),
            worst,
        )


def turned(calibration: Calibration) -> Iterator[Diagnosis]:
    """Pictures that are turned by 180° among the others."""
    ones = [one for one in calibration.left_out if one.reason == "turned"]
    if ones:
        camera = calibration.camera
        x, y = camera.width - 1 - camera.cx, camera.height - 1 - camera.cy
        places = {"x": x, "y": y, "cx": camera.cx, "cy": camera.cy}
        numbers = tuple(one.number for one in ones)
        cause = _TURNED_OUT[len(ones) > 1].format(
            views=listed([_name(one) for one in ones], _MOST_TURNED),
            **{name: f"{value:.1f}" for name, value in places.items()},
        )
    else:
        numbers = turned_views(calibration)
        if not numbers:
            return
        names = [_name(view) for view in calibration.views if view.number in numbers]
        cause = _TURNED_IN[len(numbers) > 1].format(views=listed(names, _MOST_TURNED))
    yield Diagnosis("turned-pictures", cause, _TURN_BACK, numbers)


def repeats(calibration: Calibration) -> Iterator[Diagnosis]:
    """Views that count once with another one."""
    ones = [one for one in calibration.left_out if one.reason == "repeat"]
    if not ones:
        return
    different = len(calibration.views)
    yield Diagnosis(
        "repeated-views",
        (_REPEATED if len(ones) > 1 else _REPEATED_ONE).format(
            every=different + len(ones),
            different=different,
            views=listed([_name(o) for o in ones], _MOST_NAMED),
        ),
        Sentence("Move and tilt the board between views."),
        tuple(one.number for one in ones),
    )


def pattern(calibration: Calibration) -> Iterator[Diagnosis]:
    """Residuals that neighbouring corners share, by the lens, the board or the shutter; or pictures
    of another focal length."""
    correlation = neighbour_correlation(calibration)
    noise = np.sqrt(2) * calibration.corner_errors.noise_px
    alike = _ALIKE.format(
        correlation=correlation, rms=figure(calibration.rms_px), noise=figure(noise)
    )
    if correlation >= ALIKE and lens_share(calibration) >= ON_THE_LENS:
        lens = calibration.camera.lens.name
        yield Diagnosis("wrong-lens", _BENDS.format(lens=lens, alike=alike), _ANY_LENS)
        return
    change = focal_change(calibration)
    if change is not None:
        names = [_name(view) for view in calibration.views if view.number in change.numbers]
        cause = _OTHER_FOCAL[len(names) > 1].format(
            views=listed(names, _MOST_TURNED),
            share=figure(100 * abs(change.factor - 1)),
            than=_LONGER if change.factor > 1 else _SHORTER,
        )
        yield Diagnosis("changed-focal-length", cause, _ONE_FOCAL, change.numbers)
        return
    if not correlation >= ALIKE:
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
    else:
        yield Diagnosis(
            "poor-fit",
            Sentence("The model does not describe these pictures: {alike}.").format(alike=alike),
            Sentence(
                "Check that the board is flat, nothing moves and the pictures are neither cropped "
                "nor stabilised; a very wide lens needs another model."
            ),
        )


def _rolling(calibration: Calibration, numbers: tuple[int, ...], alike: str) -> Diagnosis:
    """That all views, or those of these numbers, were in motion."""
    moved = [view for view in calibration.views if view.number in numbers]
    if not moved or len(moved) > SOME * len(calibration.views):
        return Diagnosis("rolling-shutter", _ROLLING.format(alike=alike), _HOLD_STILL)
    return Diagnosis(
        "rolling-shutter",
        _ROLLING_SOME[len(moved) > 1].format(
            views=listed([_name(view) for view in moved]), alike=alike
        ),
        _TAKE_AGAIN[len(moved) > 1],
        numbers,
    )


def _name(one: LeftOut | View) -> str:
    return f"{one.number} ({one.observation.name})" if one.observation.name else f"{one.number}"


def _measured(value: float, sigma: float) -> str:
    """A value and its standard deviation to one place of the latter: "1.41 ± 0.03"."""
    places = int(np.clip(-np.floor(np.log10(max(sigma, 1e-9))), 0, 2))
    return f"{value:.{places}f} ± {max(sigma, 10.0**-places):.{places}f}"
