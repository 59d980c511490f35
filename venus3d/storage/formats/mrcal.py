"""mrcal's .cameramodel: https://mrcal.secretsauce.net/cameramodels.html#cameramodel-file-formats.

A Python dictionary of literals. LENSMODEL_OPENCV5 is fx, fy, cx, cy, k1, k2, p1, p2, k3; pixels as
in OpenCV. mrcal keeps no covariance: it computes one from the solve stored as
`optimization_inputs`, which only mrcal's own calibration has. Ours stands in a comment.
"""

from __future__ import annotations

import ast

from venus3d.engine.errors import StorageError
from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord

_MODELS = {
    f"LENSMODEL_{name}": count
    for name, count in (
        ("PINHOLE", 4),
        ("OPENCV4", 8),
        ("OPENCV5", 9),
        ("OPENCV8", 12),
        ("OPENCV12", 16),
    )
}
"""How many numbers the intrinsics of each model have."""


def write(record: CameraRecord) -> bytes:
    """The text of a .cameramodel at the origin."""
    camera = record.camera
    lines = ["# Camera calibration by venus3d."]
    if record.covariance is not None:
        names = " ".join(camera.parameter_names)
        lines.append(f"# Covariance of {names}, a row a line; mrcal does not read it:")
        lines += ["#   " + " ".join(map(repr, row)) for row in record.covariance.tolist()]
    intrinsics = ", ".join(map(repr, camera.parameters.tolist()))
    lines += [
        "{",
        f"    'lensmodel':  'LENSMODEL_OPENCV{len(camera.coefficients)}',",
        "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....",
        f"    'intrinsics': [ {intrinsics} ],",
        "    # extrinsics are rt_fromref",
        "    'extrinsics': [ 0, 0, 0, 0, 0, 0 ],",
        f"    'imagersize': [ {camera.width}, {camera.height} ],",
        "}",
    ]
    return ("\n".join(lines) + "\n").encode()


def read(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of a .cameramodel. Its pose and the solve that it comes from are not read."""
    try:
        found = values.mapping(ast.literal_eval(values.text_of(content)))
    except (SyntaxError, MemoryError, RecursionError) as error:
        raise ValueError("no dictionary") from error
    model = str(found.get("lensmodel", found.get("lens_model")))
    if model not in _MODELS:
        raise StorageError(
            f"mrcal's {model[:40]} is not one of {', '.join(_MODELS)}; convert it with "
            "mrcal-convert-lensmodel LENSMODEL_OPENCV5."
        )
    fx, fy, cx, cy, *distortion = values.numbers(found["intrinsics"], _MODELS[model])
    size = values.size(*values.numbers(found["imagersize"], 2))
    K = [fx, 0, cx, 0, fy, cy, 0, 0, 1]
    return CameraRecord(values.camera_of(size, K, distortion, model=f"mrcal's {model}"))


MRCAL = CameraFormat(
    "mrcal",
    "mrcal's .cameramodel",
    "camera.cameramodel",
    ("*.cameramodel",),
    lenses=("brown5", "rational", "rational-thin-prism"),
    write=write,
    read=read,
    recognises=lambda content: b"LENSMODEL_" in content and b"imagersize" in content,
)
