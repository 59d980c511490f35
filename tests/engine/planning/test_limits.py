"""Which poses may be asked for; OpenCV's projection and plain geometry are the oracles."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits, refusals
from venus3d.engine.planning.pose_space import Space, random_pose


def test_accepted_poses_keep_every_limit_by_opencvs_projection(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    limits = Limits()
    space = Space(default_board, paper_camera, limits)
    low = limits.margin * paper_camera.width - 0.5
    edge = np.linspace(0, 1, 21)[:, None]
    outline = default_board.outline
    # The whole border of the board, not only its corners.
    border = np.concatenate(
        [a + edge * (np.roll(outline, -1, 0)[i] - a) for i, a in enumerate(outline)]
    )
    for _ in range(40):
        pose = Pose.from_vector(random_pose(space, rng))
        pixels, _ = cv2.projectPoints(
            border, pose.rvec, pose.t, paper_camera.K, paper_camera.distortion
        )
        pixels = pixels.reshape(-1, 2)
        assert pixels.min() > low - 0.5
        assert (pixels.max(0) < np.array(paper_camera.image_size) - 1 - low + 0.5).all()
        distance = np.linalg.norm(pose.apply(outline), axis=1)
        assert distance.min() >= 0.2 and distance.max() <= 1.2
        assert distance.max() / distance.min() <= 2.2
        line = pose.t / np.linalg.norm(pose.t)
        assert np.degrees(np.arccos(pose.R[:, 2] @ line)) <= 55 + 1e-6
        assert np.abs(pose.vector()[:3]).max() <= 70 + 1e-6


@pytest.mark.parametrize(
    ("vector", "words"),
    [
        ([0, 0, 80, 0, 0, 0.5], "about Z is 80°"),
        ([60, 0, 0, 0, 0, 0.6], "tilted by 60°"),
        ([0, 0, 0, 0, 0, 0.1], "leaves the picture"),
        ([0, 0, 0, 0, 0, 1.3], "1200 mm is the farthest"),
        ([0, 0, 0, 0.3, 0, 0.5], "leaves the picture on the right"),
        ([0, 0, 0, 0, 0, -0.5], "behind the lens"),
        ([50, 0, 0, 0, 0, 0.21], "leaves the picture"),
    ],
)
def test_a_refusal_names_the_limit_and_agrees_with_accepts(
    vector: list[float], words: str, paper_camera: Camera, default_board: Board
) -> None:
    import re

    limits = Limits()
    said = refusals(limits, paper_camera, default_board, vector)[0].text
    assert re.search(words, said), said
    assert said.count(".") - len(re.findall(r"\d\.\d", said)) == 1, "one sentence"
    assert not limits.accepts(paper_camera, default_board, [vector])[0]


def test_accepts_and_refusal_agree_on_anything(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    limits = Limits()
    wild = np.column_stack(
        [
            rng.uniform(-90, 90, (300, 3)),
            rng.uniform(-0.3, 0.3, (300, 2)),
            rng.uniform(-0.2, 1.4, 300),
        ]
    )
    likely = Space(default_board, paper_camera, limits).from_unit(rng.random((300, 6)))
    # An angle beyond +-90 degrees about Y has another vector for the same pose.
    vectors = np.array([Pose.from_vector(v).vector() for v in np.concatenate([wild, likely])])
    good = limits.accepts(paper_camera, default_board, vectors)
    said = [not refusals(limits, paper_camera, default_board, v) for v in vectors]
    np.testing.assert_array_equal(good, said)
    assert 5 < good.sum() < 300


def test_small_squares_are_refused(paper_camera: Camera) -> None:
    board = Board(columns=12, rows=9, square=0.012, marker=0.009)
    (refusal,) = refusals(Limits(), paper_camera, board, [0, 0, 0, 0, 0, 1.19])
    assert refusal.kind == "small" and "square is 11 px" in refusal.text


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("charuco", "smallest square is 11 px wide in the picture; its marker is read from 12 px"),
        ("chessboard", "smallest square is 11 px wide in the picture; the board is read from 12"),
        ("circles", "smallest circle is 5 px wide in the picture; the board is read from 6 px"),
    ],
)
def test_a_refusal_says_what_is_small_on_each_kind(
    kind: str, words: str, paper_camera: Camera
) -> None:
    """Boards without markers were told of theirs."""
    board = Board(12, 9, 0.012, 0.006, kind=kind)
    said = refusals(Limits(), paper_camera, board, [0, 0, 0, 0, 0, 1.19])
    assert [words in one.text for one in said if one.kind == "small"] == [True]


def test_a_point_beyond_the_models_fold_is_not_taken_for_visible(default_board: Board) -> None:
    folding = Camera(1280, 720, 900, 900, 640, 360, k1=-0.6)
    pose = Pose.from_vector([0, 0, 0, 1.2, 0, 0.4])  # r = 3, which folds back into the image
    assert refusals(Limits(), folding, default_board, pose.vector())[0].kind == "behind"
    assert not Limits().accepts(folding, default_board, pose.vector()[None])[0]


@pytest.mark.parametrize("scale", [0.02, 0.1, 0.5, 1.0, 3.0, 20.0])
def test_any_size_of_board_has_poses(
    scale: float, paper_camera: Camera, rng: np.random.Generator
) -> None:
    board = Board(square=0.028 * scale, marker=0.021 * scale)
    limits = Limits.for_board(board, paper_camera)
    assert random_pose(Space(board, paper_camera, limits), rng).shape == (6,)
    if scale == 1.0:
        assert limits == Limits(min_square_px=2.4 * 7 * 28 / 21)
