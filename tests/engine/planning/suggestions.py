"""The next target from bare information matrices, as the tests of the planning ask for it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from venus3d.engine.calibration.corner_noise import NoiseModel
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.pose_space import Space
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import PlanningSettings
from venus3d.engine.planning.suggest import NextTarget, Planner


def suggestion(
    board: Board,
    camera: Camera,
    information: Array,
    sigma_px: float,
    settings: PlanningSettings | None = None,
    *,
    rng: np.random.Generator,
    number: int,
    noise: NoiseModel | None = None,
    skipped: Iterable[Pose] = (),
    state: HeuristicState | None = None,
    **others: Any,
) -> NextTarget:
    """The planner's next target after views of this information (9, 9)."""
    settings = settings or PlanningSettings()
    posterior = Posterior.of(board, camera, information, sigma_px, noise)
    space = Space.of(posterior, settings, skipped)
    return Planner(posterior, settings, space, **others).next_target(number, rng, state)
