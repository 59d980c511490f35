"""Whether an existing camera still holds: false alarms and misses over seeded draws, and the level
of chance against Monte Carlo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import (
    GRID,
    projection_diff_map,
    projection_diff_px,
)
from venus3d.engine.calibration.turned_pictures import turned, turned_camera
from venus3d.engine.calibration.verification import CHANCE, verify
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.image_circle import ImageCircle
from venus3d.engine.geometry.lenses import BROWN5, RATIONAL, RATIONAL_THIN_PRISM
from venus3d.engine.geometry.lenses.lens_model import LensModel
from venus3d.engine.geometry.pose import Pose

BOARD = Board()
NOISE_PX = 0.05


def calibrated(seed: int, camera: Camera = PAPER_CAMERA, views: int = 10) -> Calibration:
    """From tilted views all over the picture."""
    rng = np.random.default_rng(seed)
    seen: list[Observation] = []
    while len(seen) < views:
        pose = Pose.from_vector(
            [*rng.uniform(-45, 45, 2), rng.uniform(-180, 180), *rng.uniform(-0.15, 0.15, 2), 0.45]
        )
        pixels = camera.project(pose.apply(BOARD.corners)) + rng.normal(0, NOISE_PX, (40, 2))
        inside = ((pixels > 0) & (pixels < [1279, 719])).all(axis=1)
        if inside.sum() >= 25:
            seen.append(Observation(np.flatnonzero(inside), pixels[inside], camera.image_size))
    return calibrate(BOARD, seen)


@pytest.fixture(scope="module")
def calibrations() -> list[Calibration]:
    """Forty of one camera."""
    return [calibrated(seed) for seed in range(40)]


def test_an_unchanged_camera_is_hardly_ever_called_changed(
    calibrations: list[Calibration],
) -> None:
    pairs = zip(calibrations[::2], calibrations[1::2], strict=True)
    found = [verify(old.camera, old.covariance, new) for old, new in pairs]
    beyond = sum(one.changed_px > 0 for one in found)
    assert beyond <= 2, "1 in 100 by chance, twenty checks"
    # Neither is the level so high that nothing could be seen.
    assert np.median([one.chance_px / one.diff_px for one in found]) < 4
    assert {one.verdict for one in found} <= {"good", "unclear"}


def test_chance_is_the_quantile_of_what_two_calibrations_differ_by(
    calibrations: list[Calibration],
) -> None:
    old, new = calibrations[:2]
    found = verify(old.camera, old.covariance, new)
    drawn = np.random.default_rng(0).multivariate_normal(
        new.camera.parameters, old.covariance + new.covariance, 1000
    )
    differences = [
        projection_diff_px(new.camera, Camera.from_parameters(p, new.camera.image_size))
        for p in drawn[:300]
    ]
    beyond = np.mean(np.array(differences) > found.chance_px)
    assert abs(beyond - CHANCE) < 0.02
    assert found.chance_px == pytest.approx(np.quantile(differences, 1 - CHANCE), rel=0.25)


def test_a_change_is_told_by_its_size(calibrations: list[Calibration]) -> None:
    moved = {
        "degraded": replace(PAPER_CAMERA, fx=1068 * 1.012, fy=1073 * 1.012),
        "other-camera": replace(PAPER_CAMERA, fx=1068 * 1.1, fy=1073 * 1.1),
    }
    old = calibrations[0]
    for verdict, camera in moved.items():
        fresh = calibrated(100, camera)
        found = verify(old.camera, old.covariance, fresh)
        assert found.verdict == verdict
        assert found.diff_px == pytest.approx(projection_diff_px(PAPER_CAMERA, camera), rel=0.35)
        assert found.changes[0] > 3
        assert found.rms_px > found.fresh.rms_px
    assert verify(old.camera, old.covariance, calibrated(101), limit_px=1e-3).verdict == "unclear"


def test_views_that_leave_one_thing_open_show_the_others() -> None:
    """Few views that hardly tilt leave f open by pixels; a file without distortion is seen all the
    same, and one of unchanged cameras in a hundred or two is called changed."""
    bent = replace(PAPER_CAMERA, k1=-0.25, k2=0.1, k3=0.0)
    fresh = calibrated(3, bent, views=10)
    open_f = 30.0 * np.outer(np.eye(9)[0], np.eye(9)[0])  # f of the existing one known to 5 px
    straight = replace(fresh.camera, k1=0.0, k2=0.0, p1=0.0, p2=0.0, k3=0.0)
    found = verify(straight, open_f, fresh, limit_px=0.5)
    assert found.chance_px > 0.5, "a change of the limit's size could not be seen in all"
    assert found.verdict == "degraded" and found.changed_px > 0.9 * found.diff_px
    same = verify(fresh.camera, open_f, fresh, limit_px=0.5)
    assert same.verdict == "unclear" and same.changed_px == 0


@pytest.mark.parametrize("lens", [BROWN5, RATIONAL_THIN_PRISM], ids=lambda lens: lens.name)
def test_the_turned_camera_sees_all_where_the_turned_picture_has_it(lens: LensModel) -> None:
    """Turned about the line of sight by 180°, the world is in the turned picture."""
    camera = replace(PAPER_CAMERA.with_lens(lens), image_circle=ImageCircle(600.0, 300.0, 500.0))
    camera = replace(camera, coefficients=tuple(0.01 * n for n in range(len(camera.coefficients))))
    back, signs = turned_camera(camera)
    points = np.random.default_rng(0).uniform([-0.2, -0.1, 0.6], [0.2, 0.1, 0.9], (50, 3))
    there = np.array(camera.image_size) - 1 - camera.project(points)
    np.testing.assert_allclose(back.project(points * [-1, -1, 1]), there, atol=1e-9)
    again, _ = turned_camera(back)
    np.testing.assert_allclose(again.parameters, camera.parameters, atol=1e-12)
    assert again.image_circle == camera.image_circle != back.image_circle
    step = 1e-6 * np.ones(len(signs))
    moved = Camera.from_parameters(camera.parameters + step, camera.image_size, lens)
    change = turned_camera(moved)[0].parameters - back.parameters
    np.testing.assert_allclose(change, signs * step, atol=1e-9)


def test_turned_pictures_are_named_and_no_other_change_is(calibrations: list[Calibration]) -> None:
    old = calibrations[0]
    for new in calibrations[1:6]:
        seen = [turned(view.observation) for view in new.views]
        found = verify(old.camera, old.covariance, calibrate(BOARD, seen))
        assert found.verdict == "turned"
        assert found.turned_back_px is not None and found.diff_px > 4 * found.turned_back_px
    other = calibrated(50, turned_camera(replace(PAPER_CAMERA, fx=1100, fy=1105))[0])
    assert verify(old.camera, old.covariance, other).verdict == "degraded"


def test_a_small_change_within_the_limit_is_no_harm() -> None:
    fresh = calibrated(7, views=20)
    moved = replace(fresh.camera, cx=fresh.camera.cx + 8 * fresh.sigma[2])
    found = verify(moved, None, fresh, limit_px=20)
    assert found.verdict == "good"
    assert found.changes[2] == pytest.approx(-8)


def test_the_difference_in_millimetres_is_that_at_the_boards_distance() -> None:
    fresh = calibrated(1)
    found = verify(replace(fresh.camera, fx=fresh.camera.fx * 1.05), None, fresh)
    assert found.distance_m == pytest.approx(0.48, abs=0.05)
    focal = np.sqrt(fresh.camera.fx * fresh.camera.fy)
    assert found.diff_mm == pytest.approx(found.diff_px / focal * found.distance_m * 1000)


def test_the_maps_mean_square_is_the_difference() -> None:
    other = replace(PAPER_CAMERA, fx=1075, cx=640, k1=0.01)
    found = projection_diff_map(PAPER_CAMERA, other, GRID)
    mean = float(np.sqrt(np.mean(found**2)))
    assert mean == pytest.approx(projection_diff_px(PAPER_CAMERA, other), rel=1e-9)


def test_what_cannot_be_compared_is_refused() -> None:
    fresh = calibrated(1)
    with pytest.raises(CalibrationError, match="640 x 360"):
        verify(PAPER_CAMERA.scaled((640, 360)), None, fresh)
    with pytest.raises(CalibrationError, match="rational, the fresh views were calibrated with br"):
        verify(PAPER_CAMERA.with_lens(RATIONAL), None, fresh)
    start = calibrate(BOARD, [view.observation for view in fresh.views], model="startup")
    with pytest.raises(CalibrationError, match="all parameters"):
        verify(PAPER_CAMERA, None, start)


def test_a_camera_that_does_not_reach_the_corners_is_refused(
    calibrations: list[Calibration],
) -> None:
    """It folds back near the middle: only what it reaches would be compared, which is nothing."""
    fresh = calibrations[0]
    for wrong in (
        replace(PAPER_CAMERA, coefficients=(-50.0, 0.0, 0.0, 0.0, 0.0)),
        replace(PAPER_CAMERA, cx=-1e5, fx=1.0),
    ):
        with pytest.raises(CalibrationError, match="reaches only"):
            verify(wrong, None, fresh)


def test_a_lens_model_that_folds_back_within_the_picture_is_refused(
    calibrations: list[Calibration],
) -> None:
    """All corners are reached, and what no ray reaches was compared by the model's second branch:
    "the camera has changed by 59 px"."""
    fresh = calibrations[0]
    for k1, share in ((-0.6, "24"), (-0.5, "16")):
        wrong = replace(PAPER_CAMERA, coefficients=(k1, 0.0, 0.0, 0.0, 0.0))
        with pytest.raises(CalibrationError, match=rf"no ray reaches {share} % of it \(k1 = {k1}"):
            verify(wrong, None, fresh)


def test_an_absurd_distortion_is_no_change_of_the_camera(calibrations: list[Calibration]) -> None:
    """k1 = 50 was "it no longer holds: the camera has changed by 257 px", with the cure "a loose
    lens", and an rms of "–"."""
    fresh = calibrations[0]
    for coefficients in ((50.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 1e6)):
        with pytest.raises(CalibrationError, match=r"most of the views \(k1 = "):
            verify(replace(PAPER_CAMERA, coefficients=coefficients), None, fresh)
    bent = replace(PAPER_CAMERA, coefficients=(5.0, 0.0, 0.0, 0.0, 0.0))
    assert verify(bent, None, fresh).verdict == "other-camera"
