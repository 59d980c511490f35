"""The same camera for pictures of another size: scaled, cropped or binned.

Whole pixel coordinates are pixel centres, so that a picture's borders lie at -0.5 and at its size
minus 0.5. Scaling by s takes u to s (u + 0.5) - 0.5, a crop takes u to u - offset. The distortion
acts on normalised coordinates and stays as it is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

ResizeBy = Literal["scale", "crop", "bin"]


@dataclass(frozen=True)
class Resize:
    """How pixel coordinates change: u' = scale (u + 0.5 - offset) - 0.5, in x and in y."""

    image_size: tuple[int, int]
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[int, int] = (0, 0)
    """The first pixel that is kept, before scaling."""

    def camera(self, camera: Camera) -> Camera:
        """The camera whose pictures are those of `camera`, resized."""
        (sx, sy), (ox, oy) = self.scale, self.offset
        return replace(
            camera,
            width=self.image_size[0],
            height=self.image_size[1],
            fx=camera.fx * sx,
            fy=camera.fy * sy,
            cx=(camera.cx + 0.5 - ox) * sx - 0.5,
            cy=(camera.cy + 0.5 - oy) * sy - 0.5,
        )

    def derivatives(self, camera: Camera) -> Array:
        """(p,) of the new camera's parameters by the old ones; each depends only on its own."""
        others = np.ones(len(camera.coefficients))
        return np.array([*self.scale, *self.scale, *others], dtype=np.float64)


def resize_to(
    old: tuple[int, int],
    new: tuple[int, int],
    by: ResizeBy | None = None,
    offset: tuple[int, int] | None = None,
) -> Resize:
    """How a picture of one size (width, height) becomes one of another size.

    Without `by`, a picture of the same shape is scaled. Raises `CalibrationError` for another shape
    without `by`, since either the field of view or the pixels' shape must change then, and for
    sizes that `by` cannot reach.
    """
    if offset is not None and by != "crop":
        raise CalibrationError("An offset is that of a crop; give it with --by crop.")
    if by is None and old[0] * new[1] != old[1] * new[0]:
        raise CalibrationError(_question(old, new))
    if by == "crop":
        return _crop(old, new, offset)
    if by == "bin":
        return _bin(old, new)
    return Resize(new, (new[0] / old[0], new[1] / old[1]))


def _question(old: tuple[int, int], new: tuple[int, int]) -> str:
    was, becomes = _text(old), _text(new)
    return (
        f"{becomes} px has another shape than {was} px: does the camera show less of the scene at "
        f"{becomes} than at {was} (then --by crop), or the same scene squeezed (then --by scale)? "
        "Hold a ruler before it in both modes to see which; for a crop that is also scaled, export "
        "twice."
    )


def _crop(old: tuple[int, int], new: tuple[int, int], offset: tuple[int, int] | None) -> Resize:
    x, y = ((old[0] - new[0]) // 2, (old[1] - new[1]) // 2) if offset is None else offset
    if x < 0 or y < 0 or x + new[0] > old[0] or y + new[1] > old[1]:
        at = "" if offset is None else f" at {x},{y}"
        raise CalibrationError(
            f"{_text(new)} px{at} cannot be cropped from {_text(old)} px; it would reach beyond "
            "the picture."
        )
    return Resize(new, offset=(x, y))


def _bin(old: tuple[int, int], new: tuple[int, int]) -> Resize:
    x, y = old[0] // new[0], old[1] // new[1]
    # What is left over at the right and at the bottom is dropped.
    if x < 1 or y < 1 or old[0] // x != new[0] or old[1] // y != new[1]:
        raise CalibrationError(
            f"Binning whole pixels of {_text(old)} px does not give {_text(new)} px; take --by "
            "scale or --by crop."
        )
    return Resize(new, (1 / x, 1 / y))


def _text(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"
