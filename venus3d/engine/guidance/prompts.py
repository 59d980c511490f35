"""The sentences of guidance, from the camera's and from the holder's point of view.

Signs (docs/conventions.md): +X brings the top edge towards the camera, +Y the edge on the image's
right, +Z turns the board clockwise in the image. The holder faces the camera, so left and right,
clockwise and counter-clockwise swap for them; up, down, nearer and farther do not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.amounts import size_deg, size_mm, whole
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Axis
from venus3d.engine.sentences import Sentence, listed

Phase = Literal["startup", "guiding", "captured", "converged", "finished"]
"""startup: until the first capture; guiding: a target is shown; captured: calibrating and
searching; converged: the parameters have settled; finished: ended by the user or complete."""

PARAMETER_DESCRIPTIONS = {
    "fx": Sentence("focal length, horizontal"),
    "fy": Sentence("focal length, vertical"),
    "cx": Sentence("image centre, horizontal"),
    "cy": Sentence("image centre, vertical"),
    "k1": Sentence("radial distortion, 1st"),
    "k2": Sentence("radial distortion, 2nd"),
    "p1": Sentence("tangential distortion, 1st"),
    "p2": Sentence("tangential distortion, 2nd"),
    "k3": Sentence("radial distortion, 3rd"),
    "k4": Sentence("radial distortion, 4th"),
    "k5": Sentence("radial distortion, 5th"),
    "k6": Sentence("radial distortion, 6th"),
    "s1": Sentence("thin prism, 1st"),
    "s2": Sentence("thin prism, 2nd"),
    "s3": Sentence("thin prism, 3rd"),
    "s4": Sentence("thin prism, 4th"),
}
"""Descriptions of the parameters by name. The image centre is the principal point:
where the optical axis meets the image."""


Wording = Literal["holder", "camera"]
"""Whose left and right are meant: the holder's, or those of the camera's image."""


@dataclass(frozen=True)
class Prompt:
    """One instruction in two wordings."""

    camera: str
    """As seen in the camera's image."""
    holder: str
    """As seen by the person who holds the board and faces the camera."""

    def text(self, wording: Wording) -> str:
        """The sentence in this wording."""
        return self.holder if wording == "holder" else self.camera


_MOVE, _NO_MOVE = (
    Sentence("Move the board {parts}."),
    Sentence("The position is right; leave it."),
)
_RIGHT, _LEFT = Sentence("{mm} to the right"), Sentence("{mm} to the left")
_YOUR_RIGHT, _YOUR_LEFT = Sentence("{mm} to your right"), Sentence("{mm} to your left")
_DOWN, _UP = Sentence("{mm} down"), Sentence("{mm} up")
_AWAY, _NEARER = Sentence("{mm} away from the camera"), Sentence("{mm} towards the camera")
_NO_TURN = Sentence("Nothing to turn about {axis}.")
_TOP = Sentence("Tilt the top edge towards the camera by {amount}.")
_BOTTOM = Sentence("Tilt the bottom edge towards the camera by {amount}.")
_CLOCKWISE = Sentence("Rotate the board clockwise by {amount}.")
_COUNTER = Sentence("Rotate the board counter-clockwise by {amount}.")
_TURNS: dict[tuple[Axis, bool], tuple[Sentence, Sentence]] = {
    ("x", True): (_TOP, _TOP),
    ("x", False): (_BOTTOM, _BOTTOM),
    ("y", True): (
        Sentence("Swing the right edge towards the camera by {amount}."),
        Sentence("Swing the edge on your left towards the camera by {amount}."),
    ),
    ("y", False): (
        Sentence("Swing the left edge towards the camera by {amount}."),
        Sentence("Swing the edge on your right towards the camera by {amount}."),
    ),
    ("z", True): (_CLOCKWISE, _COUNTER),
    ("z", False): (_COUNTER, _CLOCKWISE),
}
"""By axis and whether the turn is positive: for the camera, for the holder."""


def step_prompt(step: Step) -> Prompt:
    """The instruction for one of the four steps."""
    if step.axis is None:
        return translation_prompt(step.translation)
    return turn_prompt(step.axis, step.angle_deg)


def translation_prompt(translation: ArrayLike, near_mm: float = 0.0) -> Prompt:
    """For a displacement (3,) of the board's centre in the camera's frame, metres. Parts of at most
    `near_mm` are left out, unless all are."""
    mm = 1000 * np.asarray(translation, dtype=np.float64)
    near = np.abs(mm) <= near_mm
    x, y, z = (float(v) for v in (mm if near.all() else np.where(near, 0.0, mm)))
    others = [*_part(y, _DOWN, _UP), *_part(z, _AWAY, _NEARER)]

    def sentence(right: Sentence, left: Sentence) -> str:
        parts = [*_part(x, right, left), *others]
        return _MOVE.format(parts=listed(parts)) if parts else _NO_MOVE

    return Prompt(sentence(_RIGHT, _LEFT), sentence(_YOUR_LEFT, _YOUR_RIGHT))


def turn_prompt(axis: Axis, angle_deg: float) -> Prompt:
    """For a signed turn about one of the camera's fixed axes, degrees."""
    amount = size_deg(angle_deg)
    if not whole(angle_deg):
        return _both(_NO_TURN.format(axis=axis.upper()))
    seen, held = _TURNS[axis, angle_deg > 0]
    return Prompt(seen.format(amount=amount), held.format(amount=amount))


def _part(mm: float, positive: Sentence, negative: Sentence) -> tuple[Sentence, ...]:
    """This part of a move; none if it rounds to nothing."""
    return ((positive if mm > 0 else negative).format(mm=size_mm(mm)),) if whole(mm) else ()


def _both(text: str) -> Prompt:
    return Prompt(text, text)


STEP_DONE = _both(Sentence("This step is done; leave it."))
STEP_HEADLINE = Sentence("Step {number} of 4")
HOLD_HEADLINE = Sentence("Hold still")
HOLD_STILL = _both(Sentence("Hold the board still."))
NOT_SEEN = _both(Sentence("Show the whole board to the camera: near enough, and not edge-on."))
_NO_TARGET = _both(
    Sentence("Hold the board as you like, tilted and well spread over the picture, and press C.")
)
FINISHED = _both(Sentence("You have ended this calibration."))
ENOUGH = _both(Sentence("All the views asked for are taken, and not every parameter has settled."))
STARTUP_REASON = Sentence(
    "A board tilted by 45° shows the focal length in a single picture: its far edge looks shorter."
)
GIVEN_REASON = Sentence("This pose was asked for.")
_NO_TARGET_HEADLINE = Sentence("No target")
ONLY_SHOWN = (_NO_TARGET_HEADLINE, _both(Sentence("The board as it is held now.")))
_FINISHED_HEADLINE = Sentence("Finished")
_REFUSED_HEADLINE = Sentence("Not captured yet")
_NOT_SEEN_HEADLINE = Sentence("Board not seen")
_SHOW_HEADLINE = Sentence("Show the board")
_SHOW = _both(Sentence("Hold the board upright in front of the camera."))
_MOVE_BACK = Sentence(
    "Move the board back until all of it is in the picture ({seen} of {corners} corners)."
)

CALCULATING = (
    Sentence("Calculating"),
    _both(Sentence("Working out the camera and the next pose.")),
)
"""Where no view was captured just now: after an undo, a skipped target, another method."""

_COME_NEARER = Sentence(
    "All of the board is in the picture, but only {seen} of its {corners} corners can be read: "
    "bring it nearer, and cover none of it."
)

_AFTER_CAPTURE: dict[Phase, tuple[str, Prompt]] = {
    "captured": (
        Sentence("Captured"),
        _both(Sentence("Got it. Working out the camera and the next pose.")),
    ),
    "converged": (
        Sentence("Calibrated"),
        _both(Sentence("The camera is calibrated: more views change nothing that matters.")),
    ),
    "finished": (_FINISHED_HEADLINE, FINISHED),
}


def headline_and_prompt(
    phase: Phase, current: tuple[str, Prompt] | None, seen: bool, by_user: bool = True
) -> tuple[str, Prompt]:
    """Two or three words for the state, and the one instruction to follow now.

    Args:
        current: `RemainingSteps.current`; None without a target.
        seen: whether the board is seen.
        by_user: whether the user ended the session.
    """
    if phase == "finished" and not by_user:
        return _FINISHED_HEADLINE, ENOUGH
    if phase in _AFTER_CAPTURE:
        return _AFTER_CAPTURE[phase]
    if not seen:
        return _NOT_SEEN_HEADLINE, NOT_SEEN
    return (_NO_TARGET_HEADLINE, _NO_TARGET) if current is None else current


def refusal_headline_and_prompt(refusal: Sentence) -> tuple[str, Prompt]:
    """The same at a target where no view is captured, with the reason."""
    return _REFUSED_HEADLINE, _both(refusal)


def startup_headline_and_prompt(
    seen: int, corners: int, *, inside: bool = False
) -> tuple[str, Prompt]:
    """The same before the whole board was first seen: `seen` of its `corners` are. `inside`: all of
    them are in the picture."""
    if seen == 0:
        return _SHOW_HEADLINE, _SHOW
    missing = _COME_NEARER if inside else _MOVE_BACK
    return _SHOW_HEADLINE, _both(missing.format(seen=seen, corners=corners))
