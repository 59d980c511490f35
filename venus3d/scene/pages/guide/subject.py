"""What the scene of a guided calibration is about, and what of it a view must show."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Array
from venus3d.render.framing import Content, content_of
from venus3d.render.shapes import LineShape, Shape

_LEVEL = np.array([0.0, 0.25, 1.0])
"""Direction in which the strip of steps is seen: from behind the camera, slightly from above."""
# Where camera and board will be, before a board is seen.
_EXPECTED = np.array(np.meshgrid([-0.13, 0.13], [-0.09, 0.09], [0.0, 0.4])).reshape(3, -1).T


@dataclass(frozen=True, eq=False)
class Subject:
    """What the scene is about."""

    name: Hashable
    """Another subject is framed anew: another target, the strip of steps or the search shown or
    put away."""
    content: Content
    forward: Array | None = None
    """(3,) the direction in which it is seen; None: from where it is seen best."""

    is_empty: bool = False
    """Whether there is nothing but the camera."""


def subject_of(shapes: Iterable[Shape], target: int, steps: Iterable[Step] = ()) -> Subject:
    """The subject of these shapes; `target` is the number of the target, 0 without one, and `steps`
    are those that remain."""
    shapes = tuple(shapes)
    strip = [shape for shape in shapes if shape.name.startswith("/strip/")]
    goals = [s.pose for s in shapes if isinstance(s, LineShape) and s.name == "/target/board"]
    kinds = {shape.name.split("/")[1] for shape in shapes} & {"strip", "search", "views"}
    # Another pose with the same number is another target.
    name = (target, goals[0].vector().tobytes() if goals else b"", frozenset(kinds))
    if strip:
        return Subject(name, content_of(strip), _LEVEL)
    content = content_of(shapes, steps)
    if len(content.boards) or kinds:  # a search, which has no boards, is worth a view of its own
        return Subject(name, content)
    content = replace(content, points=np.concatenate([content.points, _EXPECTED]))
    return Subject(name, content, is_empty=True)
