"""Arrows that point along the line of sight, as curved ones that face the eye.

Seen along itself an arrow is a dot. Then a flat one is drawn in its place, bent like those in the
pictures of the steps: from the tail towards the tip as they appear in the window, and growing if
the tip is nearer.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import trimesh

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.framing import FLATTEST_ARROW_DEG
from venus3d.render.shapes import MeshShape, Shape
from venus3d.render.viewpoints import SceneCamera

_SHORTEST, _LONGEST = 0.08, 0.16
"""From end to end, of the distance from the eye; in between as long as the arrow itself."""
_BEND, _WIDTH = 0.45, 0.075
"""The bend and half the width at most, of that length."""
_HEAD_WIDTH, _HEAD_SHARE = 2.6, 0.3
_THIN = 0.4
"""Width at the far end, of that at the near one."""
_STEPS = 24


def facing(shape: Shape, view: SceneCamera) -> Shape:
    """The shape, or its curved arrow if it is an arrow that points along the line of sight."""
    if not isinstance(shape, MeshShape) or shape.ends is None:
        return shape
    return _facing(shape, view) if points_along_sight(shape, view) else shape


def points_along_sight(arrow: MeshShape, view: SceneCamera) -> bool:
    """Whether an arrow points along the line of sight, within the angle of a good view."""
    tail, tip = _ends(arrow)
    along, sight = tip - tail, (tail + tip) / 2 - view.position
    cosine = abs(along @ sight) / max(float(np.linalg.norm(along) * np.linalg.norm(sight)), 1e-12)
    return bool(cosine > np.cos(np.radians(FLATTEST_ARROW_DEG)))


def _ends(arrow: MeshShape) -> Array:
    assert arrow.ends is not None
    return arrow.pose.apply(arrow.ends)


@lru_cache(maxsize=16)
def _facing(arrow: MeshShape, view: SceneCamera) -> MeshShape:
    tail, tip = _ends(arrow)
    axes = view.axes
    local = (np.stack([tail, tip]) - view.position) @ axes.T
    centre = view.position + local.mean(axis=0) @ axes
    distance = float(local[:, 2].mean())
    seen = local[:, :2] / local[:, 2:]
    direction = seen[1] - seen[0]
    length = float(np.linalg.norm(direction))
    direction = direction / length if length > 1e-4 else np.array([0.0, -1.0])
    grows = bool(local[1, 2] < local[0, 2])
    true = float(np.linalg.norm(tip - tail))
    mesh = _bent(float(np.clip(true, _SHORTEST * distance, _LONGEST * distance)), grows)
    aside = np.array([-direction[1], direction[0]])
    # The mesh's x runs from tail to tip, its y to the bent side.
    R = np.column_stack([direction @ axes[:2], aside @ axes[:2], axes[2]])
    return MeshShape(
        arrow.name, mesh, Pose(R, centre), arrow.colour, arrow.opacity, on_top=arrow.on_top
    )


def _bent(length: float, grows: bool) -> trimesh.Trimesh:
    """A flat arrow in z = 0 from (-length / 2, 0) to (length / 2, 0), bent towards +y, metres."""
    share = np.linspace(0, 1, _STEPS)[:, None]
    start, bend, end = np.array([[-0.5, 0.0], [0.0, 2 * _BEND], [0.5, 0.0]]) * length
    path = (1 - share) ** 2 * start + 2 * share * (1 - share) * bend + share**2 * end
    along = 2 * (1 - share) * (bend - start) + 2 * share * (end - bend)
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    aside = np.column_stack([-along[:, 1], along[:, 0]])
    thin, thick = _THIN * _WIDTH * length, _WIDTH * length
    first, last = (thin, thick) if grows else (thick, thin)
    width = first + (last - first) * share
    neck = int((1 - _HEAD_SHARE) * _STEPS)
    left, right = path + aside * width, path - aside * width
    head = _HEAD_WIDTH * width[neck]
    points = np.concatenate(
        [
            left[: neck + 1],
            right[: neck + 1],
            [path[neck] + aside[neck] * head, path[neck] - aside[neck] * head, path[-1]],
        ]
    )
    low = np.arange(neck)
    high = neck + 1 + low
    tip = 2 * (neck + 1)
    faces = np.concatenate(
        [
            np.column_stack([low, low + 1, high]),
            np.column_stack([low + 1, high + 1, high]),
            [[tip, tip + 2, tip + 1]],
        ]
    )
    vertices = np.column_stack([points, np.zeros(len(points))])
    return trimesh.Trimesh(vertices=vertices, faces=faces, process=False)
