"""The curve of noise against plain geometry, against itself fitted, and against fresh renders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.calibration.rendered_noise import NoiseRow, fit_noise, measure_noise
from venus3d.engine.calibration.corner_noise import RENDERED, tilt_and_width
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.engine.planning.posterior import Posterior
from venus3d.sources.sim_cameras import SIM_CAMERAS


@pytest.mark.parametrize("lens", [PAPER_CAMERA.without_distortion(), SIM_CAMERAS["fisheye"]])
def test_the_width_is_the_smallest_extent_of_a_square(
    lens: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """A small circle about the board's centre, projected: an ellipse, its short axis."""
    space = Space(default_board, lens, Limits())
    vectors = np.array([random_pose(space, rng) for _ in range(30)])
    tilt, width = tilt_and_width(lens, default_board, vectors)
    angle = np.linspace(0, 2 * np.pi, 400)
    radius = 1e-5
    circle = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    from venus3d.engine.geometry.pose import Pose

    for vector, a, w in zip(vectors, tilt, width, strict=True):
        pose = Pose.from_vector(vector)
        out = lens.project(pose.apply(circle)) - lens.project(pose.t)
        short = np.linalg.norm(out, axis=1).min() / radius
        assert w == pytest.approx(short * default_board.square, rel=1e-3)
        cosine = pose.R[:, 2] @ pose.t / np.linalg.norm(pose.t)
        assert a == pytest.approx(np.degrees(np.arccos(cosine)))


def test_noise_grows_with_tilt_and_falling_width() -> None:
    width = np.linspace(16, 79, 30)
    assert (np.diff(RENDERED.sigma(20, width)) < 0).all()
    assert (np.diff(RENDERED.found(20, width)) > 0).all()
    tilt = np.linspace(0, 60, 30)
    assert (np.diff(RENDERED.sigma(tilt, 40)) > 0).all()
    # The same board at the same distance, tilted: narrower, so noisier and less often found.
    turned = 25 * np.cos(np.radians(tilt))
    assert (np.diff(RENDERED.found(tilt, turned)) < 0).all()
    assert RENDERED.sigma(0, 40) == pytest.approx(1) and RENDERED.found(0, 70) > 0.999
    assert np.isfinite(RENDERED.sigma([90, 0], [0, 1e6])).all()


def test_a_view_counts_by_its_weight(paper_camera: Camera, default_board: Board) -> None:
    """A view of weight w is as good as one whose corners have the variance 1 / w."""
    near, far = [30.0, 0, 0, 0, 0, 0.35], [30.0, 0, 0, 0, 0, 0.9]
    vectors = np.array([near, far])
    weight = RENDERED.weight(paper_camera, default_board, vectors)
    assert weight[0] > 1 > 0.5 > weight[1]
    known = np.eye(9) * 10
    noisy = Posterior(default_board, paper_camera, known, noise=RENDERED).after(vectors)
    for i in range(2):
        plain = Posterior(default_board, paper_camera, known / weight[i]).after(vectors[i : i + 1])
        np.testing.assert_allclose(noisy[i] * weight[i], plain[0], rtol=1e-6, atol=1e-15)


def test_the_fit_finds_the_curve_that_made_the_rows(rng: np.random.Generator) -> None:
    truth = replace(RENDERED, noise_power=0.7, tilt_power=0.3, found_px=26.0, found_power=12.0)
    tilt, width = rng.uniform(0, 65, 400), np.exp(rng.uniform(np.log(15), np.log(80), 400))
    sigma = 0.05 * truth.sigma(tilt, width) * np.exp(0.1 * rng.standard_normal(400))
    sigma[::40] *= 20  # views with a corner far off
    found = rng.binomial(40, truth.found(tilt, width)) / 40
    rows = [NoiseRow(*map(float, row)) for row in zip(tilt, width, found, sigma, strict=True)]
    fitted = fit_noise(rows)
    assert fitted.noise_power == pytest.approx(0.7, abs=0.08)
    assert fitted.tilt_power == pytest.approx(0.3, abs=0.15)
    assert fitted.found_px == pytest.approx(26, abs=0.5)
    assert fitted.found_power == pytest.approx(12, abs=1.5)


@pytest.mark.slow
def test_fresh_renders_agree_with_the_curve() -> None:
    rows = measure_noise(60, seed=11)
    tilt, width, found, sigma = np.array(
        [[row.tilt_deg, row.width_px, row.found, row.sigma_px] for row in rows]
    ).T
    assert np.mean(np.abs(found - RENDERED.found(tilt, width))) < 0.08
    good = np.isfinite(sigma) & (found > 0.3)
    ratio = sigma[good] / (0.032 * RENDERED.sigma(tilt[good], width[good]))
    assert 0.8 < np.median(ratio) < 1.25
    assert np.median(np.abs(np.log(ratio))) < 0.35
