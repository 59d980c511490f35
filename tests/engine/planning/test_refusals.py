"""All broken limits of a pose, with the corner that breaks them; OpenCV projects, plain geometry
measures."""

from __future__ import annotations

import re

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits, refusals

NAMES = ("top left", "top right", "bottom right", "bottom left")


def test_the_corner_that_leaves_is_the_one_that_opencv_puts_outside(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    limits = Limits()
    told = 0
    for _ in range(200):
        vector = [*rng.uniform(-35, 35, 3), *rng.uniform([-0.3, -0.2, 0.35], [0.3, 0.2, 0.6])]
        pose = Pose.from_vector(vector)
        pixels, _ = cv2.projectPoints(
            default_board.outline, pose.rvec, pose.t, paper_camera.K, paper_camera.distortion
        )
        x, y = pixels.reshape(-1, 2).T
        past = {"left": -0.5 - x, "right": x - 1279.5, "top": -0.5 - y, "bottom": y - 719.5}
        for refusal in refusals(limits, paper_camera, default_board, vector):
            said = re.match(
                r"The (.*) corner leaves the picture (?:on|at) the (\w+) by (\d+) px",
                refusal.text,
            )
            if said is None:
                continue
            told += 1
            name, side, px = said.groups()
            assert NAMES[int(np.argmax(past[side]))] == name
            assert abs(past[side].max() - float(px)) <= 0.6
            assert {int(i) for i in np.flatnonzero(past[side] > 0)} <= set(refusal.corners)
    assert told > 60


@pytest.mark.parametrize(
    ("vector", "kinds", "words"),
    [
        ([0, 0, 20, 0, 0, 0.5], (), ""),
        ([0, 0, 80, 0, 0, 0.5], ("angle",), "turn about Z is 80°"),
        ([60, 0, 0, 0, 0, 0.6], ("tilt",), "tilted by 60°"),
        ([0, 0, 0, 0, 0, 0.12], ("outside", "near"), "picture"),
        ([0, 0, 0, 0, 0, 1.5], ("far", "small"), "too far away: 15"),
        ([0, 0, 0, 0.3, 0, 0.5], ("outside",), "on the right by"),
        ([-90, -90, -180, -0.3, -0.2, 0.15], ("outside",), "on the left by more than 1280 px"),
        ([0, 0, 0, 0, 0, -0.5], ("behind", "tilt"), "beside or behind"),
        ([0, 0, 180, 0, 0, 0.5], ("angle",), "about Z is 180°"),
    ],
)
def test_each_limit_is_told(
    vector: list[float],
    kinds: tuple[str, ...],
    words: str,
    paper_camera: Camera,
    default_board: Board,
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    found = refusals(limits, paper_camera, default_board, vector)
    assert set(kinds) <= {refusal.kind for refusal in found}
    assert words in " ".join(refusal.text for refusal in found)
    assert all(refusal.text.endswith(".") for refusal in found)


def test_refused_exactly_if_not_accepted_and_the_worst_comes_first(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    vectors = np.column_stack(
        [rng.uniform(-80, 80, (400, 3)), rng.uniform([-0.2, -0.1, 0.1], [0.2, 0.1, 1.3], (400, 3))]
    )
    vectors[::2, :5] *= 0.3
    accepted = limits.accepts(paper_camera, default_board, vectors)
    assert 20 < accepted.sum() < 380
    for vector, good in zip(vectors, accepted, strict=True):
        found = refusals(limits, paper_camera, default_board, vector)
        assert good == (not found), [refusal.text for refusal in found]
        excess = [refusal.excess for refusal in found]
        assert excess == sorted(excess, reverse=True) and min(excess, default=1) > 0
