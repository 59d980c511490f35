"""Pictures without lens distortion, and the camera that they are of."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import Camera


class Undistortion:
    """Undistorts pictures of one camera, as `cv2.undistort` does.

    `camera` is that of the undistorted pictures, without distortion. Its camera matrix is the same
    (alpha None), or OpenCV's optimal one: no pixel without a source (alpha 0) to every source pixel
    kept, black around (alpha 1). Raises `CalibrationError` for another alpha.
    """

    def __init__(self, camera: Camera, alpha: float | None = None) -> None:
        self.source, self.camera = camera, camera.without_distortion()
        if alpha is not None:
            if not 0 <= alpha <= 1:
                raise CalibrationError(f"alpha is from 0 to 1, not {alpha:g}.")
            K = _new_matrix(camera, alpha)
            self.camera = Camera.from_opencv(K, np.zeros(5), camera.image_size)
        u, v = np.meshgrid(
            np.arange(camera.width, dtype=np.float64), np.arange(camera.height, dtype=np.float64)
        )
        new = self.camera
        x, y = (u - new.cx) / new.fx, (v - new.cy) / new.fy
        rays = np.stack([x, y, np.ones_like(x)])
        map_x, map_y = camera.pixels_of(rays).astype(np.float32)
        # Beyond it the model folds back and would show parts of the picture twice.
        folded = ~camera.reaches(rays)
        map_x[folded] = map_y[folded] = -10
        self._maps = map_x, map_y

    def __call__(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """The picture undistorted; of the same size, depth and channels. Black where the lens saw
        nothing. Raises `CalibrationError` for a picture of another size."""
        height, width = picture.shape[:2]
        if (width, height) != self.source.image_size:
            raise CalibrationError(
                f"The pictures have {width}x{height} px and the camera "
                f"{self.source.width}x{self.source.height} px; make a camera file for their size: "
                f"venus3d export CAMERA --to opencv-yaml --size {width}x{height}."
            )
        undistorted: Any = cv2.remap(
            picture, *self._maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT
        )
        return undistorted


def _new_matrix(camera: Camera, alpha: float) -> Any:
    if camera.lens.is_perspective:
        return cv2.getOptimalNewCameraMatrix(camera.K, camera.distortion, camera.image_size, alpha)[
            0
        ]
    return cv2.fisheye.estimateNewCameraMatrixForUndistortRectify(
        camera.K, camera.distortion, camera.image_size, np.eye(3), balance=alpha
    )


def undistortion_maps(
    camera: Camera, K: NDArray[np.float64], size: tuple[int, int]
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Maps for `cv2.remap` from a camera's picture to that of a pinhole with the matrix K (3, 3),
    of this size: fast ones, exact to 1/32 px."""
    if camera.lens.is_perspective:
        one, two = cv2.initUndistortRectifyMap(
            camera.K, camera.distortion, np.eye(3), K, size, cv2.CV_16SC2
        )
        return np.asarray(one), np.asarray(two)
    u, v = np.meshgrid(np.arange(size[0], dtype=np.float64), np.arange(size[1], dtype=np.float64))
    rays = np.stack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones_like(u)])
    map_x, map_y = np.where(camera.reaches(rays), camera.pixels_of(rays), -10).astype(np.float32)
    one, two = cv2.convertMaps(map_x, map_y, cv2.CV_16SC2)
    return np.asarray(one), np.asarray(two)
