"""The legend of the colour scale that all maps have."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from venus3d.engine.amounts import figure
from venus3d.languages import number
from venus3d.render.colour_scale import gradient_css


def scale_html(ticks: Sequence[float], unit: str) -> str:
    """The colour scale with evenly spaced numbers, the last with its unit, as HTML."""
    last = len(ticks) - 1
    figures = "".join(
        f"<span>{number(figure(tick))}{f' {escape(unit)}' if index == last else ''}</span>"
        for index, tick in enumerate(ticks)
    )
    return (
        f"<div class='v-scale'><div style='background:{gradient_css()}'></div>"
        f"<div class='v-ticks'>{figures}</div></div>"
    )
