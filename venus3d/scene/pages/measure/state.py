"""What the page knows: the tool, the points that were clicked, whether the picture is held."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.measurement import Measurement
from venus3d.engine.geometry.pose import Array
from venus3d.scene.pages.measure.texts import Tool

Point = tuple[float, float]
"""On the board's plane, in the board's frame, metres."""
CUBE_EDGE_M = 0.05


@dataclass(frozen=True)
class MeasureState:
    """The page's state."""

    tool: Tool = "length"
    points: tuple[Point, ...] = ()
    """At most two; of a cube one."""
    measured: Measurement | None = None
    """The length between two points, as measured at the second click."""
    edge_m: float = CUBE_EDGE_M
    """Of the cube, metres."""
    held: bool = False
    dark: bool = True

    @property
    def ends(self) -> Array | None:
        """(2, 3) both ends of a length in the board's frame, metres; None until there are two."""
        if self.tool != "length" or len(self.points) < 2:
            return None
        return np.array([[x, y, 0.0] for x, y in self.points])

    def clicked(self, point: Point) -> MeasureState:
        """After a click on this point: a third one begins anew."""
        full = 2 if self.tool == "length" else 1
        kept = self.points if len(self.points) < full else ()
        return replace(self, points=(*kept, point), measured=None)

    def cleared(self) -> MeasureState:
        """Without points."""
        return replace(self, points=(), measured=None) if self.points else self

    def with_tool(self, tool: Tool) -> MeasureState:
        """With another tool, which begins without points."""
        return self if tool == self.tool else replace(self, tool=tool, points=(), measured=None)
