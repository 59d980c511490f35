"""COLMAP's cameras.txt: https://colmap.github.io/format.html#cameras-txt and .../cameras.html.

COLMAP counts pixels from the picture's corner: the centre of the first pixel is (0.5, 0.5), so half
a pixel is added to the principal point.
"""

from __future__ import annotations

import re

from venus3d.engine.errors import StorageError
from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord

_PARAMETERS = {
    "SIMPLE_PINHOLE": "f cx cy",
    "PINHOLE": "fx fy cx cy",
    "SIMPLE_RADIAL": "f cx cy k1",
    "RADIAL": "f cx cy k1 k2",
    "OPENCV": "fx fy cx cy k1 k2 p1 p2",
    "FULL_OPENCV": "fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6",
    "OPENCV_FISHEYE": "fx fy cx cy k1 k2 k3 k4",
}
"""In the order of the file (src/colmap/sensor/models.h)."""

_OPENCV = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


def write(record: CameraRecord) -> bytes:
    """The text of a cameras.txt with one camera: OPENCV, FULL_OPENCV if there is a k3 or
    more, or OPENCV_FISHEYE."""
    camera = record.camera
    named = {**camera.named, "cx": camera.cx + 0.5, "cy": camera.cy + 0.5}
    full = any(named.get(name) for name in ("k3", "k4", "k5", "k6"))
    model = "FULL_OPENCV" if full else "OPENCV"
    if not camera.lens.is_perspective:
        model = "OPENCV_FISHEYE"
    parameters = [named.get(name, 0.0) for name in _PARAMETERS[model].split()]
    return (
        "# Camera list with one line of data per camera:\n"
        "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
        "# Number of cameras: 1\n"
        f"1 {model} {camera.width} {camera.height} {' '.join(map(repr, parameters))}\n"
    ).encode()


def read(content: bytes, name: str | None = None) -> CameraRecord:
    """The camera of this id, or the only one."""
    lines = [line.split() for line in values.text_of(content).splitlines()]
    found = [words for words in lines if words and not words[0].startswith("#")]
    cameras = {words[0]: words for words in found}
    if len(cameras) < len(found):
        raise StorageError("cameras.txt has several cameras of one id; remove all but one.")
    _, model, width, height, *parameters = values.chosen(cameras, name, "cameras.txt")
    if model not in _PARAMETERS:
        raise StorageError(
            f"COLMAP's model {model[:30]} is not one of {', '.join(_PARAMETERS)}; undistort or "
            "reconstruct with one of these."
        )
    names = _PARAMETERS[model].split()
    given = dict(zip(names, values.numbers(parameters, len(names)), strict=True))
    fx, fy = given.get("fx", given.get("f", 0.0)), given.get("fy", given.get("f", 0.0))
    K = [fx, 0, given["cx"] - 0.5, 0, fy, given["cy"] - 0.5, 0, 0, 1]
    fisheye = model == "OPENCV_FISHEYE"
    order = ("k1", "k2", "k3", "k4") if fisheye else _OPENCV
    size = values.size(width, height)
    distortion = [given.get(one, 0.0) for one in order]
    return CameraRecord(
        values.camera_of(size, K, distortion, model=f"COLMAP's {model}", fisheye=fisheye)
    )


COLMAP = CameraFormat(
    "colmap",
    "COLMAP's cameras.txt",
    "cameras.txt",
    ("cameras.txt",),
    lenses=("brown5", "rational", "fisheye"),
    write=write,
    read=read,
    recognises=lambda content: re.search(rb"(?m)^\d+ [A-Z_]+ \d+ \d+ ", content) is not None,
)
