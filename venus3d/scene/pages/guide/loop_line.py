"""The loop of the method as a line of five boxes above the page, for teaching how it works: the
part that goes on now is lit, each part has its figure. Its numbers are the snapshot's."""

from __future__ import annotations

from html import escape

import numpy as np

from venus3d.engine.amounts import UNKNOWN, duration, figure
from venus3d.engine.guidance.loop import LOOP, Loop, LoopPart
from venus3d.scene.pages.guide import texts as say


def loop_html(loop: Loop) -> str:
    """The five boxes."""
    boxes = "".join(_box(number, part, loop) for number, part in enumerate(LOOP, start=1))
    return f"<div class='v-loop' role='status'>{boxes}</div>"


def _box(number: int, part: LoopPart, loop: Loop) -> str:
    name, does = say.LOOP_PARTS[part]
    value, about = _figure(part, loop)
    lit = " class='v-on'" if part == loop.active else ""
    return (
        f"<div{lit} data-part='{part}' title='{escape(does)}'><b>{number}</b>"
        f"<strong>{escape(name)}</strong><em>{escape(value)}</em><span>{escape(about)}</span></div>"
    )


def _figure(part: LoopPart, loop: Loop) -> tuple[str, str]:
    """The part's figure, and what stands below it."""
    if part == "detect":
        return duration(loop.detect_s), say.LOOP_CORNERS.format(count=loop.corners)
    if part == "calibrate":
        views = say.LOOP_VIEW if loop.views == 1 else say.LOOP_VIEWS.format(count=loop.views)
        about = say.LOOP_RMS.format(views=views, rms=figure(loop.rms_px)) if loop.views else ""
        return duration(loop.calibrate_s), about
    if part == "search":
        return duration(loop.search_s), say.LOOP_POSES.format(count=loop.poses)
    if part == "decompose":
        if loop.steps_left is None:
            return UNKNOWN, say.LOOP_STEPS
        left = say.LOOP_STEP_LEFT if loop.steps_left == 1 else say.LOOP_STEPS_LEFT
        return left.format(count=loop.steps_left), say.LOOP_STEPS
    if not np.isfinite(loop.after_px):
        return UNKNOWN, say.LOOP_GAIN
    if not np.isfinite(loop.before_px):
        return say.LOOP_FIRST_GAIN.format(after=figure(loop.after_px)), say.LOOP_GAIN
    before, after = figure(loop.before_px), figure(loop.after_px)
    return say.LOOP_GAINED.format(before=before, after=after), say.LOOP_GAIN
