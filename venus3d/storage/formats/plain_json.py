"""Plain JSON with the covariance: result.json without its views. docs/result-format.md describes
the keys. A result.json is read as well."""

from __future__ import annotations

from typing import Any

import numpy as np

from venus3d.engine.errors import BoardError, StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PINHOLE_PARAMETERS, Camera
from venus3d.engine.geometry.lenses import BROWN5, LENSES, LensModel, lens_called
from venus3d.storage.formats import values
from venus3d.storage.formats.record import CameraFormat, CameraRecord
from venus3d.storage.result import SCHEMA, board_summary, to_json
from venus3d.storage.result_reader import board_of


def write(record: CameraRecord) -> bytes:
    """The text of the JSON."""
    camera, covariance = record.camera, record.covariance
    content: dict[str, Any] = {
        "schema": SCHEMA,
        "image_size": list(camera.image_size),
        "model": camera.lens.name,
        "intrinsics": camera.named,
        "parameters": list(camera.parameter_names),
    }
    if record.sigma is not None:
        sigma = np.asarray(record.sigma).tolist()
        content["std"] = dict(zip(camera.parameter_names, sigma, strict=True))
    if covariance is not None:
        content["covariance"] = covariance.tolist()
    if record.rms_px is not None:
        content["rms_px"] = record.rms_px
    if record.views is not None:
        content["views"] = record.views
    if record.board is not None:
        content["board"] = board_summary(record.board)
    return (to_json(content, indent=2) + "\n").encode()


def read(content: bytes, _name: str | None = None) -> CameraRecord:
    """The camera of such a JSON or of a result.json."""
    found = values.json_of(content)
    if found.get("schema") != SCHEMA:
        raise StorageError(
            f"This JSON has schema {str(found.get('schema'))[:20]}, and this version reads schema "
            f"{SCHEMA}; take the camera.yaml beside it."
        )
    intrinsics = values.mapping(found["intrinsics"])
    lens = lens_called(str(found.get("model", BROWN5.name)))
    names = (*PINHOLE_PARAMETERS, *lens.coefficient_names)
    parameters = [values.number(intrinsics[name]) for name in names]
    covariance, std = values.covariance(found.get("covariance"), len(names)), found.get("std")
    sigma = None if std is None else np.array([values.number(std[name]) for name in names])
    views, rms = found.get("views"), found.get("rms_px")
    return CameraRecord(
        _camera_of(parameters, values.size(*found["image_size"]), lens),
        covariance=covariance,
        sigma=sigma if covariance is None else np.sqrt(np.diag(covariance)),
        rms_px=None if rms is None else values.number(rms),
        views=None if views is None else int(views),
        board=_board_of(found.get("board")),
    )


def _camera_of(parameters: list[float], size: tuple[int, int], lens: LensModel) -> Camera:
    values.checked(parameters, size)
    return Camera.from_parameters(parameters, size, lens)


def _board_of(content: Any) -> Board | None:
    if content is None:
        return None
    for name in ("square_mm", "marker_mm"):
        if name in content:
            values.number(content[name])
    try:
        return board_of(content)
    except BoardError as error:
        raise ValueError("no board") from error


JSON = CameraFormat(
    "json",
    "plain JSON",
    "camera.json",
    ("result.json", "camera.json"),
    lenses=tuple(LENSES),
    write=write,
    read=read,
    recognises=lambda content: b'"intrinsics"' in content and b'"image_size"' in content,
    keeps_covariance=True,
    keeps_sigma=True,
)
