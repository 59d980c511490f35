"""The forecast: what it counts, how sure it is of it, and whether its interval can be trusted."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.engine.planning.suggestions import suggestion
from venus3d.engine.calibration.information import view_information
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.forecast import AHEAD, Forecast, forecast, spread_of
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import METHODS, Cost, Method, PlanningSettings
from venus3d.engine.planning.suggest import Planner

SIGMA = 0.2
SEEN = ([45, 0, 0, 0, 0, 0.4], [-20, 25, 0, 0.05, 0, 0.4])


def told_by(camera: Camera, board: Board, pose: Pose) -> Array:
    return view_information(camera, board.corners, pose.R[None], pose.t[None])[0]


def ask(
    camera: Camera,
    board: Board,
    known: Array,
    *,
    method: Method = "global",
    cost: Cost | None = None,
    views: int = 2,
    wanted_px: float = 0.3,
    first: Array | None = None,
    ahead: int = AHEAD,
    stop: bool = False,
) -> Forecast | None:
    posterior = Posterior.of(board, camera, known, SIGMA)
    space = Space(board, posterior.camera, Limits.for_board(board, posterior.camera))
    return forecast(
        Planner(posterior, PlanningSettings(method, cost), space, stop=lambda: stop),
        np.random.default_rng(0),
        wanted_px=wanted_px,
        degrees=80 * views - 9 - 6 * views,
        first=first,
        ahead=ahead,
    )


@pytest.fixture(scope="module")
def known(paper_camera: Camera, default_board: Board) -> Array:
    poses = [Pose.from_vector(vector) for vector in SEEN]
    return np.sum([told_by(paper_camera, default_board, pose) for pose in poses], axis=0)


def test_the_spread_holds_nine_of_ten_draws_of_the_noise(rng: np.random.Generator) -> None:
    """Monte Carlo: true sigma over the one estimated from so many residuals."""
    for degrees in (20, 200):
        best, worst = spread_of(degrees)
        estimated = np.sqrt((rng.standard_normal((4000, degrees)) ** 2).mean(axis=1))
        inside = (best <= 1 / estimated) & (1 / estimated <= worst)
        assert inside.mean() == pytest.approx(0.9, abs=0.02)
        assert best < 1 < worst


def test_following_the_suggestions_takes_as_many_views_as_was_said(
    paper_camera: Camera, default_board: Board, known: Array
) -> None:
    """Each target followed exactly: the count must come out within the interval, at each view."""
    said: list[Forecast] = []
    information, views = known, len(SEEN)
    while not said or said[-1].views != 0:
        made = suggestion(
            default_board,
            paper_camera,
            information,
            SIGMA,
            rng=np.random.default_rng(views),
            number=views,
        )
        first = made.target.pose.vector()
        now = ask(paper_camera, default_board, information, views=views, first=first)
        assert now is not None and len(said) < 12
        said.append(now)
        information = information + told_by(paper_camera, default_board, made.target.pose)
        views += 1
    needed = len(said) - 1
    assert 4 <= needed <= AHEAD
    for i, now in enumerate(said[:-1]):
        left = needed - i
        assert now.low is not None and now.low <= left and left <= (now.high or AHEAD)
        assert now.views is not None and abs(now.views - left) <= 2


def test_what_is_reached_needs_no_more_views_and_what_is_far_is_left_open(
    paper_camera: Camera, default_board: Board, known: Array
) -> None:
    reached = ask(paper_camera, default_board, known, wanted_px=50)
    assert reached == Forecast(50, 0, 0, 0, 0)
    far = ask(paper_camera, default_board, known, wanted_px=0.001, ahead=3)
    assert far == Forecast(0.001, None, None, None, 3)


def test_it_stops_when_asked(paper_camera: Camera, default_board: Board, known: Array) -> None:
    assert ask(paper_camera, default_board, known, stop=True) is None


@pytest.mark.parametrize("method", METHODS)
def test_a_method_that_needs_more_views_is_forecast_more(
    method: Method, paper_camera: Camera, default_board: Board, known: Array
) -> None:
    best = ask(paper_camera, default_board, known, wanted_px=0.6)
    now = ask(paper_camera, default_board, known, method=method, wanted_px=0.6)
    assert best is not None and best.views is not None and now is not None
    assert now.views is None or now.views >= best.views


def test_another_cost_is_forecast_by_the_poses_that_it_asks_for(
    paper_camera: Camera, default_board: Board, known: Array
) -> None:
    """A walk of whole searches on MaxIOD, a cost that serves the picture badly, is the oracle."""
    space = Space(default_board, paper_camera, Limits.for_board(default_board, paper_camera))
    posterior, needed = Posterior.of(default_board, paper_camera, known, SIGMA), 0
    while posterior.uncertainty_px > 0.6:
        rng = np.random.default_rng([7, needed])
        planner = Planner(posterior, PlanningSettings("global", "max-iod"), space)
        posterior = posterior.with_view(planner.find_pose(rng)[0].vector)
        needed += 1
    now = ask(paper_camera, default_board, known, cost="max-iod", wanted_px=0.6)
    usual = ask(paper_camera, default_board, known, wanted_px=0.6)
    assert now is not None and now.low is not None and usual is not None
    assert usual.views is not None and usual.views < needed
    assert abs((now.views or AHEAD) - needed) <= 2 and now.low <= needed
    assert now.low > usual.views, "the default cost needs fewer"


def test_limits_that_leave_no_pose_are_told(
    paper_camera: Camera, default_board: Board, known: Array
) -> None:
    posterior = Posterior.of(default_board, paper_camera, known, SIGMA)
    narrow = Limits(max_tilt_deg=0.01, max_angle_deg=0.01, nearest=0.9, farthest=0.901)
    space = Space(default_board, paper_camera, narrow)
    with pytest.raises(VenusError, match="No pose of this board fits"):
        planner = Planner(posterior, PlanningSettings("global"), space)
        forecast(planner, np.random.default_rng(0), wanted_px=0.1, degrees=99)


def test_a_slow_search_does_not_keep_the_target_waiting(
    paper_camera: Camera, default_board: Board, known: Array, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked_at: list[int] = []
    whole = Planner.find_pose

    def counted(*args: Any, **options: Any) -> Any:
        found = whole(*args, **options)
        looked_at.append(found[0].evaluated)
        return found

    monkeypatch.setattr(Planner, "find_pose", counted)
    posterior = Posterior.of(default_board, paper_camera, known, SIGMA)
    space = Space(default_board, paper_camera, Limits.for_board(default_board, paper_camera))
    slow = PlanningSettings("venus", strategy="dual-annealing")
    rng = np.random.default_rng(0)
    planner = Planner(posterior, slow, space)
    forecast(planner, rng, wanted_px=0.001, degrees=99, ahead=2)
    assert len(looked_at) == 2 and max(looked_at) <= 1100
