"""Kalibr's camera chain, with one camera: https://github.com/ethz-asl/kalibr/wiki/yaml-formats.

`radtan` has OpenCV's k1, k2, p1, p2 and no k3, `equidistant` is its fisheye. Pixels as in OpenCV.
"""

from __future__ import annotations

import yaml

from venus3d.engine.errors import StorageError
from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord


def write(record: CameraRecord) -> bytes:
    """The text of a camchain file whose only camera is `cam0`."""
    camera = record.camera
    content = {
        "cam0": {
            "camera_model": "pinhole",
            "intrinsics": camera.parameters[:4].tolist(),
            "distortion_model": "radtan" if camera.lens.is_perspective else "equidistant",
            "distortion_coeffs": camera.distortion[:4].tolist(),
            "rostopic": "/cam0/image_raw",
            "resolution": [camera.width, camera.height],
        }
    }
    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=200).encode()


def read(content: bytes, name: str | None = None) -> CameraRecord:
    """The camera of this name (`cam0`, `cam1` ...), or the only one."""
    found = values.yaml_of(content)
    cameras = {str(key): one for key, one in found.items() if str(key).startswith("cam")}
    one = values.mapping(values.chosen(cameras, name, "The camera chain"))
    model, distortion = one["camera_model"], one.get("distortion_model", "none")
    if model != "pinhole" or distortion not in ("radtan", "equidistant", "none"):
        raise StorageError(
            f"Kalibr's {str(model)[:20]} with {str(distortion)[:20]} is no pinhole with "
            "radial-tangential or equidistant distortion; calibrate with pinhole-radtan or "
            "pinhole-equi."
        )
    coefficients = [] if distortion == "none" else values.numbers(one["distortion_coeffs"], 4)
    size = values.size(*one.get("resolution", (None, None)))
    fx, fy, cx, cy = values.numbers(one["intrinsics"], 4)
    K = [fx, 0, cx, 0, fy, cy, 0, 0, 1]
    fisheye = distortion == "equidistant"
    return CameraRecord(values.camera_of(size, K, coefficients, fisheye=fisheye))


KALIBR = CameraFormat(
    "kalibr",
    "Kalibr's camera chain",
    "camchain.yaml",
    ("*camchain*.yaml", "*camchain*.yml"),
    write=write,
    read=read,
    recognises=lambda content: b"camera_model" in content and b"intrinsics" in content,
    coefficients=4,
    lenses=("brown5", "fisheye"),
)  # fmt: skip
