"""Whether a camera, as a file gives it, can have taken pictures of a board, and took these."""

from __future__ import annotations

from venus3d.engine.calibration.observation import (
    Observation,
    reprojection_errors,
    rms_distance,
)
from venus3d.engine.calibration.projection_uncertainty import grid_pixels
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import FOLDED, Camera, folded_share
from venus3d.engine.geometry.pose import Pose

_GRID = (36, 24)
"""Pixels across and down at which a lens model is looked at."""
_MOST_FOLDED = 0.5
_FIELD_DEG = (0.1, 175.0)
"""Fields of view that there are: a telescope's, and what fits on a plane."""
_ANOTHER_CAMERA = 0.002
"""Rms reprojection error, as a share of the image's width, beyond which the camera is another one;
a calibrated camera has a tenth of it."""
_IN_A_ROW = 5
"""Observations that tell: of one or two, blur and motion may be the cause."""


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


class WrongCamera:
    """Notices that a board is seen as a given camera cannot see it, in any pose."""

    def __init__(self, camera: Camera, board: Board) -> None:
        """Nothing is seen yet."""
        self._camera, self._board = camera, board
        self._in_a_row = 0

    @property
    def is_sure(self) -> bool:
        """Whether the last observations all say so."""
        return self._in_a_row >= _IN_A_ROW

    def look(self, observation: Observation, pose: Pose | None) -> bool:
        """Add an observation, and its best pose under this camera; whether it is sure."""
        self._in_a_row = self._in_a_row + 1 if self._contradicts(observation, pose) else 0
        return self.is_sure

    def _contradicts(self, observation: Observation, pose: Pose | None) -> bool:
        if pose is None:
            return 2 * observation.count > self._board.corner_count
        errors = reprojection_errors(self._camera, self._board, observation, pose)
        return rms_distance(errors) > _ANOTHER_CAMERA * self._camera.width
