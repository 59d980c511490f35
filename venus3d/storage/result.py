"""result.json: a calibration's full result for programs, and its short form for --json.
docs/result-format.md describes every key. `result_reader` reads it."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation, View
from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.image_circle import ImageCircle
from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.convergence import Progress
from venus3d.engine.planning.forecast import Forecast
from venus3d.engine.printable import is_seen
from venus3d.storage.folder import write_bytes

SCHEMA = 2
"""Version of the keys; increased when a key is renamed or changes its meaning."""


def summary_of(
    calibration: Calibration,
    *,
    warnings: Sequence[str] = (),
    diagnoses: Sequence[Diagnosis] = (),
    converged: bool | None = None,
    truth: Camera | None = None,
    forecast: Forecast | None = None,
) -> dict[str, Any]:
    """The result in short, as printed by --json. Pixels; the board's lengths in millimetres.

    Args:
        diagnoses: given both as sentences among the warnings and in parts.
        converged: for a guided calibration; None omits it.
        forecast: views needed to the desired projection error; None omits it.
        truth: the simulated camera; adds `truth` and `projection_diff_px`.
    """
    camera = calibration.camera
    summary: dict[str, Any] = {
        "schema": SCHEMA,
        "rms_px": calibration.rms_px,
        "views": len(calibration.views),
        "model": camera.lens.name,
        "model_reason": str(calibration.lens_reason),
        "intrinsics": camera.named,
        "std": _named(camera, calibration.sigma),
        "std_noise_only": _named(camera, calibration.sigma_noise_only),
        "image_size": list(camera.image_size),
        "image_circle": circle_summary(camera.image_circle),
        "board": board_summary(calibration.board),
        "warnings": [*warnings, *map(str, diagnoses)],
        "diagnoses": [_diagnosis(diagnosis) for diagnosis in diagnoses],
    }
    if converged is not None:
        summary["converged"] = converged
    if forecast is not None:
        summary["forecast"] = {
            "wanted_uncertainty_px": forecast.wanted_px,
            "views": forecast.views,
            "low": forecast.low,
            "high": forecast.high,
            "looked_ahead": forecast.looked_ahead,
        }
    if truth is not None:
        summary["truth"] = truth.named
        summary["projection_diff_px"] = projection_diff_px(truth, camera)
    return summary


def circle_summary(circle: ImageCircle | None) -> list[float] | None:
    """[x, y, radius], pixels; None without one."""
    return None if circle is None else [circle.x, circle.y, circle.radius]


def board_summary(board: Board) -> dict[str, Any]:
    """The board in the terms of the command line, without what its kind has not."""
    summary: dict[str, Any] = {
        "kind": board.kind,
        "columns": board.columns,
        "rows": board.rows,
        "square_mm": round(board.square * 1000, 9),
    }
    if board.has("marker"):
        summary["marker_mm"] = round(board.marker * 1000, 9)
    for name in ("dictionary", "legacy", "inverted", "first_id"):
        if board.has(name):
            summary[name] = getattr(board, name)
    return summary


def full_result(
    summary: Mapping[str, Any], calibration: Calibration, history: Sequence[Progress] = ()
) -> dict[str, Any]:
    """The summary with the covariance, each view and the history of the estimate."""
    return {
        **summary,
        "parameters": list(calibration.camera.parameter_names),
        "free": list(calibration.free),
        "covariance": calibration.covariance.tolist(),
        "covariance_noise_only": calibration.covariance_noise_only.tolist(),
        "residual_sigma_px": calibration.residual_sigma_px,
        "noise_px": calibration.corner_errors.noise_px,
        "shared_error_px": calibration.corner_errors.shared_px,
        "board_shape": _shape(calibration),
        "captured": [_view(view) for view in calibration.views],
        "left_out": [
            {"number": one.number, "reason": one.reason, **_corners(one.observation)}
            for one in calibration.left_out
        ],
        "history": [
            {
                "views": progress.views,
                "rms_px": progress.rms_px,
                "intrinsics": _by_name(progress.names, progress.parameters),
                "std": _by_name(progress.names, progress.sigma),
                "uncertainty_px": progress.uncertainty_px,
                # As predicted by the target; null for a view not taken at one.
                "promised_std": _by_name(progress.names, progress.predicted_sigma),
                "promised_uncertainty_px": progress.predicted_uncertainty_px,
            }
            for progress in history
        ],
    }


def result_json(
    summary: Mapping[str, Any], calibration: Calibration, history: Sequence[Progress] = ()
) -> str:
    """The text of result.json."""
    return to_json(full_result(summary, calibration, history), indent=2) + "\n"


def write_result(
    path: Path | str,
    calibration: Calibration,
    *,
    warnings: Sequence[str] = (),
    diagnoses: Sequence[Diagnosis] | None = None,
) -> Path:
    """Write a calibration as a result.json, with its `diagnose`d doubts unless others are given.
    Raises `StorageError` if it cannot be written."""
    found = diagnose(calibration) if diagnoses is None else diagnoses
    summary = summary_of(calibration, warnings=warnings, diagnoses=found)
    return write_bytes(Path(path), result_json(summary, calibration).encode())


def to_json(content: Mapping[str, Any], indent: int | None = None) -> str:
    """Strict JSON: numbers that are not finite become null."""
    text = json.dumps(_finite(content), indent=indent, allow_nan=False, ensure_ascii=False)
    # JSON leaves some of what a terminal obeys as it is.
    return re.sub(r"[^\n -~]", lambda found: _as_json(found[0]), text)


def _as_json(one: str) -> str:
    return one if is_seen(one) else json.dumps(one)[1:-1]


def _diagnosis(diagnosis: Diagnosis) -> dict[str, Any]:
    return {
        "kind": diagnosis.kind,
        "cause": diagnosis.cause,
        "cure": diagnosis.cure,
        # Numbers as in `captured`; none if all views are concerned.
        "views": list(diagnosis.views),
    }


def _view(view: View) -> dict[str, Any]:
    return {
        "number": view.number,
        "name": view.observation.name,
        "rms_px": view.rms_px,
        # Angles in degrees about the camera's fixed axes, the board's centre in millimetres.
        "angles_deg": view.pose.vector()[:3].tolist(),
        "translation_mm": (view.pose.t * 1000).tolist(),
        "T_camera_board": view.pose.matrix.tolist(),
        "ids": view.observation.ids.tolist(),
        "corners_px": view.observation.corners.tolist(),
        "errors_px": view.errors.tolist(),
        "left_out": None if view.left_out is None else _corners(view.left_out),
    }


def _corners(seen: Observation) -> dict[str, Any]:
    return {"name": seen.name, "ids": seen.ids.tolist(), "corners_px": seen.corners.tolist()}


def _shape(calibration: Calibration) -> dict[str, Any]:
    """The board as found: its bow and the stretch of its print, 0 where it passes for flat."""
    board, (across, down, stretch) = calibration.board, calibration.shape_sigma
    return {
        "bow_mm": [1000 * bow for bow in board.bow],
        "bow_std_mm": [1000 * across, 1000 * down],
        "stretch": board.stretch,
        "stretch_std": stretch,
        "marker_std_mm": 1000 * calibration.marker_sigma,
    }


def _named(camera: Camera, values: Array) -> dict[str, float]:
    return _by_name(camera.parameter_names, values)


def _by_name(names: Sequence[str], values: Array) -> dict[str, float]:
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def _finite(content: Any) -> Any:
    if isinstance(content, Mapping):
        return {key: _finite(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [_finite(value) for value in content]
    if isinstance(content, (bool, np.bool_)):
        return bool(content)
    if isinstance(content, (float, np.floating)):
        return float(content) if math.isfinite(content) else None
    return content
