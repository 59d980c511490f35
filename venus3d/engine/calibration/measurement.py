"""Lengths on the plane of the board, measured in a calibrated camera's picture.

A pixel's ray meets the board's plane in one point. The length between two such points is uncertain
for three reasons, whose variances add up to first order:

- where the two pixels were clicked,
- the noise of the corners that give the board's pose,
- the camera's parameters. The pose comes from the same camera, so a wrong focal length moves it as
  well, which undoes much of the error near the board: with J_p and J_i the derivatives of the
  corners by pose and intrinsics, a change d of the intrinsics changes the pose by -(J_p^+ J_i) d.

A wrong size of the board's squares scales every length alike. No picture of that board shows it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose

_POSE = 6
_STEPS = np.concatenate([np.full(3, 1e-6), np.full(3, 1e-7)])  # radians, metres
_PINHOLE_STEP, _LENS_STEP = 1e-3, 1e-6  # pixels; of a coefficient


@dataclass(frozen=True)
class MeasuringCamera:
    """A camera to measure with."""

    camera: Camera
    covariance: Array | None = None
    """(p, p) of its parameters; None: taken as exactly known."""
    noise_px: float = 0.2
    """Standard deviation of a detected corner's coordinate, pixels."""


@dataclass(frozen=True, eq=False)
class Measurement:
    """The length between two points on the board's plane."""

    length_m: float
    sigma_m: float
    """Its standard deviation, metres."""


def on_plane(camera: Camera, pose: Pose, pixels: Array) -> Array:
    """Where the rays of pixels (N, 2) meet the board's plane: (N, 2) in the board's frame, metres;
    NaN where they miss it or meet it behind the camera."""
    rays = camera.unproject(pixels)
    normal = pose.R[:, 2]
    with np.errstate(all="ignore"):
        depth = (normal @ pose.t) / (rays @ normal)
        points = (rays * depth[:, None] - pose.t) @ pose.R
    return np.where(depth[:, None] > 0, points[:, :2], np.nan)


def measure(
    by: MeasuringCamera,
    board: Board,
    seen: Observation,
    pose: Pose,
    pixels: Array,
    click_px: float,
) -> Measurement:
    """The length between two pixels of one picture.

    Args:
        seen: the corners that gave the board's `pose` in this picture.
        pixels: (2, 2) of the two points.
        click_px: standard deviation of each of their coordinates, pixels.

    NaN where a ray misses the plane.
    """
    camera = by.camera
    base = _length(camera, pose, pixels)
    J = camera.jacobians(board.points_of(seen.ids), pose.R[None], pose.t[None])[0]
    J = J.reshape(len(J), -1).T
    solved = np.linalg.pinv(J[:, :_POSE])

    by_pose = np.array(
        [(_length(camera, _moved(pose, k), pixels) - base) / _STEPS[k] for k in range(_POSE)]
    )
    by_intrinsics = np.array(
        [
            (_length(_changed(camera, k), pose, pixels) - base) / step
            for k, step in enumerate(_steps(camera))
        ]
    )
    by_click = np.array(
        [
            (_length(camera, pose, pixels + move) - base) / 0.01
            for move in 0.01 * np.eye(4).reshape(4, 2, 2)
        ]
    )
    variance = click_px**2 * float(by_click @ by_click)
    noise = by_pose @ solved
    variance += by.noise_px**2 * float(noise @ noise)
    if by.covariance is not None:
        total = by_intrinsics - noise @ J[:, _POSE:]
        variance += float(total @ by.covariance @ total)
    return Measurement(base, float(np.sqrt(variance)))


def _length(camera: Camera, pose: Pose, pixels: Array) -> float:
    a, b = on_plane(camera, pose, pixels)
    return float(np.linalg.norm(b - a))


def _moved(pose: Pose, number: int) -> Pose:
    """The pose with one of its six coordinates a step further, as `Camera.jacobians` has them."""
    change = np.zeros(_POSE)
    change[number] = _STEPS[number]
    return Pose(Pose.from_rvec_tvec(change[:3], np.zeros(3)).R @ pose.R, pose.t + change[3:])


def _changed(camera: Camera, number: int) -> Camera:
    parameters = camera.parameters.copy()
    parameters[number] += _steps(camera)[number]
    return Camera.from_parameters(parameters, camera.image_size, camera.lens)


def _steps(camera: Camera) -> list[float]:
    return [*[_PINHOLE_STEP] * 4, *[_LENS_STEP] * len(camera.coefficients)]
