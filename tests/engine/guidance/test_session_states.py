"""Whatever a user presses, in whatever order: what must hold of every state that can be reached."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import CalibrationError, VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.settings import COSTS, METHODS, STRATEGIES

_ODDS = {
    "look": 8,
    "work": 5,
    "capture": 1,
    "skip": 1,
    "undo": 1,
    "drop": 1,
    "choose": 2,
    "change": 2,
    "fail": 0.5,
    "board": 0.5,
    "finish": 0.3,
    "resume": 0.3,
    "restart": 0.1,
}


class User:
    """Somebody with a board who presses anything at any time."""

    def __init__(self, camera: Camera, board: Board, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.camera, self.board = camera, board
        settings = Settings(max_views=int(self.rng.integers(3, 9)), seed=seed)
        self.session = Session(board, camera.image_size, settings)
        self.pose = Pose.from_vector([10, 0, 0, 0, 0, 0.5])
        self.ended = False

    def act(self, action: str) -> None:
        session, rng, pending = self.session, self.rng, self.session.pending
        if action == "look":
            self.follow(session.observe(self.seen()))
        elif action == "work" and pending is not None:
            halted = bool(rng.random() < 0.3)
            self.follow(session.apply(pending.run(lambda: halted)))
        elif action == "fail" and pending is not None:
            session.fail(pending, CalibrationError("It could not be done."))
        elif action == "drop" and session.snapshot().views:
            session.drop_view(int(rng.choice([view.number for view in session.snapshot().views])))
        elif action == "choose":
            session.choose_alternative(int(rng.integers(3)))
        elif action == "change":
            cost = None if rng.random() < 0.5 else COSTS[rng.integers(len(COSTS))]
            with suppress(VenusError):  # what does not go together
                session.change_method(METHODS[rng.integers(len(METHODS))], cost)
        elif action == "board":
            other = replace(self.board, legacy=bool(rng.random() < 0.5))
            self.follow(session.observe(replace(self.seen(), board=other)))
        elif action == "finish":
            session.finish()
            self.ended = True
        elif action in ("resume", "restart"):
            (session.resume if action == "resume" else session.restart)()
            self.ended = False
        elif action == "capture":
            session.capture()
        elif action == "skip":
            session.skip_target()
        elif action == "undo":
            session.undo_view()

    def seen(self) -> Observation:
        pixels = self.camera.project(self.pose.apply(self.board.corners))
        pixels = pixels + self.rng.normal(0, 0.3, pixels.shape)
        inside = ((pixels >= 0) & (pixels < self.camera.image_size)).all(axis=1)
        return Observation(np.flatnonzero(inside), pixels[inside], self.camera.image_size)

    def follow(self, snapshot: Snapshot) -> None:
        if snapshot.target is not None:
            self.pose = snapshot.target.pose


@pytest.mark.parametrize("seed", range(12))
def test_what_holds_whatever_is_pressed(
    seed: int, paper_camera: Camera, default_board: Board, monkeypatch: pytest.MonkeyPatch
) -> None:
    budgets = dict(zip(STRATEGIES, (14, 200, 50, 60), strict=True))
    monkeypatch.setattr("venus3d.engine.planning.search.BUDGET", budgets)
    user = User(paper_camera, default_board, seed)
    odds = np.array(list(_ODDS.values()))
    for action in user.rng.choice(list(_ODDS), size=60, p=odds / odds.sum()):
        user.act(str(action))
        now = user.session.snapshot()
        assert (now.phase == "captured") == (user.session.pending is not None)
        assert not user.ended or now.phase in ("captured", "finished"), "what is ended stays so"
        assert now.phase != "guiding" or now.target is not None or now.warnings
        assert now.phase not in ("converged", "finished") or now.target is None
        assert [p.views for p in now.history] == sorted({p.views for p in now.history})
        assert not now.history or now.history[-1].views <= len(now.views)
