"""The line of the method's loop: five boxes, one lit, each with the snapshot's figure."""

from __future__ import annotations

import re

from venus3d.engine.guidance.loop import LOOP, Loop
from venus3d.scene.pages.guide.loop_line import loop_html


def boxes(loop: Loop) -> list[tuple[str, ...]]:
    """Part, figure and what stands below it."""
    found = re.findall(r"data-part='(\w+)'.*?<em>(.*?)</em><span>(.*?)</span>", loop_html(loop))
    return [tuple(box) for box in found]


def test_each_part_has_its_figure() -> None:
    loop = Loop(
        active="search",
        detect_s=0.0124,
        corners=40,
        calibrate_s=0.0855,
        views=5,
        rms_px=0.0451,
        search_s=1.26,
        poses=3053,
        steps_left=1,
        before_px=0.0681,
        after_px=0.0549,
    )
    assert boxes(loop) == [
        ("detect", "12 ms", "40 corners"),
        ("calibrate", "86 ms", "5 views, rms 0.045 px"),
        ("search", "1.3 s", "3053 poses"),
        ("decompose", "1 step", "to the target"),
        ("capture", "0.068 → 0.055 px", "uncertainty"),
    ]


def test_what_is_not_known_is_a_dash() -> None:
    assert [figure for _, figure, _ in boxes(Loop())] == ["–"] * 5


def test_only_the_active_part_is_lit() -> None:
    assert "v-on" not in loop_html(Loop())
    for part in LOOP:
        lit = re.findall(r"<div class='v-on' data-part='(\w+)'", loop_html(Loop(active=part)))
        assert lit == [part]
