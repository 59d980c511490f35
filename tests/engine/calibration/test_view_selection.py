"""The choice of frames from a recording, on simulated recordings with known truth."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from tests.engine.calibration.test_adjustment import observe
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.view_selection import select_views
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera


@pytest.fixture
def recording(paper_camera: Camera, default_board: Board) -> list[Observation]:
    """Ten seconds of a board that rests frontally, is waved about for two seconds, rests again."""
    rng = np.random.default_rng(3)
    seen: list[Observation] = []
    for frame in range(250):
        wave = np.clip((frame - 100) / 50, 0, 1) * 2 * np.pi
        vector = np.array(
            [40 * np.sin(2 * wave), 40 * np.sin(wave), 20 * np.sin(3 * wave), 0, 0, 0]
        )
        vector[3:] = [0.06 * np.sin(2 * wave), 0.03 * np.sin(wave), 0.45]
        vector += rng.normal(0, [0.1, 0.1, 0.1, 2e-4, 2e-4, 2e-4])
        seen.append(replace(observe(paper_camera, default_board, vector, rng, 0.3), sharpness=0.5))
    return seen


def test_the_frames_that_say_something_are_taken(
    recording: list[Observation], default_board: Board
) -> None:
    chosen = select_views(default_board, recording, limit=12)
    assert len(chosen) == 12 == len(set(chosen)) and chosen == sorted(chosen)
    assert sum(100 <= i <= 150 for i in chosen) >= 10
    best = calibrate(default_board, [recording[i] for i in chosen])
    every = calibrate(default_board, recording[:: len(recording) // 12])
    assert best.sigma[0] < 0.6 * every.sigma[0]
    assert abs(best.camera.fx - 1068) < 4 * best.sigma[0]


def test_a_larger_limit_never_knows_less(
    recording: list[Observation], default_board: Board
) -> None:
    sigmas = [
        calibrate(
            default_board,
            [recording[i] for i in select_views(default_board, recording, limit=limit)],
        ).sigma[0]
        for limit in (5, 10, 20, 40)
    ]
    assert all(b < 1.15 * a for a, b in itertools.pairwise(sigmas))


def test_blurred_frames_wrong_frames_and_empty_ones_are_passed_over(
    recording: list[Observation], default_board: Board, rng: np.random.Generator
) -> None:
    spoilt = list(recording)
    for i in range(100, 150, 5):
        spoilt[i] = replace(recording[i], sharpness=0.1)
    for i in range(101, 150, 5):
        moved = recording[i].corners + rng.normal(0, 5, recording[i].corners.shape)
        spoilt[i] = replace(recording[i], corners=moved)
    for i in range(102, 150, 5):
        spoilt[i] = Observation.nothing((1280, 720))
    chosen = select_views(default_board, spoilt, limit=20)
    assert chosen and all(not (100 <= i < 150 and i % 5 in (0, 1, 2)) for i in chosen)
    found = calibrate(default_board, [spoilt[i] for i in chosen])
    assert found.rms_px < 0.6 and abs(found.camera.fx - 1068) < 4 * found.sigma[0]


def test_a_view_is_not_taken_twice(recording: list[Observation], default_board: Board) -> None:
    still = recording[:100]
    assert len(select_views(default_board, still, limit=40)) <= 2
    assert select_views(default_board, [still[0]] * 5, limit=40) == [0]


def test_nothing_comes_of_nothing(default_board: Board) -> None:
    assert select_views(default_board, []) == []
    assert select_views(default_board, [Observation.nothing((1280, 720))] * 3) == []
