"""Whether a camera, as a file gives it, can have taken pictures of a board at all."""

from __future__ import annotations

from venus3d.engine.calibration.projection_uncertainty import grid_pixels
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import FOLDED, Camera, folded_share

_GRID = (36, 24)
"""Pixels across and down at which a lens model is looked at."""
_MOST_FOLDED = 0.5
_FIELD_DEG = (0.1, 175.0)
"""Fields of view that there are: a telescope's, and what fits on a plane."""


def lost_share(camera: Camera) -> float:
    """Share of the picture that a lens model does not reach, as it folds back; 0 if hardly any, and
    of a fisheye, which sees nothing outside its image circle. Raises `CalibrationError` for a
    camera that sees too little of its picture to be any."""
    field_deg = max(camera.fov_deg)
    if not _FIELD_DEG[0] <= field_deg <= _FIELD_DEG[1]:
        raise CalibrationError(
            f"The camera would see {field_deg:.4g}° (fx = {camera.fx:g}, fy = {camera.fy:g} for "
            f"{camera.width} x {camera.height} px), which no camera does that is calibrated with a "
            "board; focal lengths are in pixels. Give the right camera file."
        )
    folded = folded_share(camera, grid_pixels(camera.image_size, _GRID))
    if not camera.lens.is_perspective or folded <= FOLDED:
        return 0.0
    if folded > _MOST_FOLDED:
        raise CalibrationError(
            f"{folds_back(camera, folded)}, so there is nothing to see by; calibrate again, or "
            "give another camera file."
        )
    return folded


def folds_back(camera: Camera, share: float) -> str:
    """The beginning of a sentence on a share of the picture that is lost."""
    return (
        f"The camera's lens model folds back within the picture ({camera.told_distortion}): no ray "
        f"reaches {100 * share:.0f} % of it"
    )
