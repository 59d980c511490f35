"""Reads a result.json: the calibration with its board and all captured views."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from venus3d.engine.calibration.calibration import Calibration, LeftOut
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation, View
from venus3d.engine.calibration.shared_errors import CornerErrors
from venus3d.engine.errors import StorageError, VenusError
from venus3d.engine.geometry.board import KINDS, Board
from venus3d.engine.geometry.camera import PINHOLE_PARAMETERS, Camera
from venus3d.engine.geometry.image_circle import ImageCircle
from venus3d.engine.geometry.lenses import BROWN5, lens_called
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.regular_file import read_regular
from venus3d.storage.damaged import DAMAGED
from venus3d.storage.folder import reason
from venus3d.storage.result import SCHEMA

# Files written before there was a shape.
_FLAT = {"bow_mm": [0.0, 0.0], "bow_std_mm": [0.0, 0.0], "stretch": 0.0, "stretch_std": 0.0}


@dataclass(frozen=True, eq=False)
class Result:
    """The content of a result.json. Lengths in metres, as in the engine."""

    schema: int
    calibration: Calibration
    warnings: tuple[str, ...]
    """Those that are not diagnoses."""
    diagnoses: tuple[Diagnosis, ...]

    @property
    def camera(self) -> Camera:
        """The calibrated camera."""
        return self.calibration.camera

    @property
    def board(self) -> Board:
        """The board that the views show."""
        return self.calibration.board

    @property
    def covariance(self) -> Array:
        """(p, p) of the camera's parameters; zero rows and columns for parameters held fixed."""
        return self.calibration.covariance

    @property
    def observations(self) -> tuple[Observation, ...]:
        """The captured corners, view by view."""
        return tuple(view.observation for view in self.calibration.views)


def read_result(path: Path | str) -> Result:
    """Read a result.json written by `calibrate`, `guide` or `write_result`. Raises `StorageError`,
    with cause and cure, if the file cannot be read, is no result, or has another schema."""
    try:
        content = json.loads(read_regular(Path(path)).decode())
    except OSError as error:
        raise StorageError(
            f"The result {path} cannot be read ({reason(error)}); give a result.json that venus3d "
            "wrote."
        ) from error
    except (ValueError, RecursionError) as error:  # neither text nor JSON
        raise _no_result(path) from error
    if not isinstance(content, dict):
        raise _no_result(path)
    schema: Any = content.get("schema", 1)
    # Older results are told from other files, such as session.json, by what all of them have.
    older = {"intrinsics", "captured"} <= content.keys()
    if type(schema) is int and (schema > SCHEMA or (schema < SCHEMA and older)):
        cure = (
            "read the camera.yaml beside it, or calibrate again"
            if schema < SCHEMA
            else "update venus3d"
        )
        raise StorageError(
            f"{path} has schema {schema}, and this version reads schema {SCHEMA}; {cure}."
        )
    try:
        return _result_of(content)
    except (*DAMAGED, VenusError) as error:
        raise _no_result(path) from error


def _no_result(path: Path | str) -> StorageError:
    return StorageError(
        f"{path} is no result of venus3d, or is damaged; give a result.json as `venus3d calibrate` "
        "writes it."
    )


def _result_of(content: Mapping[str, Any]) -> Result:
    width, height = (int(side) for side in content["image_size"])
    named, lens = content["intrinsics"], lens_called(content.get("model", BROWN5.name))
    names = (*PINHOLE_PARAMETERS, *lens.coefficient_names)
    camera = Camera.from_parameters([named[name] for name in names], (width, height), lens)
    camera = replace(camera, image_circle=circle_of(content.get("image_circle")))
    p = len(camera.parameters)
    free = tuple(bool(value) for value in content["free"])
    if len(free) != p:
        raise ValueError("not one flag for each parameter")
    board, shape_sigma = _shaped(board_of(content["board"]), content.get("board_shape", _FLAT))
    diagnoses = tuple(
        Diagnosis(d["kind"], d["cause"], d["cure"], tuple(d["views"])) for d in content["diagnoses"]
    )
    sentences = {str(diagnosis) for diagnosis in diagnoses}
    return Result(
        schema=content["schema"],
        calibration=Calibration(
            board=board,
            camera=camera,
            covariance=array_of(content["covariance"]).reshape(p, p),
            covariance_noise_only=array_of(content["covariance_noise_only"]).reshape(p, p),
            free=free,
            residual_sigma_px=float(content["residual_sigma_px"]),
            corner_errors=CornerErrors(
                float(content["noise_px"]), float(content["shared_error_px"])
            ),
            rms_px=float(content["rms_px"]),
            views=tuple(_view_of(view, camera, board) for view in content["captured"]),
            left_out=tuple(
                LeftOut(int(one["number"]), _corners_of(one, (width, height), board), one["reason"])
                for one in content.get("left_out", ())
            ),
            shape_sigma=shape_sigma,
            marker_sigma=float(content.get("board_shape", {}).get("marker_std_mm", 0)) / 1000,
            lens_reason=str(content.get("model_reason", "")),
        ),
        warnings=tuple(text for text in content["warnings"] if text not in sentences),
        diagnoses=diagnoses,
    )


def circle_of(content: Sequence[float] | None) -> ImageCircle | None:
    """The circle of a `circle_summary`."""
    return None if content is None else ImageCircle(*(float(value) for value in content))


def board_of(content: Mapping[str, Any]) -> Board:
    """The board of a `board_summary`."""
    kind = content.get("kind", "charuco")
    if kind not in KINDS:
        raise ValueError("no kind of board")
    fields = KINDS[kind].fields
    lengths = ["square", *({"marker"} & set(fields))]
    named = {name: content[f"{name}_mm"] / 1000 for name in lengths}
    others = {"dictionary", "legacy", "inverted"} & set(fields)
    named |= {name: content[name] for name in ("columns", "rows", *others)}
    return Board(**named, kind=kind, first_id=int(content.get("first_id", 0)))


def _shaped(board: Board, shape: Mapping[str, Any]) -> tuple[Board, tuple[float, float, float]]:
    """The board as it was found to be, and the standard deviations of that."""
    across, down = (float(bow) / 1000 for bow in shape["bow_mm"])
    bows = [float(sigma) / 1000 for sigma in shape["bow_std_mm"]]
    shaped = replace(board, bow=(across, down), stretch=float(shape["stretch"]))
    return shaped, (bows[0], bows[1], float(shape["stretch_std"]))


def _view_of(content: Mapping[str, Any], camera: Camera, board: Board) -> View:
    size = camera.image_size
    seen, left_out = _corners_of(content, size, board), content.get("left_out")
    return View(
        number=int(content["number"]),
        observation=replace(seen, image_circle=camera.image_circle),
        pose=Pose.from_matrix(array_of(content["T_camera_board"])),
        rms_px=float(content["rms_px"]),
        errors=array_of(content["errors_px"]).reshape(seen.count, 2),
        left_out=None if left_out is None else _corners_of(left_out, size, board),
    )


def _corners_of(content: Mapping[str, Any], size: tuple[int, int], board: Board) -> Observation:
    ids = np.array(content["ids"], dtype=np.intp)
    board.points_of(ids)  # raises for ids that this board does not have
    corners = array_of(content["corners_px"]).reshape(ids.size, 2)
    return Observation(ids, corners, size, name=content["name"], board=board)


def array_of(content: Any) -> Array:
    """Nested lists of numbers; null becomes NaN."""
    return np.array(content, dtype=np.float64)
