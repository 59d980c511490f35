"""The dial: what is left of the active step's degree of freedom, as SVG in HTML.

A turn is a gauge: the hand shows the board, the green band at the top the target, the arrow the
direction. A move has three straight scales. A square-root scale magnifies values near zero. Left
and right are the holder's. Sizes are in the drawing's units; each drawing is as large as what it
shows, since the letters are read at two metres.
"""

from __future__ import annotations

from html import escape

import numpy as np

from venus3d.engine.amounts import degrees, size_mm, whole
from venus3d.engine.guidance.matching import Match
from venus3d.languages import number
from venus3d.scene.pages.audience import texts

LARGEST_DEG, LARGEST_MM = 90.0, 300.0
"""The ends of the scales."""
_CENTRE, _RADIUS, _REACH_DEG = (200.0, 210.0), 150.0, 125.0
_LEFT, _RIGHT_END = -22.0, 422.0
_GAUGE, _SCALES, _TICK = (0, 16, 400, 304), (-40, 0, 480, 300), (0, 42, 400, 316)
"""What is seen of the plane: left, top, width, height."""


def share(value: float, largest: float) -> float:
    """Position of a remaining amount on its scale, -1 ... 1; 0 is the target."""
    return float(np.sign(value) * np.sqrt(min(abs(value) / largest, 1.0)))


def share_left(match: Match, step: int) -> float:
    """What is left of a step, 1 ... 4, on its scale: 0 ... 1."""
    if step == 1:
        return share(float(np.linalg.norm(match.remaining_mm)), LARGEST_MM)
    return abs(share(float(match.remaining_deg[step - 2]), LARGEST_DEG))


def dial_html(match: Match, step: int) -> str:
    """The dial of a step, 1 ... 4. CSS sets its colours: --step, --done, --text, --soft, --line."""
    return _move(match) if step == 1 else _turn(match, step)


def tick_html() -> str:
    """The tick that replaces the dial when the step is done."""
    tick = (
        "<circle cx='200' cy='200' r='150' fill='var(--done)'/>"
        "<path d='M122 206l54 56 104-116' fill='none' stroke='var(--ground)' stroke-width='34' "
        "stroke-linecap='round' stroke-linejoin='round'/>"
    )
    return _svg(tick, texts.DONE, _TICK)


def amount_text(match: Match, step: int) -> str:
    """What is left of a step, with sign and unit: "−31°" or "120 mm"."""
    if step == 1:
        return size_mm(float(np.linalg.norm(match.remaining_mm)))
    return degrees(match.remaining_deg[step - 2])


def _turn(match: Match, step: int) -> str:
    left = float(match.remaining_deg[step - 2])
    # Positive for the camera is counter-clockwise for the holder: the hand is to the right of the
    # top and moves left.
    at, band = share(left, LARGEST_DEG), share(match.limit_deg, LARGEST_DEG)
    hand, way = at * _REACH_DEG, np.sign(at) * band * _REACH_DEG
    parts = [
        _arc(-_REACH_DEG, _REACH_DEG, _RADIUS, "var(--line)", 30),
        _arc(-band * _REACH_DEG, band * _REACH_DEG, _RADIUS, "var(--done)", 30),
        *(_mark(side * share(deg, LARGEST_DEG)) for deg in (10, 30, 90) for side in (-1, 1)),
        _hand(hand),
    ]
    if abs(hand - way) > 14:
        parts.append(_arc_arrow(hand, float(way)))
    amount = amount_text(match, step)
    parts += [
        f"<text x='200' y='235' class='v-figure'>{escape(amount)}</text>",
        f"<text x='200' y='280' class='v-unit'>{escape(texts.TO_GO)}</text>",
    ]
    limit = f"{number(f'{match.limit_deg:.1f}')}°"
    return _svg("".join(parts), texts.DIAL_LABEL.format(amount=amount, limit=limit), _GAUGE)


def _move(match: Match) -> str:
    x, y, z = (float(v) for v in match.remaining_mm)
    rows = (
        # The camera's right is the holder's left.
        (-x, texts.MOVE_PARTS[0], texts.LEFT_RIGHT),
        (y, texts.MOVE_PARTS[1], texts.UP_DOWN),
        (z, texts.MOVE_PARTS[2], texts.NEAR_FAR),
    )
    parts = [
        _scale(36.0 + 100 * i, towards, match.part_limit_mm, words, ends)
        for i, (towards, words, ends) in enumerate(rows)
    ]
    label = texts.DIAL_LABEL.format(amount=amount_text(match, 1), limit=size_mm(match.limit_mm))
    return _svg("".join(parts), label, _SCALES)


def _scale(
    y: float, towards: float, band: float, words: tuple[str, str], ends: tuple[str, str]
) -> str:
    """One straight scale; the board has to move `towards` millimetres, + to the second end."""
    half = (_RIGHT_END - _LEFT) / 2

    def place(mm: float) -> float:
        return 200 + half * share(mm, LARGEST_MM)

    at, right, middle = place(-towards), abs(towards) <= band, y + 32
    second = towards > 0
    # What is near enough stands in green, and the sentence leaves it out.
    text = words[second].format(mm=abs(whole(towards))) if whole(towards) else texts.DONE
    text = f"✓ {text}" if right else text
    colour = "var(--done)" if right else "var(--step)"
    rest = "" if right else _line(at, middle, place(-np.sign(towards) * band), middle, 9)
    first_end, second_end = (
        f"<text x='{x:.0f}' y='{y:.0f}' class='v-end{' v-way' if way else ''}' "
        f"text-anchor='{anchor}'>{escape(word)}</text>"
        for x, word, anchor, way in (
            (_LEFT - 16, ends[0], "start", not right and not second),
            (_RIGHT_END + 16, ends[1], "end", not right and second),
        )
    )
    return (
        f"<text x='200' y='{y:.0f}' class='v-part' style='fill:{colour}'>{escape(text)}</text>"
        f"{first_end}{second_end}"
        f"<rect x='{_LEFT:.0f}' y='{middle - 11:.0f}' width='{2 * half:.0f}' height='22' rx='11' "
        "fill='var(--line)'/>"
        f"<rect x='{place(-band):.1f}' y='{middle - 20:.0f}' width='{2 * (place(band) - 200):.1f}' "
        f"height='40' rx='6' fill='var(--done)'/>{rest}"
        f"<circle cx='{at:.1f}' cy='{middle:.0f}' r='17' fill='{colour}' stroke='var(--ground)' "
        "stroke-width='4'/>"
    )


def _point(angle_deg: float, radius: float) -> tuple[float, float]:
    """A point on the gauge; 0 is the top, clockwise is positive."""
    angle = np.radians(angle_deg)
    return _CENTRE[0] + radius * float(np.sin(angle)), _CENTRE[1] - radius * float(np.cos(angle))


def _arc(start: float, end: float, radius: float, colour: str, width: float) -> str:
    (x, y), (u, v) = _point(start, radius), _point(end, radius)
    large, sweep = int(abs(end - start) > 180), int(end > start)
    return (
        f"<path d='M{x:.1f} {y:.1f}A{radius:.0f} {radius:.0f} 0 {large} {sweep} {u:.1f} {v:.1f}' "
        f"fill='none' stroke='{colour}' stroke-width='{width:.0f}'/>"
    )


def _arc_arrow(start: float, end: float) -> str:
    radius, head = 112.0, 11.0 * float(np.sign(end - start))
    tip, base = end, end - head
    points = [_point(tip, radius), _point(base, radius + 15), _point(base, radius - 15)]
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    shaft = _arc(start, base, radius, "var(--step)", 10)
    return f"{shaft}<polygon points='{corners}' fill='var(--step)'/>"


def _hand(angle_deg: float) -> str:
    (x, y), (u, v) = _point(angle_deg, 96), _point(angle_deg, 178)
    return (
        _line(x, y, u, v, 22, "var(--ground)")
        + _line(x, y, u, v, 14)
        + f"<circle cx='{u:.1f}' cy='{v:.1f}' r='13' fill='var(--step)'/>"
    )


def _mark(at: float) -> str:
    (x, y), (u, v) = _point(at * _REACH_DEG, 170), _point(at * _REACH_DEG, 182)
    return _line(x, y, u, v, 4, "var(--soft)")


def _line(x: float, y: float, u: float, v: float, width: float, colour: str = "var(--step)") -> str:
    return (
        f"<line x1='{x:.1f}' y1='{y:.1f}' x2='{u:.1f}' y2='{v:.1f}' stroke='{colour}' "
        f"stroke-width='{width:.0f}' stroke-linecap='round'/>"
    )


def _svg(content: str, label: str, seen: tuple[int, int, int, int]) -> str:
    box = " ".join(map(str, seen))
    return (
        f"<svg viewBox='{box}' role='img' aria-label='{escape(label, quote=True)}'>{content}</svg>"
    )
