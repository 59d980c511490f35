"""Eqs (16), (17): as printed, repaired, and on simulated calibrations."""

from __future__ import annotations

import numpy as np
import pytest

from tests.engine.planning.suggestions import suggestion
from venus3d.engine.calibration.information import covariance_of, view_information
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.convergence import MIN_VIEWS, Progress, check_convergence


def progress(views: int, *sigma: float) -> Progress:
    values = np.array(sigma) if len(sigma) == 9 else np.full(9, sigma[0])
    return Progress(views, 0.4, np.ones(9), values, 1.0)


def test_nothing_to_compare_with() -> None:
    for rule in ("printed", "repaired"):
        verdict = check_convergence([progress(1, 1.0)], rule=rule)  # type: ignore[arg-type]
        assert not verdict.converged and np.isnan(verdict.ratio).all()
        assert not check_convergence([], rule=rule).converged  # type: ignore[arg-type]


def test_printed_to_the_letter() -> None:
    """phi = 1 where 1 - r <= epsilon, r the ratio of variances; also where it grew."""
    old = progress(2, *[1.0] * 9)
    new = progress(3, *np.sqrt([0.5, 0.89, 0.91, 1.0, 1.2, 3.0, 0.2, 0.8999, 0.9001]))
    verdict = check_convergence([old, new], rule="printed")
    np.testing.assert_allclose(verdict.ratio, [0.5, 0.89, 0.91, 1, 1.2, 3, 0.2, 0.8999, 0.9001])
    assert verdict.parameters == (False, False, True, True, True, True, False, False, True)


def test_repaired_asks_of_standard_deviations_and_not_of_growth() -> None:
    old = progress(MIN_VIEWS - 1, *[1.0] * 9)
    new = progress(MIN_VIEWS, *[0.5, 0.89, 0.91, 1.0, 1.01, 3.0, 0.2, 0.899, 0.901])
    verdict = check_convergence([old, new])
    assert verdict.parameters == (False, False, True, True, False, False, False, False, True)
    assert not check_convergence([old, new], epsilon=0.001).parameters[2]


def test_no_verdict_from_few_views() -> None:
    history = [progress(n, 1.0) for n in range(1, MIN_VIEWS)]
    assert not any(check_convergence(history).parameters)
    assert check_convergence([*history, progress(MIN_VIEWS, 1.0)]).converged


def test_a_verdict_is_kept() -> None:
    history = [progress(n, 1.0) for n in (MIN_VIEWS, MIN_VIEWS + 1)]
    assert check_convergence([*history, progress(MIN_VIEWS + 2, 0.5)]).converged
    assert not check_convergence([*history, progress(MIN_VIEWS + 2, 0.5)], rule="printed").converged


def test_a_parameter_that_was_held_fixed_has_no_ratio() -> None:
    fixed = progress(MIN_VIEWS - 1, 1, 1, 0, 0, 0, 0, 0, 0, 0)
    verdict = check_convergence([fixed, progress(MIN_VIEWS, 1.0)])
    assert verdict.parameters == (True, True) + (False,) * 7
    assert np.isnan(verdict.ratio[2:]).all() and not np.isnan(verdict.ratio[:2]).any()


@pytest.mark.slow
def test_a_guided_calibration_converges_between_6_and_14_views(
    paper_camera: Camera, default_board: Board
) -> None:
    """On predicted sigmas; the camera is then known to better than half a pixel."""
    for seed in range(3):
        rng = np.random.default_rng(seed)
        first = Pose.from_vector([45, 0, 0, 0, 0, 0.4])
        information = np.zeros((9, 9))
        history: list[Progress] = []
        pose = first
        for views in range(1, 15):
            information = (
                information
                + view_information(paper_camera, default_board.corners, pose.R[None], pose.t[None])[
                    0
                ]
            )
            if views > 1:
                covariance = covariance_of(information, np.sqrt(0.1))
                error = projection_uncertainty_px(paper_camera, covariance)
                history.append(
                    Progress(
                        views, 0.4, paper_camera.parameters, np.sqrt(np.diag(covariance)), error
                    )
                )
                if check_convergence(history).converged:
                    break
            pose = suggestion(
                default_board, paper_camera, information, np.sqrt(0.1), rng=rng, number=views + 1
            ).target.pose
        assert check_convergence(history).converged and 6 <= history[-1].views <= 14
        assert history[-1].uncertainty_px < 0.5
