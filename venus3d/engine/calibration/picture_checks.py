"""Signs in single pictures of a calibration: blurred, turned, left out, taken twice.

Part of `checks.diagnose`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.calibration import Calibration, LeftOut, LeftOutReason
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.picture_quality import least_sharpness
from venus3d.engine.calibration.turned_pictures import turned_views
from venus3d.engine.sentences import Sentence, listed

MANY_LEFT_OUT = 0.1
"""Share of the corners of one view, or of all, that is not left out without a word."""
_FEW_NAMED = 5
MOST_NAMED = 12
"""Views named one by one where each should be looked at."""
_BLURRED = Sentence(
    "The pictures are blurred: the board's edges are {width} px wide, where at most {most} px are "
    "wanted; corners are lost or less exact."
)
_FOCUS = Sentence(
    "Focus the lens at the distance of the board and lock it, wipe it, hold still, and take the "
    "pictures again."
)
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
_GONE_FROM_ONE = Sentence(
    "{out} of {every} corners fit no view and were left out, most of them in view {views}."
)
_GONE_FROM_MANY = Sentence(
    "{out} of {every} corners fit no view and were left out, most of them in views {views}."
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
_REPEATED = Sentence(
    "Of {every} views {different} are different: views {views} repeat others and do not count, as "
    "what repeats brings nothing new."
)
_REPEATED_ONE = Sentence(
    "Of {every} views {different} are different: view {views} repeats another one and does not "
    "count, as what repeats brings nothing new."
)


def blurred(calibration: Calibration) -> Iterator[Diagnosis]:
    """More than half of the views out of focus; single ones show as outlying."""
    measured = [v.observation.sharpness for v in calibration.views if v.observation.sharpness > 0]
    least = least_sharpness(calibration.camera.width)
    if measured and (usual := float(np.median(measured))) < least:
        yield Diagnosis(
            "blurred-pictures",
            _BLURRED.format(width=figure(1 / usual), most=figure(1 / least)),
            _FOCUS,
        )


def left_out(calibration: Calibration) -> Iterator[Diagnosis]:
    """Views and many corners that the calibration does without."""
    for reason, (single, plural) in _LEFT_OUT.items():
        ones = [one for one in calibration.left_out if one.reason == reason]
        if ones:
            cause, cure = plural if len(ones) > 1 else single
            yield Diagnosis(
                "left-out-view",
                cause.format(views=listed([name_of(one) for one in ones], _FEW_NAMED)),
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
                views=listed([str(n) for n in worst or counts], _FEW_NAMED),
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
            views=listed([name_of(one) for one in ones], MOST_NAMED),
            **{name: f"{value:.1f}" for name, value in places.items()},
        )
    else:
        numbers = turned_views(calibration)
        if not numbers:
            return
        names = [name_of(view) for view in calibration.views if view.number in numbers]
        cause = _TURNED_IN[len(numbers) > 1].format(views=listed(names, MOST_NAMED))
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
            views=listed([name_of(o) for o in ones], _FEW_NAMED),
        ),
        Sentence("Move and tilt the board between views."),
        tuple(one.number for one in ones),
    )


def name_of(one: LeftOut | View) -> str:
    return f"{one.number} ({one.observation.name})" if one.observation.name else f"{one.number}"
