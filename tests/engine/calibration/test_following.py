"""A board that is followed is seen as well as one that is searched anew."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.following import Follower
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame

Picture = NDArray[np.uint8]


@pytest.fixture
def answers(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether each picture was followed, or what a search found taken instead."""
    given: list[bool] = []

    def noting(name: str, followed: bool) -> None:
        call = getattr(Follower, name)

        def noted(self: Follower, *seen: Any) -> None:
            given.append(followed)
            call(self, *seen)

        monkeypatch.setattr(Follower, name, noted)

    noting("measured", True)
    noting("found", False)
    return given


def tracker_of(board: Board) -> BoardTracker:
    return BoardTracker(Detector(board, find_layout=False))


def tracked(tracker: BoardTracker, picture: Picture) -> Observation:
    return tracker.track(Frame(picture, 0.0, ""))


@pytest.mark.slow
def test_a_real_board_is_followed_without_loss(shared_data: Path, answers: list[bool]) -> None:
    """Each corner of a hand-held board is there, and where a search finds it."""
    board = Board(12, 8, 0.0180086, 0.0139954, "DICT_5X5_1000")
    video = cv2.VideoCapture(str(shared_data / "wpilib-charuco-12x8.mp4"))
    tracker, detector = tracker_of(board), Detector(board, find_layout=False)
    pairs: list[tuple[Observation, Observation]] = []
    for _ in range(60):
        picture = np.asarray(cv2.cvtColor(video.read()[1], cv2.COLOR_BGR2GRAY), np.uint8)
        del answers[:]
        seen = tracked(tracker, picture)
        if answers == [True]:
            pairs.append((seen, detector.detect(picture)))
    assert len(pairs) >= 40, "three of four"
    apart: list[float] = []
    for seen, found in pairs:
        np.testing.assert_array_equal(seen.ids, found.ids)
        apart += np.linalg.norm(seen.corners - found.corners, axis=1).tolist()
    assert np.percentile(apart, 99) < 0.01 and max(apart) < 0.3


def test_a_corner_that_a_hand_covers_is_not_made_up(
    default_board: Board, paper_camera: Camera, answers: list[bool]
) -> None:
    board, tracker = default_board, tracker_of(default_board)
    pose = Pose.from_vector([20, -20, 5, 0, 0, 0.42])
    truth = paper_camera.project(pose.apply(board.corners))
    bare = picture_of(board, paper_camera, pose, noise=2.0)
    skin = np.random.default_rng(0).normal(150, 25, (90, 24))
    hand = np.clip(cv2.resize(skin, (144, 540), interpolation=cv2.INTER_CUBIC), 0, 255)
    tracked(tracker, bare)
    followed = 0
    for step in range(24):
        left, top = 380 + 12 * step, 320
        picture = bare.copy()
        picture[top:, left : left + 144] = hand[: 720 - top]
        del answers[:]
        seen = tracked(tracker, picture)
        followed += answers == [True]
        x, y = (truth - [left, top]).T
        deep = set(np.flatnonzero((x > 8) & (x < 136) & (y > 8)))
        assert len(deep) >= 3 or step in (0, 1, 2)
        assert not deep & set(seen.ids.tolist())
        np.testing.assert_allclose(seen.corners, truth[seen.ids], atol=1.0)
    assert followed >= 3, "where the hand covers no other corner than before"


@pytest.mark.parametrize(
    "board",
    [
        Board(6, 5, 0.028, 0.0215, "DICT_APRILTAG_36H11", kind="aprilgrid"),
        Board(6, 4, 0.035, 0.0265, kind="aruco-grid"),
    ],
    ids=lambda board: board.kind,
)
def test_tags_are_followed_to_where_a_search_finds_them(
    board: Board, paper_camera: Camera, answers: list[bool]
) -> None:
    tracker, detector = tracker_of(board), Detector(board, find_layout=False)
    rng, followed = np.random.default_rng(0), 0
    for step in range(12):
        pose = Pose.from_vector([20, 10 + step, step, 0.002 * step, 0, 0.45])
        picture = picture_of(board, paper_camera, pose, blur_px=0.6, noise=2.0, rng=rng)
        del answers[:]
        seen = tracked(tracker, picture)
        if answers == [True]:
            followed += 1
            found = detector.detect(picture)
            np.testing.assert_array_equal(seen.ids, found.ids)
            np.testing.assert_allclose(seen.corners, found.corners, atol=0.15)
    assert followed >= 6


def test_a_board_that_jumps_by_two_squares_is_searched(
    default_board: Board, paper_camera: Camera, answers: list[bool]
) -> None:
    """There its corners look alike."""
    tracker = tracker_of(default_board)
    for shift in (0.0, 2 * default_board.square, 0.0, -2 * default_board.square):
        pose = Pose.from_vector([0, 0, 0, shift, 0, 0.45])
        seen = tracked(tracker, picture_of(default_board, paper_camera, pose))
        truth = paper_camera.project(pose.apply(default_board.corners))
        np.testing.assert_allclose(seen.corners, truth[seen.ids], atol=0.5)
    assert not any(answers)


def test_what_comes_into_view_is_seen_soon(default_board: Board, paper_camera: Camera) -> None:
    """Within four pictures; the search goes to where the rest of the board must be."""
    tracker = tracker_of(default_board)
    whole = picture_of(default_board, paper_camera, Pose.from_vector([0, 0, 0, 0, 0, 0.42]))
    partly = whole.copy()
    partly[:, 700:] = 150
    few = tracked(tracker, partly).count
    counts = [tracked(tracker, whole).count for _ in range(4)]
    assert 12 < few < 40 and counts[3] == 40


def test_a_picture_of_something_else_is_no_board(
    default_board: Board, paper_camera: Camera
) -> None:
    tracker = tracker_of(default_board)
    pose = Pose.from_vector([20, 0, 0, 0, 0, 0.45])
    assert tracked(tracker, picture_of(default_board, paper_camera, pose)).count == 40
    noise = np.random.default_rng(0).integers(0, 255, (720, 1280)).astype(np.uint8)
    assert tracked(tracker, noise).count == 0
