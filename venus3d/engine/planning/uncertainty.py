"""What the captured views tell about the camera, as frozen values that anyone may draw.

Nothing in here computes: `uncertainty` fills it.
"""

from __future__ import annotations

from dataclasses import dataclass

from venus3d.engine.geometry.pose import Array, Pose


@dataclass(frozen=True, eq=False)
class Influence:
    """What would be known without one of the views, to first order."""

    number: int
    """The view's number."""
    uncertainty_px: float
    """Expected mean projection error over the image; NaN if the others determine no camera."""
    rms_px: float
    """Root mean square reprojection distance of the others; NaN likewise."""
    parameters: Array
    """(9,) the `PARAMETERS` that the others alone say; NaN likewise."""
    sigma: Array
    """(9,) their standard deviations; NaN likewise."""


@dataclass(frozen=True, eq=False)
class ProjectionUncertainty:
    """How well a calibration knows the camera over its image, and what each view has part in."""

    uncertainty_px: float
    """Expected mean projection error over the image, pixels: the root mean square of the map."""
    uncertainty_map: Array
    """(rows, columns) expected projection error at equal cells' centres; NaN where no ray is."""
    predicted: tuple[tuple[Pose, Array], ...]
    """The target's pose and its alternatives', each with the map to expect after a view there."""
    influences: tuple[Influence, ...]
    """For each view, in their order, what would be known without it."""

    def predicted_at(self, pose: Pose) -> Array | None:
        """The map to expect after a view at this very target's pose; None if it is none of them."""
        return next((errors for known, errors in self.predicted if known is pose), None)

    def without(self, number: int) -> Influence | None:
        """What would be known without the view of this number; None if there is none."""
        return next((left for left in self.influences if left.number == number), None)
