"""A session that has got somewhere, for tests that draw what is known, and moments of one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.remaining import remaining_steps
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot


def guided_session(camera: Camera, board: Board, settings: Settings) -> Snapshot:
    """A session after five views of a board well spread over the picture."""
    noise = np.random.default_rng(7)
    session = Session(board, camera.image_size, settings)
    for vector in (
        [30, 5, 0, 0, 0, 0.45],
        [-25, 20, 10, 0.1, 0.05, 0.4],
        [10, -35, -20, -0.1, -0.05, 0.45],
        [-20, -20, 30, 0.13, -0.06, 0.4],
        [20, -30, 180, -0.12, 0.06, 0.42],
    ):
        pixels = camera.project(Pose.from_vector(vector).apply(board.corners))
        pixels = pixels + noise.normal(0, 0.2, pixels.shape)
        inside = ((pixels > 0) & (pixels < np.array(camera.image_size) - 1)).all(axis=1)
        seen = Observation(np.flatnonzero(inside), pixels[inside], camera.image_size)
        session.observe(seen)
        session.capture()
        session.run_pending()
    return session.snapshot()


def matched(snapshot: Snapshot, match: Match | None) -> Snapshot:
    """The snapshot with this match, and what remains by it."""
    remaining = remaining_steps(snapshot.phase, snapshot.target, match)
    return replace(snapshot, match=match, remaining=remaining)
