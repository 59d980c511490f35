"""The figure who holds the board: its bones keep their lengths, its hands are at the board."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Pose
from venus3d.render.framing import content_of
from venus3d.render.shapes import LineShape, MeshShape
from venus3d.render.surroundings import FLOOR, figure, surroundings

UPPER_ARM, FOREARM = 0.28, 0.27


def ends_of(shape: MeshShape, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Where a limb begins and ends, camera frame, by scipy's turn of (0, 0, length)."""
    w, *xyz = shape.pose.wxyz
    along = Rotation.from_quat([*xyz, w]).apply([0.0, 0.0, length])
    return shape.pose.t, shape.pose.t + along


def test_arms_reach_from_the_shoulders_to_the_boards_edges(default_board: Board) -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        vector = rng.uniform([-60, -60, -180, -0.3, -0.2, 0.2], [60, 60, 180, 0.3, 0.2, 1.0])
        pose = Pose.from_vector(vector)
        parts = {s.name: s for s in figure(default_board, pose, True) if isinstance(s, MeshShape)}
        hands = {}
        for side in ("left", "right"):
            shoulder, elbow = ends_of(parts[f"/figure/{side}_upper_arm"], UPPER_ARM)
            start, hands[side] = ends_of(parts[f"/figure/{side}_forearm"], FOREARM)
            np.testing.assert_allclose(start, elbow, atol=1e-9)
            assert elbow[1] > min(shoulder[1], hands[side][1]), "elbows hang"
        assert hands["left"][0] > hands["right"][0], "the holder faces the camera"
        w, h = default_board.width / 2, default_board.height / 2
        edges = pose.apply([[w, 0, 0], [-w, 0, 0], [0, h, 0], [0, -h, 0]])
        for hand in hands.values():
            assert np.linalg.norm(edges - hand, axis=1).min() < 0.03


def test_only_poses_change_while_the_board_moves(default_board: Board) -> None:
    """Whatever is a new mesh is sent again, 30 times a second."""
    one = figure(default_board, Pose.from_vector([0, 0, 0, 0, 0, 0.5]), True)
    two = figure(default_board, Pose.from_vector([20, 9, 80, 0.1, 0, 0.6]), True)
    for a, b in zip(one, two, strict=True):
        assert isinstance(a, MeshShape) and isinstance(b, MeshShape)
        assert a.mesh is b.mesh and a.pose is not b.pose


@pytest.mark.parametrize("y", [-0.3, 0.0, 0.2, 0.6])
def test_a_drop_line_ends_on_the_floor_below_the_board(default_board: Board, y: float) -> None:
    pose = Pose.from_vector([10, 20, 30, 0.1, y, 0.6])
    shapes = surroundings(default_board, pose, None, True)
    (line,) = (s for s in shapes if isinstance(s, LineShape))
    points = line.pose.apply(line.segments.reshape(-1, 3))
    assert points[:, 1].max() == pytest.approx(max(y, FLOOR))
    assert points[:, 1].min() == pytest.approx(min(y, points[:, 1].max()), abs=0.006)
    np.testing.assert_allclose(points[-2:, [0, 2]], [[0.1, 0.6]] * 2, atol=1e-9)


def test_they_are_in_no_picture_and_frame_nothing(default_board: Board) -> None:
    pose = Pose.from_vector([0, 0, 0, 0, 0, 0.5])
    shapes = surroundings(default_board, pose, pose, False)
    assert not any(shape.in_projection for shape in shapes)
    assert len(content_of(shapes).points) == 0
