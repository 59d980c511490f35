"""ROS: the YAML file of camera_calibration_parsers, which camera drivers read into
`sensor_msgs/CameraInfo` (K, D, R, P).

https://github.com/ros-perception/image_common, camera_calibration_parsers/src/parse_yml.cpp. Pixels
as in OpenCV. P is [K | 0]: the rectified picture has the same focal lengths and centre.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import yaml

from venus3d.engine.errors import StorageError
from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord

_MODELS = {"brown5": "plumb_bob", "rational": "rational_polynomial", "fisheye": "equidistant"}
"""What ROS (sensor_msgs/distortion_models.hpp) calls the lens models."""


def write(record: CameraRecord) -> bytes:
    """The text of a camera_info file."""
    camera = record.camera
    content = {
        "image_width": camera.width,
        "image_height": camera.height,
        "camera_name": "camera",
        "camera_matrix": _matrix(camera.K),
        "distortion_model": _MODELS[camera.lens.name],
        "distortion_coefficients": _matrix(camera.distortion.reshape(1, -1)),
        "rectification_matrix": _matrix(np.eye(3)),
        "projection_matrix": _matrix(np.hstack([camera.K, np.zeros((3, 1))])),
    }
    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=200).encode()


def read(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of a camera_info file, or of the message itself as `rostopic echo` and `ros2 topic
    echo` print it."""
    found = values.yaml_of(content)
    model = found["distortion_model"]
    if model not in (*_MODELS.values(), ""):
        raise StorageError(
            f"The distortion model {str(model)[:40]!r} is not one of "
            f"{', '.join(_MODELS.values())}; calibrate with one of these."
        )
    if "camera_matrix" in found:
        size = values.size(found.get("image_width"), found.get("image_height"))
        K, D = (found[key]["data"] for key in ("camera_matrix", "distortion_coefficients"))
    else:
        size = values.size(found.get("width"), found.get("height"))
        # ROS 2 writes small letters.
        K, D = (found[key if key in found else key.upper()] for key in ("k", "d"))
    matrix = values.numbers(K, 9)
    fisheye = model == _MODELS["fisheye"]
    return CameraRecord(
        values.camera_of(size, matrix, D, model=f"The model {model}", fisheye=fisheye)
    )


def _matrix(matrix: Any) -> dict[str, Any]:
    rows, columns = np.shape(matrix)
    return {"rows": rows, "cols": columns, "data": np.ravel(matrix).tolist()}


ROS = CameraFormat(
    "ros",
    "ROS's camera_info",
    "camera_info.yaml",
    ("camera_info.yaml", "camera_info.yml", "*_camera_info.yaml", "*_camera_info.yml"),
    lenses=tuple(_MODELS),
    write=write,
    read=read,
    recognises=lambda content: (
        b"distortion_model:" in content
        and (b"camera_matrix:" in content or re.search(rb"(?m)^[kK]:", content) is not None)
    ),
)
