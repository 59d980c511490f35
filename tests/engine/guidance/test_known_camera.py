"""A session that starts from a known camera: it guides, and it is no part of the result."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np

from tests.engine.calibration.test_adjustment import GOOD, observe
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.known_camera import KnownCamera, KnownStart
from venus3d.engine.guidance.session import KNOWN_IS_ANOTHER, Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.posterior import Posterior
from venus3d.storage.session_events import captured_event, state_event, state_of

SIGMA = np.array([0.3, 0.3, 0.3, 0.3, 2e-3, 1e-2, 1e-4, 1e-4, 2e-2])


def known_but(camera: Camera, *open_ones: int) -> KnownCamera:
    """A camera of which all is known well but for these parameters."""
    sigma = SIGMA.copy()
    sigma[list(open_ones)] *= 300
    return KnownCamera.of(camera, np.diag(sigma**2))


def test_target_1_is_for_what_is_open(
    default_board: Board, paper_camera: Camera, rng: np.random.Generator
) -> None:
    """Without any view, the pose serves what is known badly, and lowers it most."""
    served: list[tuple[str, ...]] = []
    for open_ones in ((0, 1), (4, 5, 8)):
        known = known_but(paper_camera, *open_ones)
        session = Session(default_board, paper_camera.image_size, known=known)
        target = session.observe(observe(paper_camera, default_board, GOOD[0], rng)).target
        assert target is not None
        served.append(target.serves)
        posterior = Posterior.of(
            default_board, paper_camera, np.zeros((9, 9)), 0.25, known=known.information
        )
        found = np.sqrt(np.diag(posterior.after(target.pose.vector())[0]))
        assert found[open_ones[0]] < SIGMA[open_ones[0]] * 300 / 3
    assert set(served[0]) & {"fx", "fy"} and not set(served[1]) & {"fx", "fy"}


def test_the_result_is_that_of_the_views_alone(
    default_board: Board, paper_camera: Camera, rng: np.random.Generator
) -> None:
    """A known camera that is far off, and believed, does not draw it."""
    wrong = replace(paper_camera, fx=paper_camera.fx * 1.1, cx=paper_camera.cx + 30)
    known = KnownCamera.of(wrong, np.diag(SIGMA**2))
    settings = Settings(auto_capture=False, method="random")
    session = Session(default_board, paper_camera.image_size, settings, known=known)
    for vector in GOOD[:4]:
        session.observe(observe(paper_camera, default_board, vector, rng, 0.1))
        assert session.capture()
        first = session.run_pending()
        if len(first.views) == 1:
            assert first.camera.fx == wrong.fx and first.phase == "guiding"
    alone = calibrate(default_board, [view.observation for view in session.state.views])
    assert first.calibration is not None
    np.testing.assert_allclose(first.calibration.camera.parameters, alone.camera.parameters)
    np.testing.assert_allclose(first.calibration.covariance, alone.covariance)


def test_a_camera_that_cannot_see_the_board_so_is_left_behind(
    default_board: Board, paper_camera: Camera, rng: np.random.Generator
) -> None:
    """No view was ever captured. Single blurred pictures, and the right camera, change nothing."""
    settings = Settings(auto_capture=False, method="random")
    bent = replace(paper_camera, coefficients=(-5.0, 20.0, 0.0, 0.0, 0.0))
    longer = replace(paper_camera, fx=3 * paper_camera.fx, fy=3 * paper_camera.fy)
    beside = replace(paper_camera, cx=1e6)
    for camera in (bent, longer, beside, paper_camera):
        known = KnownCamera.of(camera)
        session = Session(default_board, paper_camera.image_size, settings, known=known)
        warnings = [
            session.observe(observe(paper_camera, default_board, vector, rng, 0.1)).warnings
            for vector in [*GOOD[:4], *GOOD[:4]]
        ]
        assert not any(warnings[:4])
        assert (KNOWN_IS_ANOTHER in warnings[4]) == (camera != paper_camera)
        assert (session.state.known is None) == (camera != paper_camera)
        assert session.capture(), "without it a view is a view"


def test_it_is_in_the_journal(
    default_board: Board, paper_camera: Camera, rng: np.random.Generator
) -> None:
    known = known_but(paper_camera, 0)
    settings = Settings(auto_capture=False, method="random")
    session = Session(default_board, paper_camera.image_size, settings, known=known)
    session.observe(observe(paper_camera, default_board, GOOD[0], rng, 0.1))
    session.capture()
    state = session.state
    lines = [captured_event(state.views[0], None), state_event(state)]
    again = state_of(json.loads(json.dumps(lines)))
    assert again is not None and again.known is not None
    np.testing.assert_array_equal(again.known.information, known.information)
    other = Session(default_board, paper_camera.image_size, settings)
    other.restore(again)
    np.testing.assert_array_equal(
        other.run_pending().camera.parameters, session.run_pending().camera.parameters
    )


def test_what_is_no_covariance_counts_as_unknown(paper_camera: Camera) -> None:
    assert not KnownCamera.of(paper_camera).has_uncertainty
    for matrix in (np.zeros((9, 9)), np.ones((9, 9)), np.full((9, 9), np.nan)):
        assert not KnownCamera.of(paper_camera, matrix).has_uncertainty
    held = np.diag(SIGMA**2)
    held[8, 8] = 0.0
    known = KnownCamera.of(paper_camera, held)
    np.testing.assert_allclose(np.diag(known.information)[:8], 1 / SIGMA[:8] ** 2)
    assert known.information[8, 8] == 0


def test_limits_without_a_pose_leave_no_target(default_board: Board, paper_camera: Camera) -> None:
    settings = Settings(limits={"nearest": 5.0, "farthest": 5.1})
    start = KnownStart(default_board, KnownCamera.of(paper_camera), settings)
    assert start.updated_target(None, 1, "global", None) is None
