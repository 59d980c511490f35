"""Patterns in the residuals that say what the model lacks.

Residuals of independent noise have none: neighbouring corners of a view are off in unrelated ways.
A board that is not flat, a stretched print, a rolling shutter in motion and a lens of another kind
move neighbours alike: their residuals' correlation is 0.6 to 0.8 then, -0.2 to 0.5 in good sets.
Which of them it is, three explanations tell: each corner displaced on the board alike in all views,
each view's board in motion while the rows were read, or more coefficients of the lens.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.shared_errors import ViewResidual
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import FISHEYE, RATIONAL
from venus3d.engine.geometry.pose import Array

ALIKE = 0.6
"""Correlation of neighbouring corners' residuals from which the model lacks something."""
ALIKE_FAR_OFF, FAR_OFF = 0.4, 4.0
"""The same where the rms is so many times what the corners are good for (1.0 to 1.5 in good sets,
2.2 on a real board that is not flat): on a board of few squares neighbours are far apart."""
WHILE_READ = 0.9
"""Share of the residuals that a motion must explain to be named."""
ON_THE_LENS = 0.4
"""Share of the residuals that more coefficients must explain for the lens's model to be named: with
too poor a model 0.72 to 1 on real sets and 0.54 to 1 on simulated ones, else up to 0.04 where
neighbours are off alike."""
_RICHEST = {False: FISHEYE, True: RATIONAL}  # by whether the lens is perspective
_MOVED = 40.0  # variances of the noise that a motion of six parameters explains: no chance
_STEP = 0.1  # of what the last view explained: the next one, which explains less, did not move


def neighbour_correlation(calibration: Calibration) -> float:
    """Correlation of the residuals of neighbouring corners in the same view; NaN if none."""
    lattice, n = calibration.board.lattice, calibration.board.of_kind.stride
    columns, rows = lattice.max(axis=0) + 1
    one: list[Array] = []
    other: list[Array] = []
    for view in calibration.views:
        grid = np.full((rows, columns, 2), np.nan)
        column, row = lattice[view.observation.ids].T
        grid[row, column] = view.errors
        for left, right in ((grid[:, :-n], grid[:, n:]), (grid[:-n], grid[n:])):
            both = np.isfinite(left + right)
            one.append(left[both])
            other.append(right[both])
    a, b = np.concatenate(one), np.concatenate(other)
    power = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / power if power > 0 else float("nan")


def board_share(calibration: Calibration) -> float:
    """Share of the squared residuals that a displacement of each corner on the board explains, the
    same in all views; less what chance explains."""
    seen = _by_corner(calibration)
    explained = total = 0.0
    for derivatives, errors in seen:
        solution = np.linalg.lstsq(derivatives, errors, rcond=None)[0]
        left = errors - derivatives @ solution
        explained += float(errors @ errors - left @ left)
        total += float(errors @ errors)
    count = sum(len(errors) for _, errors in seen)
    free = count - 3 * len(seen)
    if total == 0 or free <= 0:
        return 0.0
    return 1 - (1 - explained / total) * count / free


def _by_corner(calibration: Calibration) -> list[tuple[Array, Array]]:
    """For each corner its residuals in all views (2 n,) and their derivatives by its place on the
    board (2 n, 3)."""
    found: dict[int, list[tuple[Array, Array]]] = {}
    for view in calibration.views:
        by_point = np.einsum("kum,kj->muj", _by_pose(calibration, view)[3:], view.pose.R)
        for corner, derivative, error in zip(
            view.observation.ids, by_point, view.errors, strict=True
        ):
            found.setdefault(int(corner), []).append((derivative, error))
    return [
        (np.concatenate([d for d, _ in one]), np.concatenate([e for _, e in one]))
        for one in found.values()
    ]


def lens_share(calibration: Calibration) -> float:
    """Share of the squared residuals, less the independent noise, that all coefficients of the
    lens's family explain to first order; 0 if it has them all."""
    camera = calibration.camera
    richest = _RICHEST[camera.lens.is_perspective]
    if len(richest.coefficient_names) <= len(camera.lens.coefficient_names):
        return 0.0
    least, free = _least(calibration, camera)
    systematic = least - calibration.corner_errors.noise_px**2 * free
    if systematic <= 0:
        return 0.0
    return float((least - _least(calibration, camera.with_lens(richest))[0]) / systematic)


def _least(calibration: Calibration, camera: Camera) -> tuple[float, int]:
    """The least sum of squares that small changes of this camera leave, and its freedom."""
    grams = [_grams(calibration, view, camera)[0] for view in calibration.views]
    size = sum(view.errors.size - 6 for view in calibration.views)
    return float(least_squares_of(np.sum(grams, axis=0)[None])[0]), size - len(grams[0]) + 1


@dataclass(frozen=True)
class RollingMotion:
    """What is explained if the board moved evenly in some views while their rows were read one
    after the other, the intrinsics being fitted anew with that."""

    share: float
    """Of the squared residuals, less the independent noise."""
    numbers: tuple[int, ...]
    """The views that moved: as few as explain it."""


def rolling_motion(calibration: Calibration) -> RollingMotion:
    """The motion that the residuals show: of one view after the other, that which explains most,
    until that is enough and the next one explains far less, or no more than noise."""
    noise2 = calibration.corner_errors.noise_px**2
    views = calibration.views
    grams = [_grams(calibration, view, calibration.camera) for view in views]
    still, moving = (np.array(each) for each in zip(*grams, strict=True))
    p = still.shape[1] - 1
    freedom = sum(view.errors.size for view in views) - 6 * len(views) - p
    least = float(least_squares_of(still.sum(axis=0)[None])[0])
    systematic = least - noise2 * freedom
    if systematic <= 0:
        return RollingMotion(0.0, ())
    moved = np.zeros(len(views), dtype=bool)
    total, left, share, gain = still.sum(axis=0), least, 0.0, least
    while not moved.all():
        each = least_squares_of(total + moving - still)
        each[moved] = np.inf
        best = int(np.argmin(each))
        last, gain = gain, left - float(each[best])
        if gain < _MOVED * noise2 or (share >= WHILE_READ and gain < _STEP * last):
            break
        moved[best], left, total = True, left - gain, total + moving[best] - still[best]
        share = (least - left - 6 * noise2 * moved.sum()) / systematic
    numbers = tuple(v.number for v, is_moved in zip(views, moved, strict=True) if is_moved)
    return RollingMotion(float(np.clip(share, 0.0, 1.0)), numbers)


def motion_gains(calibration: Calibration) -> Array:
    """(N,) by how much the sum of squares falls if one view was in even motion while rows were
    read, the intrinsics being fitted anew with it."""
    grams = [_grams(calibration, view, calibration.camera) for view in calibration.views]
    still, moving = (np.array(each) for each in zip(*grams, strict=True))
    total = still.sum(axis=0)
    return np.asarray(
        least_squares_of(total[None])[0] - least_squares_of(total + moving - still),
        dtype=np.float64,
    )


def _grams(calibration: Calibration, view: View, camera: Camera) -> tuple[Array, Array]:
    """(p + 1, p + 1) normal matrices of a view's derivatives by this camera and, last, of its
    residuals: with its pose projected out, and with an even motion while rows are read as well."""
    points = calibration.board.points_of(view.observation.ids)
    J = camera.jacobians(points, view.pose.R[None], view.pose.t[None])[0]
    stacked = J.reshape(len(J), -1).T
    rows = view.observation.corners[:, 1]
    by_motion = stacked[:, :6] * np.tile(rows - rows.mean(), 2)[:, None]
    by_motion /= np.maximum(np.linalg.norm(by_motion, axis=0), 1e-300)
    Q = np.linalg.qr(np.concatenate([stacked[:, :6], by_motion], axis=1)).Q
    columns = np.column_stack([stacked[:, 6:], view.errors.T.reshape(-1)])
    columns = columns - Q[:, :6] @ (Q[:, :6].T @ columns)
    along = Q[:, 6:].T @ columns
    still = columns.T @ columns
    return still, still - along.T @ along


def view_residual(calibration: Calibration, view: View) -> ViewResidual:
    """A view's residuals with their derivatives by the camera and by the board's shape: a bow moves
    the principal point to one side or the other, as the board is tilted."""
    board, R = calibration.board, view.pose.R
    points = board.points_of(view.observation.ids)
    J = calibration.camera.jacobians(points, R[None], view.pose.t[None])[0]
    by_shape = np.einsum("ium,kmj,ij->kum", J[3:6], board.deformations(points), R)
    return ViewResidual.of(board, points, view.errors.T, np.concatenate([J, by_shape]))


def least_squares_of(grams: Array) -> Array:
    """(N,) the least sums of squares for normal matrices (N, q + 1, q + 1), residuals last."""
    H, right = grams[:, :-1, :-1], grams[:, :-1, -1]
    scale = 1.0 / np.sqrt(np.maximum(np.einsum("nii->ni", H), 1e-300))
    H = H * scale[:, :, None] * scale[:, None] + 1e-13 * np.eye(H.shape[1])
    right = (right * scale)[:, :, None]
    explained = (right * np.linalg.solve(H, right)).sum(axis=(1, 2))
    return np.asarray(grams[:, -1, -1] - explained, dtype=np.float64)


def _by_pose(calibration: Calibration, view: View) -> Array:
    """(6, 2, M) derivatives of a view's pixels by its pose."""
    points = calibration.board.points_of(view.observation.ids)
    return calibration.camera.jacobians(points, view.pose.R[None], view.pose.t[None])[0, :6]
