"""A .mat file with what MATLAB's `cameraIntrinsicsFromOpenCV(intrinsicMatrix,
distortionCoefficients, imageSize)` takes.

https://www.mathworks.com/help/vision/ref/cameraintrinsicsfromopencv.html. The values are OpenCV's;
that function adds the pixel by which MATLAB's coordinates differ (its first pixel is at 1, 1).
imageSize is [rows columns]. `covariance` is of the nine parameters, in our order.
"""

from __future__ import annotations

import io
import math
from typing import Any

import numpy as np
from scipy.io import loadmat, savemat, whosmat
from scipy.io.matlab import MatReadError

from venus3d.storage.formats import values
from venus3d.storage.formats.mat5 import numeric_arrays
from venus3d.storage.formats.record import CameraFormat, CameraRecord

_NEEDED = ("intrinsicMatrix", "distortionCoefficients", "imageSize")
_READ = (*_NEEDED, "covariance", "rms")
_MOST = 100
"""Numbers in one array: a covariance has fewer."""


def write(record: CameraRecord) -> bytes:
    """The content of a .mat file of version 5."""
    camera = record.camera
    content: dict[str, Any] = {
        "intrinsicMatrix": camera.K,
        "distortionCoefficients": camera.distortion.reshape(1, 5),
        "imageSize": np.array([[camera.height, camera.width]], dtype=np.float64),
    }
    if record.covariance is not None:
        content["covariance"] = record.covariance
    if record.rms_px is not None:
        content["rms"] = record.rms_px
    buffer = io.BytesIO()
    savemat(buffer, content)
    return buffer.getvalue()


def read(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of such a file. Only small arrays of these names are unpacked."""
    if content[:4] == b"\x89HDF":
        raise ValueError("version 7.3")
    # A zero among the first bytes is the mark of version 4.
    found = _of_version_4(content) if 0 in content[:4] else numeric_arrays(content, _READ, _MOST)
    K, distortion, size = (np.asarray(found[name], dtype=np.float64) for name in _NEEDED)
    rows, columns = values.numbers(size.ravel(), 2)
    rms = found.get("rms")
    return CameraRecord(
        values.camera_of(values.size(columns, rows), K, distortion.ravel(), model="The file"),
        covariance=(covariance := values.covariance(found.get("covariance"))),
        sigma=None if covariance is None else np.sqrt(np.diag(covariance)),
        rms_px=None if rms is None else values.number(np.ravel(rms)[0]),
    )


def _of_version_4(content: bytes) -> dict[str, Any]:
    try:
        shapes = {name: shape for name, shape, _ in whosmat(io.BytesIO(content)) if name in _READ}
        if any(math.prod(shape) > _MOST for shape in shapes.values()):
            raise ValueError("too large")
        found = loadmat(io.BytesIO(content), variable_names=[*shapes])
    except (OSError, NotImplementedError, AttributeError, MatReadError) as error:
        raise ValueError("no .mat file") from error
    if any(np.iscomplexobj(found[name]) for name in shapes):
        raise ValueError("complex numbers")
    return found


MATLAB = CameraFormat(
    "matlab",
    "MATLAB's .mat",
    "camera.mat",
    ("*.mat",),
    write=write,
    read=read,
    recognises=lambda content: content[:6] == b"MATLAB",
    keeps_covariance=True,
    keeps_sigma=True,
)
