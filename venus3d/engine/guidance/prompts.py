"""The words of guidance, in one place: short sentences for the camera's and for the holder's side.

Signs (DESIGN): +X brings the top edge towards the camera, +Y the edge on the image's right, +Z
turns the board clockwise in the image. The holder faces the camera, so left and right, clockwise
and counter-clockwise swap for them; up, down, nearer and farther do not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Axis
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.phase import Phase

PARAMETER_WORDS = (
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
"""What each of the nine parameters is, in their order. The image centre is the principal point:
where the optical axis meets the picture."""


@dataclass(frozen=True)
class Words:
    """One instruction in two wordings."""

    camera: str
    """As seen in the camera's picture."""
    holder: str
    """As seen by the person who holds the board and faces the camera."""


def step_words(step: Step) -> Words:
    """What to do in one of the four steps."""
    if step.axis is None:
        return words_for_move(step.translation)
    return words_for_turn(step.axis, step.angle_deg)


def words_for_move(translation: ArrayLike) -> Words:
    """Words for a displacement (3,) of the board's centre in the camera's frame, metres."""
    x, y, z = (float(v) * 1000 for v in np.asarray(translation, dtype=np.float64))
    depth = _part(z, "away from the camera", "towards the camera")
    height = _part(y, "down", "up")

    def sentence(right: str, left: str) -> str:
        parts = [part for part in (_part(x, right, left), height, depth) if part]
        if not parts:
            return "The position is right; leave it."
        return "Move the board " + _listed(parts) + "."

    return Words(sentence("to the right", "to the left"), sentence("to your left", "to your right"))


def words_for_turn(axis: Axis, angle_deg: float) -> Words:
    """Words for a signed turn about one of the camera's fixed axes, degrees."""
    amount = f"{abs(angle_deg):.0f}°"
    if abs(angle_deg) < 0.5:
        return Words(*(2 * (f"Nothing to turn about {axis.upper()}.",)))
    if axis == "x":
        edge = "top" if angle_deg > 0 else "bottom"
        return Words(*(2 * (f"Tilt the {edge} edge towards the camera by {amount}.",)))
    if axis == "y":
        seen, held = ("right", "left") if angle_deg > 0 else ("left", "right")
        return Words(
            f"Swing the {seen} edge towards the camera by {amount}.",
            f"Swing the edge on your {held} towards the camera by {amount}.",
        )
    seen, held = ("clockwise", "counter-clockwise")[:: 1 if angle_deg > 0 else -1]
    return Words(f"Rotate the board {seen} by {amount}.", f"Rotate the board {held} by {amount}.")


def _part(mm: float, positive: str, negative: str) -> str:
    return "" if abs(mm) < 0.5 else f"{abs(mm):.0f} mm {positive if mm > 0 else negative}"


def _listed(parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def words_for_startup(seen: int, corners: int) -> Words:
    """What to do before the whole board has been seen once; `seen` of `corners` are visible."""
    if seen == 0:
        text = "Hold the board upright in front of the camera."
        return Words(text, text)
    text = f"Move the board back until all of it is in the picture ({seen} of {corners} corners)."
    return Words(text, text)


NOT_SEEN = Words(
    "The board is not seen: bring it back into the picture.",
    "The board is not seen: bring it back into the picture.",
)
NO_TARGET = Words(
    "Hold the board as you like, tilted and well spread over the picture, and press C.",
    "Hold the board as you like, tilted and well spread over the picture, and press C.",
)
STEP_RIGHT = Words("This step is right; leave it.", "This step is right; leave it.")
HOLD_STILL = Words("Hold the board still.", "Hold the board still.")
CALCULATING = Words(
    "Got it. Working out the camera and the next pose.",
    "Got it. Working out the camera and the next pose.",
)
CONVERGED = Words(
    "The camera is calibrated: more views change nothing that matters.",
    "The camera is calibrated: more views change nothing that matters.",
)
FINISHED = Words("You have ended this calibration.", "You have ended this calibration.")
ENOUGH = Words(
    "All the views asked for are taken, and not every parameter has settled. U takes the last one "
    "back; --max-views allows more.",
    "All the views asked for are taken, and not every parameter has settled. U takes the last one "
    "back; --max-views allows more.",
)
STARTUP_REASON = (
    "A board tilted by 45° shows the focal length in a single picture: its far edge looks shorter."
)

_STATES = {
    "captured": ("Captured", CALCULATING),
    "converged": ("Calibrated", CONVERGED),
    "finished": ("Finished", FINISHED),
}


def said(phase: Phase, match: Match | None, seen: bool, by_user: bool = True) -> tuple[str, Words]:
    """Headline and instruction.

    `seen` is whether the board is, `by_user` who has ended it; `match` is None without a target.
    """
    if phase == "finished" and not by_user:
        return "Finished", ENOUGH
    if phase in _STATES:
        return _STATES[phase]
    if not seen:
        return "Board not seen", NOT_SEEN
    if match is None:
        return "No target", NO_TARGET
    if match.reached or all(match.within):
        return "Hold still", HOLD_STILL
    return f"Step {match.active_step} of 4", step_words(match.steps[match.active_step - 1])


def said_at_startup(corners: int, board: Board) -> tuple[str, Words]:
    """The same while nothing is known yet and `corners` of the board are seen."""
    return "Show the board", words_for_startup(corners, board.corner_count)
