"""A fold-out beside the sliders: the turn of the pose, or of one step, in other notations."""

from __future__ import annotations

from html import escape

import numpy as np
import viser

from venus3d.engine.amounts import signed_tenth
from venus3d.engine.geometry.notations import Notation, pose_notation, rotation_notations
from venus3d.engine.geometry.pose import Pose
from venus3d.scene.pages.teach import notations_texts as texts
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose
from venus3d.scene.web.copy_button import copy_button

_EPS = 1e-6


class NotationsPanel:
    """Created in the current panel, closed."""

    def __init__(self, gui: viser.GuiApi) -> None:
        """Nothing to see until `show`."""
        with gui.add_folder(texts.TITLE, expand_by_default=False):
            self._html = gui.add_html("")

    def show(self, taught: TaughtPose, state: TeachState) -> None:
        """Show the turn of the pose, or of the step that the board is in."""
        content = notations_html(taught, state)
        if self._html.content != content:
            self._html.content = content


def notations_html(taught: TaughtPose, state: TeachState) -> str:
    """The turn in all notations, and the pose after it in the axes of other programs."""
    if state.progress >= 4.0 - _EPS:
        before, after = Pose.identity(), taught.pose
        caption = texts.POSE_TURN.format(angle=before.angle_to_deg(after))
    else:
        step = taught.steps[state.step_and_share[0] - 1]
        before, after = step.before, step.after
        caption = texts.STEP_MOVE
        if step.axis is not None:
            axis = step.axis.upper()
            caption = texts.STEP_TURN.format(
                number=step.number, angle=signed_tenth(step.angle_deg), axis=axis
            )
    turn = Pose(after.R @ before.R.T, np.zeros(3))
    parts = [f"<p><b>{escape(caption)}</b> {escape(texts.SAME)}</p>"]
    if turn.is_gimbal_locked:
        parts.append(f"<p>{escape(texts.LOCKED)}</p>")
    written = rotation_notations(turn.R)
    for name, notation in written.items():
        decimals = 2 if name.startswith("euler") else 4
        parts.append(_row(*texts.ROTATIONS[name], notation, decimals))
    parts.append(f"<h3>{escape(texts.WHOLE)}</h3><p>{escape(texts.WHOLE_NOTE)}</p>")
    parts += [_row(*names, pose_notation(f[0], after)) for f, names in texts.FRAMES.items()]
    return f"<div class='v-progress v-notations'>{''.join(parts)}</div>"


def _row(name: str, note: str, notation: Notation, decimals: int = 4) -> str:
    rows = np.round(np.atleast_2d(notation.values), decimals) + 0.0  # no "-0.0000"
    width = decimals + (3 if decimals == 4 else 5)  # of "-1.0000", of "-180.00"
    numbers = "\n".join("  ".join(f"{v:{width}.{decimals}f}" for v in row) for row in rows)
    button = copy_button(notation.python, texts.COPY, texts.COPY_HINT)
    return (
        f"<div><div><b>{escape(name)}</b><small>{escape(note)}</small></div>{button}"
        f"<pre>{numbers}</pre></div>"
    )
