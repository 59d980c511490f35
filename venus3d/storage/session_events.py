"""The lines of a session's journal, and the state that they add up to."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PINHOLE_PARAMETERS, Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.lenses import BROWN5, lens_called
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.convergence import Progress
from venus3d.engine.guidance.known_camera import KnownCamera
from venus3d.engine.guidance.record import SessionState
from venus3d.engine.guidance.views import CapturedView
from venus3d.engine.planning.heuristic_poses import HeuristicState, Window
from venus3d.engine.planning.target import Target
from venus3d.storage.result import board_summary, circle_summary
from venus3d.storage.result_reader import array_of, board_of, circle_of

_BROWN5 = (*PINHOLE_PARAMETERS, *BROWN5.coefficient_names)


def captured_event(view: CapturedView, picture: str | None) -> dict[str, Any]:
    """A view, with the path of its picture in the folder."""
    seen = view.observation
    return {
        "event": "captured",
        "number": view.number,
        "picture": picture,
        "name": seen.name,
        "time_s": seen.time_s,
        "sharpness": seen.sharpness,
        "image_size": list(seen.image_size),
        "image_circle": circle_summary(seen.image_circle),
        "board": None if seen.board is None else board_summary(seen.board),
        "ids": seen.ids.tolist(),
        "corners_px": seen.corners.tolist(),
        "target": None if view.target is None else _target(view.target),
    }


def state_event(state: SessionState) -> dict[str, Any]:
    """What the next target is searched from; the views by their numbers."""
    return {
        "event": "state",
        "board": board_summary(state.board),
        "views": [view.number for view in state.views],
        "next_view": state.next_view,
        "next_target": state.next_target,
        "history": [_progress(progress) for progress in state.history],
        "rule": asdict(state.heuristic_state),
        "skipped": [pose.matrix.tolist() for pose in state.skipped],
        "start": _camera(state.start),
        "keep_going": state.keep_going,
        "run": state.run,
        "method": state.method,
        "cost": state.cost,
        "known": None if state.known is None else _known(state.known),
    }


def state_of(events: Sequence[Mapping[str, Any]]) -> SessionState | None:
    """The state after all events; None if nothing was captured. A view counts even if the state
    after it was not written any more. Raises `ValueError` and the like for what are no events."""
    captured: dict[int, Mapping[str, Any]] = {}
    last: Mapping[str, Any] | None = None
    newer: list[Mapping[str, Any]] = []
    for event in events:
        if event["event"] == "captured":
            captured[event["number"]] = event
            newer.append(event)
        elif event["event"] == "state":
            last, newer = event, []
    if last is None or not (last["views"] or newer):
        return None
    # Until the first view, the session adopts the board as it is seen.
    seen = newer[0]["board"] if newer and not last["views"] else None
    board, camera = board_of(seen or last["board"]), _camera_of(last["start"])
    chosen = [*(captured[number] for number in last["views"]), *newer]
    return SessionState(
        board=board,
        views=tuple(_view_of(event, camera, board) for event in chosen),
        next_view=max([last["next_view"], *(event["number"] + 1 for event in newer)]),
        next_target=last["next_target"] + len(newer),
        history=tuple(_progress_of(one) for one in last["history"]),
        heuristic_state=_rule_of(last["rule"]),
        skipped=tuple(Pose.from_matrix(matrix) for matrix in last["skipped"]),
        start=camera,
        keep_going=bool(last["keep_going"]),
        run=int(last["run"]),
        method=last["method"],
        cost=last["cost"],
        known=None if last.get("known") is None else _known_of(last["known"]),
    )


def _view_of(event: Mapping[str, Any], camera: Camera, board: Board) -> CapturedView:
    ids, (width, height) = np.array(event["ids"], dtype=np.intp), event["image_size"]
    board.points_of(ids)  # raises for ids that this board does not have
    seen = Observation(
        ids,
        array_of(event["corners_px"]).reshape(ids.size, 2),
        (int(width), int(height)),
        sharpness=float(event["sharpness"]),
        time_s=float(event["time_s"]),
        name=event["name"],
        board=board,
        image_circle=circle_of(event.get("image_circle")),
    )
    target = event["target"]
    return CapturedView(
        int(event["number"]),
        seen,
        None if target is None else _target_of(target, camera, board),
    )


def _target(target: Target) -> dict[str, Any]:
    """What is compared with the view, and what it was for."""
    return {
        "number": target.number,
        "T_camera_board": target.pose.matrix.tolist(),
        "method": target.method,
        "cost": target.cost,
        "serves": list(target.serves),
        "reason": str(target.reason),
        "std": _numbers(target.predicted_sigma),
        "uncertainty_px": _number(target.predicted_uncertainty_px),
    }


def _target_of(content: Mapping[str, Any], camera: Camera, board: Board) -> Target:
    pose = Pose.from_matrix(content["T_camera_board"])
    return Target(
        number=int(content["number"]),
        pose=pose,
        steps=decompose(pose, camera, board),
        method=content["method"],
        cost=content["cost"],
        serves=tuple(content["serves"]),
        reason=content["reason"],
        predicted_sigma=array_of(content["std"]),
        predicted_uncertainty_px=float(array_of(content["uncertainty_px"])),
    )


def _progress(progress: Progress) -> dict[str, Any]:
    return {
        "views": progress.views,
        "rms_px": progress.rms_px,
        "parameters": _numbers(progress.parameters),
        "std": _numbers(progress.sigma),
        "uncertainty_px": _number(progress.uncertainty_px),
        "promised_std": _numbers(progress.predicted_sigma),
        "promised_uncertainty_px": _number(progress.predicted_uncertainty_px),
        "names": list(progress.names),
    }


def _progress_of(content: Mapping[str, Any]) -> Progress:
    return Progress(
        int(content["views"]),
        float(content["rms_px"]),
        array_of(content["parameters"]),
        array_of(content["std"]),
        float(array_of(content["uncertainty_px"])),
        array_of(content["promised_std"]),
        float(array_of(content["promised_uncertainty_px"])),
        tuple(content.get("names", _BROWN5)),
    )


def _rule_of(content: Mapping[str, Any]) -> HeuristicState:
    return HeuristicState(
        tuple(content.get("made", ())),
        tuple(Window(**window) for window in content["windows"]),
        tuple(content["sigma"]),
        content["aimed"],
        tuple(content["settled"]),
    )


def _camera(camera: Camera) -> dict[str, Any]:
    return {
        "image_size": list(camera.image_size),
        "model": camera.lens.name,
        "parameters": camera.parameters.tolist(),
        "image_circle": circle_summary(camera.image_circle),
    }


def _camera_of(content: Mapping[str, Any]) -> Camera:
    width, height = content["image_size"]
    lens = lens_called(content.get("model", BROWN5.name))
    camera = Camera.from_parameters(content["parameters"], (int(width), int(height)), lens)
    return replace(camera, image_circle=circle_of(content.get("image_circle")))


def _known(known: KnownCamera) -> dict[str, Any]:
    return {**_camera(known.camera), "information": known.information.tolist()}


def _known_of(content: Mapping[str, Any]) -> KnownCamera:
    camera = _camera_of(content)
    p = len(camera.parameters)
    return KnownCamera(camera, array_of(content["information"]).reshape(p, p))


def _numbers(values: Array) -> list[float | None]:
    return [_number(value) for value in values]


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
