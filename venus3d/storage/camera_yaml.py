"""camera.yaml: OpenCV's FileStorage with the keys of its calibration sample.

fs = cv2.FileStorage("camera.yaml", cv2.FILE_STORAGE_READ)
K = fs.getNode("camera_matrix").mat()
d = fs.getNode("distortion_coefficients").mat()
"""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path

import cv2
import numpy as np

from venus3d.engine.calibration.adjustment import Calibration
from venus3d.engine.errors import CalibrationError, StorageError
from venus3d.engine.geometry.camera import PARAMETERS, Camera
from venus3d.storage.folder import write_bytes


def camera_yaml(calibration: Calibration) -> str:
    """The text of camera.yaml. Pixels as in OpenCV; the board's lengths in metres."""
    camera, board = calibration.camera, calibration.board
    file = cv2.FileStorage(
        "camera.yaml",
        cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY | cv2.FILE_STORAGE_FORMAT_YAML,
    )
    file.writeComment("Camera calibration by venus3d. Pixel centres have integer coordinates.")
    file.write("calibration_time", datetime.now(timezone.utc).isoformat(timespec="seconds"))
    file.write("image_width", camera.width)
    file.write("image_height", camera.height)
    file.write("camera_matrix", camera.K)
    # One row, k1 k2 p1 p2 k3, as in OpenCV's sample.
    file.write("distortion_coefficients", camera.distortion.reshape(1, 5))
    file.writeComment(f"Standard deviations of {' '.join(PARAMETERS)}; 0: was held fixed.")
    file.write("standard_deviations", calibration.sigma.reshape(1, 9))
    file.write("avg_reprojection_error", calibration.rms_px)
    file.write("nframes", len(calibration.views))
    file.write("board_width", board.columns)
    file.write("board_height", board.rows)
    file.write("square_size", board.square)
    file.write("marker_size", board.marker)
    file.write("aruco_dictionary", board.dictionary)
    file.write("board_legacy", int(board.legacy))
    file.write("board_inverted", int(board.inverted))
    return file.releaseAndGetString()


def write_camera_yaml(path: Path | str, calibration: Calibration) -> Path:
    """Write camera.yaml. Raises `StorageError` if it cannot be written."""
    return write_bytes(Path(path), camera_yaml(calibration).encode())


def read_camera_yaml(path: Path | str) -> Camera:
    """The camera of a camera.yaml, ours or that of OpenCV's calibration sample.
    Raises `StorageError` if there is no such file or no camera in it."""
    try:
        text = Path(path).read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise StorageError(
            f"The camera file {path} cannot be read; give a camera.yaml that venus3d wrote."
        ) from error
    try:
        return _camera_of(text)
    except (cv2.error, CalibrationError, SystemError, ValueError) as error:
        raise StorageError(
            f"There is no camera in {path}; a camera.yaml holds image_width, image_height, "
            "camera_matrix and distortion_coefficients."
        ) from error


def _camera_of(text: str) -> Camera:
    file = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
    try:
        K, distortion = (
            file.getNode(name).mat() for name in ("camera_matrix", "distortion_coefficients")
        )
        size = [int(file.getNode(name).real()) for name in ("image_width", "image_height")]
        if K is None or distortion is None or np.shape(K) != (3, 3):
            raise ValueError("no camera matrix")
        return Camera.from_opencv(K, distortion, (size[0], size[1]))
    finally:
        file.release()
