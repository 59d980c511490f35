"""camera.yaml: OpenCV's FileStorage with the keys of its calibration sample.

fs = cv2.FileStorage("camera.yaml", cv2.FILE_STORAGE_READ)
K = fs.getNode("camera_matrix").mat()
d = fs.getNode("distortion_coefficients").mat()

`storage/formats/opencv.py` is the format itself.
"""

from __future__ import annotations

from pathlib import Path

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.errors import CalibrationError, StorageError
from venus3d.engine.geometry.camera import Camera
from venus3d.regular_file import read_regular
from venus3d.storage.folder import write_bytes
from venus3d.storage.formats.opencv import opencv_text, read_opencv
from venus3d.storage.formats.record import CameraRecord


def camera_yaml(calibration: Calibration) -> str:
    """The text of camera.yaml. Pixels as in OpenCV; the board's lengths in metres."""
    return opencv_text(CameraRecord.of(calibration))


def write_camera_yaml(path: Path | str, calibration: Calibration) -> Path:
    """Write camera.yaml. Raises `StorageError` if it cannot be written."""
    return write_bytes(Path(path), camera_yaml(calibration).encode())


def read_camera_yaml(path: Path | str) -> Camera:
    """The camera of a camera.yaml, ours or that of OpenCV's calibration sample.
    Raises `StorageError` if there is no such file or no camera in it."""
    try:
        content = read_regular(Path(path))
        content.decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise StorageError(
            f"The camera file {path} cannot be read; give a camera.yaml that venus3d wrote."
        ) from error
    try:
        return read_opencv(content).camera
    except (CalibrationError, ValueError) as error:
        raise StorageError(
            f"There is no camera in {path}; a camera.yaml holds image_width, image_height, "
            "camera_matrix and distortion_coefficients."
        ) from error
