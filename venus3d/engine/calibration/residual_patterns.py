"""Patterns in the residuals that say what the model lacks.

Residuals of independent noise have none: neighbouring corners of a view are off in unrelated ways.
A board that is not flat, a stretched print, a rolling shutter in motion and a lens of another kind
move neighbours alike: their residuals' correlation is 0.6 to 0.8 then, -0.2 to 0.5 in good sets.
Which of them it is, two explanations tell: each corner displaced on the board alike in all views,
or each view's board in motion while the rows were read.
"""

from __future__ import annotations

import numpy as np

from venus3d.engine.calibration.adjustment import Calibration
from venus3d.engine.calibration.observation import View
from venus3d.engine.geometry.pose import Array


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


def rolling_share(calibration: Calibration) -> float:
    """Share of the squared residuals, less the independent noise, that is explained if the board
    moved evenly in each view while the rows were read one after the other."""
    explained = total = noise = 0.0
    for view in calibration.views:
        by_pose = _by_pose(calibration, view).reshape(6, -1).T
        rows = view.observation.corners[:, 1]
        moving = by_pose * np.tile(rows - rows.mean(), 2)[:, None]
        held = np.linalg.qr(by_pose).Q
        errors = view.errors.T.reshape(-1)
        errors, moving = errors - held @ (held.T @ errors), moving - held @ (held.T @ moving)
        along = np.linalg.qr(moving / np.linalg.norm(moving, axis=0)).Q.T @ errors
        explained += float(along @ along)
        total += float(errors @ errors)
        noise += calibration.corner_errors.noise_px**2 * (len(errors) - 6)
    systematic = total - noise
    if systematic <= 0:
        return 0.0
    by_chance = calibration.corner_errors.noise_px**2 * 6 * len(calibration.views)
    return float(np.clip((explained - by_chance) / systematic, 0.0, 1.0))


def _by_pose(calibration: Calibration, view: View) -> Array:
    """(6, 2, M) derivatives of a view's pixels by its pose."""
    points = calibration.board.points_of(view.observation.ids)
    return calibration.camera.jacobians(points, view.pose.R[None], view.pose.t[None])[0, :6]
