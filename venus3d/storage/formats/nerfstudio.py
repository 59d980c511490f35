"""The intrinsics of nerfstudio's transforms.json, without frames:
https://docs.nerf.studio/quickstart/data_conventions.html.

nerfstudio sends the ray of pixel (0, 0) through (0.5, 0.5) (`get_image_coords`), as COLMAP does:
half a pixel is added to the principal point. It reads k3 (nerfstudio_dataparser.py); instant-ngp,
whose file this was, does not.
"""

from __future__ import annotations

import json

from venus3d.engine.errors import StorageError
from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord

_MODELS = ("OPENCV", "OPENCV_FISHEYE", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL")

_KEYS = ("k1", "k2", "k3", "k4", "p1", "p2")


def write(record: CameraRecord) -> bytes:
    """The text of a transforms.json; `frames` is empty and to be filled."""
    camera = record.camera
    content = {
        "camera_model": "OPENCV" if camera.lens.is_perspective else "OPENCV_FISHEYE",
        "w": camera.width,
        "h": camera.height,
        "fl_x": camera.fx,
        "fl_y": camera.fy,
        "cx": camera.cx + 0.5,
        "cy": camera.cy + 0.5,
        **{key: camera.named[key] for key in _KEYS if key in camera.named},
        "frames": [],
    }
    return (json.dumps(content, indent=2) + "\n").encode()


def read(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of all frames. Raises `StorageError` if each frame has its own."""
    found = values.json_of(content)
    model = found.get("camera_model", "OPENCV")
    if model not in _MODELS:
        raise StorageError(
            f"The camera model {str(model)[:40]!r} is not one of {', '.join(_MODELS)}."
        )
    if "fl_x" not in found:
        raise StorageError(
            "This transforms.json has no fl_x for all frames; put one frame's intrinsics at its "
            "top."
        )
    fx = values.number(found["fl_x"])
    fy = values.number(found.get("fl_y", fx))
    cx, cy = (values.number(found[key]) - 0.5 for key in ("cx", "cy"))
    fisheye = model == "OPENCV_FISHEYE"
    order = ("k1", "k2", "k3", "k4") if fisheye else ("k1", "k2", "p1", "p2", "k3", "k4")
    distortion = [found.get(key, 0.0) for key in order]
    size = values.size(found["w"], found["h"])
    K = [fx, 0, cx, 0, fy, cy, 0, 0, 1]
    return CameraRecord(
        values.camera_of(size, K, distortion, model="transforms.json", fisheye=fisheye)
    )


NERFSTUDIO = CameraFormat(
    "nerfstudio",
    "nerfstudio's transforms.json",
    "transforms.json",
    ("transforms*.json",),
    lenses=("brown5", "fisheye"),
    write=write,
    read=read,
    recognises=lambda content: (
        b'"fl_x"' in content or (b'"camera_angle_x"' in content and b'"frames"' in content)
    ),
)
