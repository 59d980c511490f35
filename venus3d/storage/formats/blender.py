"""A short JSON with the values of a Blender camera, under the names of Blender's own properties.

The lens, sensor and shift belong to `bpy.types.Camera`, the resolution and pixel aspect to
`bpy.types.RenderSettings`. From Blender's BKE_camera_params_compute_viewplane, with the sensor
fitted horizontally: fx = lens / sensor_width · w, fy = fx · pixel_aspect_x / pixel_aspect_y. Shifts
are in picture widths and measured from the picture's middle, which is at (w - 1) / 2 in our pixels.
"""

from __future__ import annotations

import json
import math

from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord

SENSOR_WIDTH_MM = 36.0
"""Blender's default. Only its ratio to the lens counts."""


def write(record: CameraRecord) -> bytes:
    """The text of the JSON."""
    camera = record.camera
    aspect = camera.fx / camera.fy
    content = {
        "program": "blender",
        "type": "PERSP",
        "sensor_fit": "HORIZONTAL",
        "sensor_width": SENSOR_WIDTH_MM,
        "lens": SENSOR_WIDTH_MM * camera.fx / camera.width,
        "angle_x": 2 * math.atan(camera.width / (2 * camera.fx)),
        "shift_x": ((camera.width - 1) / 2 - camera.cx) / camera.width,
        "shift_y": (camera.cy - (camera.height - 1) / 2) * aspect / camera.width,
        "resolution_x": camera.width,
        "resolution_y": camera.height,
        # Blender takes none below 1.
        "pixel_aspect_x": max(1.0, 1 / aspect),
        "pixel_aspect_y": max(1.0, aspect),
    }
    return (json.dumps(content, indent=2) + "\n").encode()


def read(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of such a JSON."""
    found = values.json_of(content)
    if found["sensor_fit"] != "HORIZONTAL":
        raise ValueError("another fit")
    size = values.size(found["resolution_x"], found["resolution_y"])
    keys = ("lens", "sensor_width", "shift_x", "shift_y", "pixel_aspect_x", "pixel_aspect_y")
    lens, sensor, shift_x, shift_y, aspect_x, aspect_y = (values.number(found[key]) for key in keys)
    fx, aspect = lens / sensor * size[0], aspect_y / aspect_x
    cx = (size[0] - 1) / 2 - shift_x * size[0]
    cy = (size[1] - 1) / 2 + shift_y * size[0] / aspect
    return CameraRecord(values.checked([fx, fx / aspect, cx, cy], size))


BLENDER = CameraFormat(
    "blender",
    "Blender's camera",
    "camera-blender.json",
    ("*-blender.json",),
    write=write,
    read=read,
    recognises=lambda content: b'"sensor_fit"' in content,
    coefficients=0,
)
