"""`venus3d study halves`: does the uncertainty hold on a real recording, whose camera nobody knows?

A recording's views are cut at random into two halves, each calibrated by itself. The two cameras
are independent, so a parameter may differ by more than twice their joint sigma in 5 % of the cuts,
and the cameras' projection difference should be what the covariances predict.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.projection_uncertainty import (
    projection_diff_px,
    projection_uncertainty_px,
)
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import PINHOLE_PARAMETERS
from venus3d.engine.geometry.lenses import BROWN5
from venus3d.engine.geometry.pose import Array
from venus3d.study.pool import ViewPool
from venus3d.study.runner import Row
from venus3d.study.text import table

FEWEST = 8
"""Views of a recording that can be cut into halves."""
_KINDS = {"noise_only": "independent noise", "shared": "with shared errors"}


def halves(pool: ViewPool, cuts: int, seed: int) -> list[Row]:
    """A row for each cut: how far the halves' parameters differ, in joint sigmas, and the cameras'
    distance over the predicted one; for both covariances.

    Cuts whose halves do not determine the camera are left out. Raises `CalibrationError` for a
    recording of too few views, and if no cut can be calibrated.
    """
    if len(pool.observations) < FEWEST:
        raise CalibrationError(
            f"{pool.name} has {len(pool.observations)} different views; halves need at least "
            f"{FEWEST}."
        )
    rows: list[Row] = []
    for cut in range(cuts):
        order = np.random.default_rng([seed, cut]).permutation(len(pool.observations))
        middle = len(order) // 2
        try:
            one, other = (
                calibrate(pool.board, [pool.observations[i] for i in half], lens=pool.lens)
                for half in (order[:middle], order[middle:])
            )
            rows.append({"cut": cut, **_compared(one, other)})
        except CalibrationError:
            continue
    if not rows:
        raise CalibrationError(f"No half of {pool.name} determines the camera by itself.")
    return rows


def _compared(one: Calibration, other: Calibration) -> Row:
    row: Row = {}
    apart = projection_diff_px(one.camera, other.camera)
    off = one.camera.parameters - other.camera.parameters
    joint: dict[str, Array] = {
        "noise_only": one.covariance_noise_only + other.covariance_noise_only,
        "shared": one.covariance + other.covariance,
    }
    for kind, covariance in joint.items():
        sigmas = off / np.sqrt(np.diag(covariance))
        for name, value in zip(PINHOLE_PARAMETERS, sigmas, strict=False):
            row[f"{kind}_{name}"] = round(float(value), 4)
        predicted = projection_uncertainty_px(one.camera, covariance)
        row[f"{kind}_distance"] = round(apart / predicted, 4)
    return row


def halves_text(pool: ViewPool, rows: Sequence[Row]) -> str:
    """The share of parameters beyond 2 sigma and the median distance, as a table."""
    lines: list[list[str]] = []
    lens = "" if pool.lens == BROWN5 else f", {pool.lens.name}"
    for kind, name in _KINDS.items():
        sigmas = np.array([[float(row[f"{kind}_{p}"]) for p in PINHOLE_PARAMETERS] for row in rows])
        beyond = 100 * (np.abs(sigmas) > 2).mean(axis=0)
        distance = np.median([float(row[f"{kind}_distance"]) for row in rows])
        lines.append(
            [
                f"{pool.name}, {len(pool.observations)} views{lens}: {name}",
                f"{beyond.mean():.0f} %",
                *(f"{share:.0f} %" for share in beyond),
                f"{distance:.2f}",
            ]
        )
    return table(
        ["beyond 2 σ (5 % is right)", "all", *PINHOLE_PARAMETERS, "distance / predicted"], lines
    )
