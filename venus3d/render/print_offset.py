"""A smooth displacement of a board's print within its plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.pose import Array


@dataclass(frozen=True)
class PrintOffset:
    """A sum of waves over the board. Hashable, so that meshes may be cached by it."""

    waves: tuple[tuple[float, ...], ...]
    """Each: its height along x and y in metres, its periods per metre along x and y, its phase."""

    def at(self, points: Array) -> Array:
        """(N, 2) displacement in metres at board points (N, 2)."""
        waves = np.array(self.waves)
        phases = 2 * np.pi * points @ waves[:, 2:4].T + waves[:, 4]
        return np.asarray(np.cos(phases) @ waves[:, :2])
