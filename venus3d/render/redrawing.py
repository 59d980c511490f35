"""When the remaining steps must be drawn again: a drawing stays while the board moves a little, and
the words and amounts beside it are those of the moment."""

from __future__ import annotations

import numpy as np

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.guidance.remaining import RemainingSteps, has_left_the_way

_TREMOR_MM, _TREMOR_DEG = 2.0, 0.7
LEFT_MM, LEFT_DEG = 30.0, 10.0
"""Distance from the way that was drawn at which it is drawn again."""
_SAME_DIRECTION = 0.5
"""Cosine of the angle between two moves that point the same way."""


def looks_alike(drawn: RemainingSteps | None, now: RemainingSteps | None) -> bool:
    """Whether the board has hardly moved: an arrow in the scene may stay where it is."""
    if drawn is None or now is None:
        return drawn is now
    return (
        _same_work(drawn, now)
        and 1000 * drawn.start.distance_to(now.start) < _TREMOR_MM
        and drawn.start.angle_to_deg(now.start) < _TREMOR_DEG
    )


def still_shows(drawn: RemainingSteps | None, now: RemainingSteps | None) -> bool:
    """Whether pictures of the steps may stay (the paper's lazy loading): the same steps are to be
    done in the same directions, and the board is near the way that they show."""
    if drawn is None or now is None:
        return drawn is now
    return (
        _same_work(drawn, now)
        and all(_same_direction(a, b) for a, b, done in _pairs(drawn, now) if not done)
        and not has_left_the_way(drawn.steps, now.start, mm=LEFT_MM, deg=LEFT_DEG)
    )


def shows_another(drawn: RemainingSteps, now: RemainingSteps) -> tuple[bool, ...]:
    """Of each step's picture, whether it shows another step than is to be done now: that of another
    target, without an arrow, or with one that points elsewhere."""
    if drawn.steps[3].after is not now.steps[3].after or drawn.from_upright != now.from_upright:
        return (True,) * 4
    return tuple(
        not is_done and (was_done or not _same_direction(a, b))
        for (a, b, is_done), was_done in zip(_pairs(drawn, now), drawn.done, strict=True)
    )


def _same_work(drawn: RemainingSteps, now: RemainingSteps) -> bool:
    """Whether they lead to the same target, and the same steps are done."""
    return (
        drawn.steps[3].after is now.steps[3].after
        and drawn.from_upright == now.from_upright
        and drawn.done == now.done
        and drawn.is_over == now.is_over
    )


def _pairs(drawn: RemainingSteps, now: RemainingSteps) -> list[tuple[Step, Step, bool]]:
    return list(zip(drawn.steps, now.steps, now.done, strict=True))


def _same_direction(one: Step, other: Step) -> bool:
    if one.axis is not None:
        return bool(np.sign(one.angle_deg) == np.sign(other.angle_deg))
    a, b = one.translation, other.translation
    return bool(a @ b >= _SAME_DIRECTION * np.linalg.norm(a) * np.linalg.norm(b))
