"""A short JSON with the values of a Unity camera, under the names of `UnityEngine.Camera`.

https://docs.unity3d.com/Manual/PhysicalCameras.html. With `usePhysicalProperties` and
`gateFit = None`, fx = focalLength / sensorSize.x · width and fy = focalLength / sensorSize.y ·
height; the lens shift is in parts of the sensor, from its middle, y upwards.
"""

from __future__ import annotations

import json
import math

from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord

SENSOR_WIDTH_MM = 36.0
"""Only its ratio to the focal length counts."""


def write(record: CameraRecord) -> bytes:
    """The text of the JSON."""
    camera = record.camera
    focal_mm = SENSOR_WIDTH_MM * camera.fx / camera.width
    content = {
        "program": "unity",
        "usePhysicalProperties": True,
        "gateFit": "None",
        "focalLength": focal_mm,
        "sensorSize": {"x": SENSOR_WIDTH_MM, "y": focal_mm * camera.height / camera.fy},
        "lensShift": {
            "x": ((camera.width - 1) / 2 - camera.cx) / camera.width,
            "y": (camera.cy - (camera.height - 1) / 2) / camera.height,
        },
        # Vertical, degrees: what Unity's field of view is.
        "fieldOfView": math.degrees(2 * math.atan(camera.height / (2 * camera.fy))),
        "pixelWidth": camera.width,
        "pixelHeight": camera.height,
    }
    return (json.dumps(content, indent=2) + "\n").encode()


def read(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of such a JSON."""
    found = values.json_of(content)
    size = values.size(found["pixelWidth"], found["pixelHeight"])
    focal = values.number(found["focalLength"])
    sensor, shift = found["sensorSize"], found["lensShift"]
    fx = focal / values.number(sensor["x"]) * size[0]
    fy = focal / values.number(sensor["y"]) * size[1]
    cx = (size[0] - 1) / 2 - values.number(shift["x"]) * size[0]
    cy = (size[1] - 1) / 2 + values.number(shift["y"]) * size[1]
    return CameraRecord(values.checked([fx, fy, cx, cy], size))


UNITY = CameraFormat(
    "unity",
    "Unity's camera",
    "camera-unity.json",
    ("*-unity.json",),
    write=write,
    read=read,
    recognises=lambda content: b'"lensShift"' in content,
    coefficients=0,
)
