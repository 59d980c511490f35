"""Where labels stand on a screen, so that none covers another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.render.shapes import LabelShape
from venus3d.render.text_drawing import pill_width
from venus3d.render.viewpoints import SceneCamera

HEIGHT_PX = 30.0
"""Of a label, with a gap below it."""
PILL_PX = 0.86 * HEIGHT_PX
"""Height of the label itself."""
_BESIDE_PX = 4.0
_TIP_PX, _SHAFT_PX = 9.0, 3.0
"""Half the width of what is kept free at an arrow's tip, and along it."""
_FARTHEST_PX = 2.5 * HEIGHT_PX
"""How far a label is moved off an arrow's shaft: farther away it would not belong to it."""
_NEAR = 0.02


def places_apart(
    labels: Sequence[LabelShape],
    view: SceneCamera,
    window_px: tuple[int, int],
    tips: Sequence[Array] = (),
    shafts: Array | None = None,
) -> list[Array]:
    """A point (3,) for each label, camera frame, metres: its own, or one below or above it in the
    window where an earlier label or an arrow would be covered, and beside it where the window would
    cut it.

    Args:
        tips: (3,) where each arrow points; always left free.
        shafts: (N, 3) points on the arrows; left free where that is near.
    """
    focal = window_px[1] / 2 / np.tan(view.fov_rad / 2)
    taken = _taken(_seen(np.array(tips), view, focal), _TIP_PX, HEIGHT_PX)
    by_shafts = np.zeros((0, 3)) if shafts is None else shafts
    shaft = _taken(_seen(by_shafts, view, focal), _SHAFT_PX, PILL_PX / 2 + _SHAFT_PX)
    places: list[Array] = []
    for label in labels:
        x, y, z = view.axes @ (label.position - view.position)
        if z < _NEAR:  # behind the eye
            places.append(label.position)
            continue
        at = focal * np.array([x, y]) / z
        # Drawn finely, as it is in the scene: letters of whole pixels are wider or narrower.
        half = pill_width(label.text, round(4 * PILL_PX)) / 8 + _BESIDE_PX / 2
        column, room = float(at[0]), window_px[0] / 2 - half
        if abs(column) < window_px[0] / 2 and room > 0:
            column = float(np.clip(column, -room, room))
        row = _free_row(column, float(at[1]), half, np.vstack([taken, shaft]))
        if abs(row - at[1]) > _FARTHEST_PX:
            row = _free_row(column, float(at[1]), half, taken)
        taken = np.vstack([taken, [column, row, half, HEIGHT_PX]])
        aside = np.array([column, row]) - at
        places.append(label.position + aside @ view.axes[:2] * z / focal)
    return places


def _taken(points: Array, half_width: float, apart: float) -> Array:
    """(N, 4) places that a label's middle must be away from: these points (N, 2), the half width
    that is kept free there, and how far above or below it the label's middle must be; pixels."""
    return np.column_stack([points, np.tile([half_width, apart], (len(points), 1))])


def _seen(points: Array, view: SceneCamera, focal: float) -> Array:
    """(M, 2) the points (N, 3) that are before the eye, pixels from the window's middle."""
    local = (points.reshape(-1, 3) - view.position) @ view.axes.T
    local = local[local[:, 2] >= _NEAR]
    return focal * local[:, :2] / local[:, 2:]


def _free_row(column: float, wanted: float, half: float, taken: Array) -> float:
    """The height nearest to the wanted one at which a label of this half width is far enough from
    each of these places (N, 4)."""
    beside = taken[np.abs(taken[:, 0] - column) < taken[:, 2] + half]
    rows, apart = beside[:, 1], beside[:, 3]
    edges = np.concatenate([[wanted], rows + apart, rows - apart])
    free = edges[(np.abs(edges[:, None] - rows) > apart - 1e-6).all(axis=1)]
    return float(free[np.argmin(np.abs(free - wanted))])
