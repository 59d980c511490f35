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
_TIP_PX = 9.0
"""Half the width of what is kept free at an arrow's tip."""
_NEAR = 0.02


def places_apart(
    labels: Sequence[LabelShape],
    view: SceneCamera,
    window_px: tuple[int, int],
    tips: Sequence[Array] = (),
) -> list[Array]:
    """A point (3,) for each label, camera frame, metres: its own, or one below or above it in the
    window where an earlier label or an arrow's tip (3,) would be covered, and beside it where the
    window would cut it."""
    focal = window_px[1] / 2 / np.tan(view.fov_rad / 2)
    taken: list[tuple[float, float, float]] = []  # middle and half width, pixels
    places: list[Array] = []
    for tip in tips:
        x, y, z = view.axes @ (tip - view.position)
        if z >= _NEAR:
            taken.append((focal * x / z, focal * y / z, _TIP_PX))
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
        beside = [row for u, row, reach in taken if abs(u - column) < reach + half]
        row = _free_row(float(at[1]), beside)
        taken.append((column, row, half))
        aside = np.array([column, row]) - at
        places.append(label.position + aside @ view.axes[:2] * z / focal)
    return places


def _free_row(wanted: float, rows: Sequence[float]) -> float:
    """The height nearest to the wanted one that is a label's height from each of these."""
    edges = [wanted, *(row + side * HEIGHT_PX for row in rows for side in (1, -1))]
    free = [e for e in edges if all(abs(e - row) > HEIGHT_PX - 1e-6 for row in rows)]
    return min(free, key=lambda edge: abs(edge - wanted))
