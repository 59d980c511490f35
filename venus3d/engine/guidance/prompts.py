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
from venus3d.engine.sentences import listed

Phase = Literal["startup", "guiding", "captured", "converged", "finished"]
"""startup: until the first capture; guiding: a target is shown; captured: calibrating and
searching; converged: the parameters have settled; finished: ended by the user or complete."""

PARAMETER_DESCRIPTIONS = (
    "focal length, horizontal",
    "focal length, vertical",
    "image centre, horizontal",
    "image centre, vertical",
    "radial distortion, 1st",
    "radial distortion, 2nd",
    "tangential distortion, 1st",
    "tangential distortion, 2nd",
    "radial distortion, 3rd",
)
"""Descriptions of the nine parameters, in their order. The image centre is the principal point:
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


def step_prompt(step: Step) -> Prompt:
    """The instruction for one of the four steps."""
    if step.axis is None:
        return translation_prompt(step.translation)
    return turn_prompt(step.axis, step.angle_deg)


def translation_prompt(translation: ArrayLike) -> Prompt:
    """For a displacement (3,) of the board's centre in the camera's frame, metres."""
    x, y, z = (float(v) * 1000 for v in np.asarray(translation, dtype=np.float64))
    depth = _part(z, "away from the camera", "towards the camera")
    height = _part(y, "down", "up")

    def sentence(right: str, left: str) -> str:
        parts = [part for part in (_part(x, right, left), height, depth) if part]
        if not parts:
            return "The position is right; leave it."
        return "Move the board " + listed(parts) + "."

    return Prompt(
        sentence("to the right", "to the left"), sentence("to your left", "to your right")
    )


def turn_prompt(axis: Axis, angle_deg: float) -> Prompt:
    """For a signed turn about one of the camera's fixed axes, degrees."""
    amount = size_deg(angle_deg)
    if not whole(angle_deg):
        return _both(f"Nothing to turn about {axis.upper()}.")
    if axis == "x":
        edge = "top" if angle_deg > 0 else "bottom"
        return _both(f"Tilt the {edge} edge towards the camera by {amount}.")
    if axis == "y":
        seen, held = ("right", "left") if angle_deg > 0 else ("left", "right")
        return Prompt(
            f"Swing the {seen} edge towards the camera by {amount}.",
            f"Swing the edge on your {held} towards the camera by {amount}.",
        )
    seen, held = ("clockwise", "counter-clockwise")[:: 1 if angle_deg > 0 else -1]
    return Prompt(f"Rotate the board {seen} by {amount}.", f"Rotate the board {held} by {amount}.")


def _part(mm: float, positive: str, negative: str) -> str:
    return f"{size_mm(mm)} {positive if mm > 0 else negative}" if whole(mm) else ""


def _both(text: str) -> Prompt:
    return Prompt(text, text)


STEP_DONE = _both("This step is done; leave it.")
STEP_HEADLINE = "Step {number} of 4"
HOLD_HEADLINE = "Hold still"
HOLD_STILL = _both("Hold the board still.")
NOT_SEEN = _both("The board is not seen: bring it back into the picture.")
_NO_TARGET = _both(
    "Hold the board as you like, tilted and well spread over the picture, and press C."
)
FINISHED = _both("You have ended this calibration.")
ENOUGH = _both("All the views asked for are taken, and not every parameter has settled.")
STARTUP_REASON = (
    "A board tilted by 45° shows the focal length in a single picture: its far edge looks shorter."
)
GIVEN_REASON = "This pose was asked for."
ONLY_SHOWN = ("No target", _both("The board as it is held now."))

_AFTER_CAPTURE: dict[Phase, tuple[str, Prompt]] = {
    "captured": ("Captured", _both("Got it. Working out the camera and the next pose.")),
    "converged": (
        "Calibrated",
        _both("The camera is calibrated: more views change nothing that matters."),
    ),
    "finished": ("Finished", FINISHED),
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
        return "Finished", ENOUGH
    if phase in _AFTER_CAPTURE:
        return _AFTER_CAPTURE[phase]
    if not seen:
        return "Board not seen", NOT_SEEN
    return ("No target", _NO_TARGET) if current is None else current


def startup_headline_and_prompt(seen: int, corners: int) -> tuple[str, Prompt]:
    """The same before the whole board was first seen: `seen` of its `corners` are."""
    if seen == 0:
        return "Show the board", _both("Hold the board upright in front of the camera.")
    return "Show the board", _both(
        f"Move the board back until all of it is in the picture ({seen} of {corners} corners)."
    )
