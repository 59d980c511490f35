"""The arms on simulated corners, their indicators, and who is said to win."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.stats import ttest_rel

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.sources.sim_cameras import SIM_CAMERAS
from venus3d.study.figures import FIGURES, INDICATORS, judge_figure, verdicts_text
from venus3d.study.plots import draw_figure
from venus3d.study.runner import Value
from venus3d.study.simulated import (
    ARMS,
    NOISE_PX,
    ArmTrial,
    abs_rms_err_px,
    first_pose,
    guided_calibrations,
    observed,
    points_before,
    run_arm,
)


def test_abs_rms_err_is_the_distance_of_opencvs_two_projections() -> None:
    estimate = replace(PAPER_CAMERA, fx=1071.0, cx=638.0, k1=0.01)
    points = points_before(PAPER_CAMERA)
    true, seen = (
        cv2.projectPoints(points, np.zeros(3), np.zeros(3), c.K, c.distortion)[0].reshape(-1, 2)
        for c in (PAPER_CAMERA, estimate)
    )
    distance = np.sqrt(((true - seen) ** 2).sum(axis=1).mean())
    assert abs_rms_err_px(PAPER_CAMERA, estimate) == pytest.approx(distance, rel=1e-6)
    assert np.ptp(true[:, 0]) > 0.9 * PAPER_CAMERA.width  # the points fill the picture


def test_a_walk_starts_as_the_paper_does_and_noise_is_shared_between_methods() -> None:
    board = Board()
    walks = {
        name: list(guided_calibrations(ARMS[name].settings, 4, seed=3, repeat=1))
        for name in ("random", "global")
    }
    first, other = (stages[0].outcome.work.observations[0] for stages in walks.values())
    np.testing.assert_array_equal(first.corners, other.corners)
    angles = walks["global"][0].poses[0].vector()[:3]
    np.testing.assert_allclose(angles, [45, 0, 0], atol=1e-9)
    for stages in walks.values():
        last = stages[-1]
        for pose, view in zip(last.poses, last.outcome.work.observations, strict=True):
            exact, _ = cv2.projectPoints(
                board.corners[view.ids], pose.rvec, pose.t, PAPER_CAMERA.K, PAPER_CAMERA.distortion
            )
            off = view.corners - exact.reshape(-1, 2)
            assert 0.7 * NOISE_PX < off.std() < 1.3 * NOISE_PX
        # The calibration is that of these observations, and nothing else.
        again = calibrate(board, last.outcome.work.observations)
        np.testing.assert_allclose(
            again.camera.parameters, last.outcome.calibration.camera.parameters, rtol=1e-6
        )


def test_a_fisheye_is_guided_and_measured_by_rays() -> None:
    """Its grid reaches beside the lens; `global` leaves less error than random poses."""
    truth = SIM_CAMERAS["fisheye"]
    points = points_before(truth)
    assert points[:, 2].min() < 0 and len(points) == 96
    assert abs_rms_err_px(truth, replace(truth, fx=truth.fx * 1.001)) > 0.1
    left = {
        arm: float(run_arm(ArmTrial(arm, 0, 0, 3, "fisheye"))[-1]["true_projection_error_px"])
        for arm in ("random", "pose-selection", "global")
    }
    assert left["global"] < min(left["random"], left["pose-selection"])


def test_the_first_board_is_as_near_as_the_picture_allows() -> None:
    pose, board = first_pose(PAPER_CAMERA, Board()), Board()
    assert pose.t[2] == pytest.approx(0.3, abs=0.15)
    seen = observed(PAPER_CAMERA, board, pose, np.random.default_rng(0))
    assert seen.count == board.corner_count


@pytest.fixture
def one_thread() -> Iterator[None]:
    """As the runner has it: OpenCV's threads add up in no fixed order."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    yield
    cv2.setNumThreads(before)


@pytest.mark.usefixtures("one_thread")
@pytest.mark.parametrize("arm", ["random", "pose-selection", "venus", "global"])
def test_the_same_trial_gives_the_same_rows(arm: str) -> None:
    trial = ArmTrial(arm, 2, 7, 3)
    rows = run_arm(trial)
    assert repr(rows) == repr(run_arm(trial))
    assert [row["views"] for row in rows] == [1, 2, 3]
    assert rows[0]["model"] == "startup" and rows[-1]["model"] == "full"
    assert repr(run_arm(replace(trial, seed=8))) != repr(rows)


def _rows(advantage: float) -> list[dict[str, Value]]:
    """Known logarithms: Figure 9's second arm is better by `advantage` from the 4th view on."""
    rng = np.random.default_rng(4)
    rows: list[dict[str, Value]] = []
    for arm in ARMS:
        gain = advantage if arm == FIGURES[3].arms[1] else 0.0
        for repeat in range(12):
            for views in range(1, 9):
                value = float(np.exp(rng.normal(0, 0.1) - (gain if views >= 4 else 0.0)))
                names = {"arm": arm, "repeat": repeat, "views": views}
                rows.append({**names, **dict.fromkeys(INDICATORS, value)})
    return rows


def test_the_winner_is_the_one_that_leads_to_the_end() -> None:
    rows = _rows(0.5)
    verdict = judge_figure(rows, FIGURES[3])[0]
    assert (verdict.winner, verdict.since, verdict.agrees) == ("venus", 4, "yes")
    last = [
        np.log([row["sum_iod"] for row in rows if row["arm"] == arm and row["views"] == 8])
        for arm in FIGURES[3].arms
    ]
    low, high = ttest_rel(last[1], last[0]).confidence_interval(0.95)
    np.testing.assert_allclose(np.log(verdict.interval), (low, high), rtol=1e-6)
    assert judge_figure(_rows(-0.5), FIGURES[3])[0].agrees == "the reverse"
    equal = judge_figure(_rows(0.0), FIGURES[3])[0]
    assert equal.winner == "" and equal.agrees == "not shown"
    text = verdicts_text(rows)
    for words in ("beyond 5 views", "Pose search, from 4 views on", "neither", "no such pair"):
        assert words in text


def test_a_figure_is_drawn_with_the_names_of_its_lines(tmp_path: Path) -> None:
    png, svg = draw_figure(_rows(0.5), FIGURES[3], tmp_path)
    image = cv2.imread(str(png))
    assert image is not None and image.shape[:2] == (1125, 1999)
    text = svg.read_text()
    for words in ("Pose selection", "Pose search", "ln SumIOD", "AbsRmsErr, rotation removed"):
        assert words in text
    again = draw_figure(_rows(0.5), FIGURES[3], tmp_path / "again")
    assert again[1].read_bytes() == svg.read_bytes()
