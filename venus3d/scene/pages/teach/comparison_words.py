"""Texts about the two boards of a comparison."""

from __future__ import annotations

from dataclasses import dataclass

from venus3d.render.amounts import degrees
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose


@dataclass(frozen=True)
class ComparisonWords:
    """The comparison's texts at one moment."""

    headline: str
    amount: str
    sentence: str
    turn: int | None = None
    """1 ... 3: the current turn; None before the first and after the last."""
    axis: int = 0
    """0 ... 2: axis of the left board's turn."""


def comparison_words(taught: TaughtPose, state: TeachState) -> ComparisonWords:
    """The texts for this moment."""
    step, sweep = state.step_and_share
    others = taught.others(state.arrangement)
    if step == 1:
        return ComparisonWords(texts.COMPARE_START, "", texts.COMPARE_PROMPT)
    left, right = taught.fixed[step - 2], others[step - 2]
    names = left.axis.upper(), right.axis.upper()
    if step == 4 and sweep == 1.0:
        apart = taught.apart_deg(state.arrangement)
        same = apart < 0.05
        amount = texts.SAME if same else texts.APART.format(degrees=apart)
        sentence = texts.SAME_LABEL if same else texts.APART_LABEL
        return ComparisonWords(texts.COMPARE_END, amount, sentence.capitalize() + ".")
    text = texts.COMPARE_TURN if names[0] == names[1] else texts.COMPARE_TURN_TWO
    headline = text.format(number=step - 1, left=names[0], right=names[1])
    sentence = texts.COMPARE_SENTENCES[state.arrangement].format(
        axis=names[0],
        left_axis=names[0],
        right_axis=names[1],
        left=degrees(left.angle_deg),
        right=degrees(right.angle_deg),
    )
    amount = degrees(sweep * left.angle_deg) if names[0] == names[1] else ""
    return ComparisonWords(headline, amount, sentence, step - 1, "xyz".index(left.axis))
