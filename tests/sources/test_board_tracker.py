"""The detector with its memory: it may be quicker than a full search, not worse."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from tests.engine.board_pictures import picture_of
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame


class Watched(Detector):
    """A detector that tells how it was asked to search."""

    def __init__(self, board: Board) -> None:
        super().__init__(board, find_layout=False)
        self.looks: list[str] = []
        self.blind = 0
        """How many corners the next quick search overlooks."""

    def detect(self, image: Any, **how: Any) -> Any:  # type: ignore[override]
        near = "near" if how["region"] else "everywhere"
        self.looks.append(f"{'quick' if how['quick'] else 'full'} {near}")
        seen = super().detect(image, **how)
        if how["quick"] and self.blind:
            seen = replace(seen, ids=seen.ids[self.blind :], corners=seen.corners[self.blind :])
            self.blind = 0
        return seen


@pytest.fixture
def tracker(default_board: Board) -> tuple[BoardTracker, Watched]:
    detector = Watched(default_board)
    return BoardTracker(detector), detector


def frame(board: Board, camera: Camera, *vector: float) -> Frame:
    return Frame(picture_of(board, camera, Pose.from_vector(vector)), 0.0, "")


def test_a_tracked_board_gets_one_quick_search_near_its_last_place(
    tracker: tuple[BoardTracker, Watched], default_board: Board, paper_camera: Camera
) -> None:
    track, detector = tracker[0].track, tracker[1]
    for step in range(4):
        seen = track(frame(default_board, paper_camera, 20, -20, 5 * step, 0.01 * step, 0, 0.45))
        assert seen.count == 40
    assert detector.looks == ["full everywhere"] + ["quick near"] * 3


def test_what_a_quick_search_overlooks_a_full_one_finds(
    tracker: tuple[BoardTracker, Watched], default_board: Board, paper_camera: Camera
) -> None:
    """The board jumps back until its squares are too small, then comes near again."""
    track, detector = tracker[0].track, tracker[1]
    near, far = (0, 0, 0, 0, 0, 0.45), (30, 40, 0, 0.02, 0, 1.3)
    track(frame(default_board, paper_camera, *near))
    small = frame(default_board, paper_camera, *far)
    full = Detector(default_board, find_layout=False).detect(small.image)
    assert Detector(default_board, find_layout=False).detect(small.image, quick=True).count < 40
    seen = track(small)
    assert (seen.ids == full.ids).all()
    np.testing.assert_allclose(seen.corners, full.corners, atol=0.05)
    assert detector.looks[1:3] == ["quick near", "full everywhere"]
    track(small)
    assert detector.looks[-1] == "full near", "its squares are too small for a quick search"


def test_a_blurred_frame_is_looked_at_fully_and_forgotten(
    tracker: tuple[BoardTracker, Watched], default_board: Board, paper_camera: Camera
) -> None:
    """Motion blur hides most of the board from a quick search, and it passes."""
    track, detector = tracker[0].track, tracker[1]
    sharp = frame(default_board, paper_camera, 0, 0, 0, 0, 0, 0.4)
    blurred = replace(sharp, image=cv2.blur(sharp.image, (9, 1)))
    track(frame(default_board, paper_camera, 0, 0, 0, 0.03, 0, 0.4))  # too far off to be followed
    seen = track(blurred)
    assert seen.count == Detector(default_board, find_layout=False).detect(blurred.image).count
    assert 10 < seen.count < 40
    del detector.looks[:]
    for _ in range(3):
        assert track(sharp).count == 40
    assert detector.looks == ["quick near"] * 3


def test_what_was_overlooked_in_a_good_frame_is_a_lesson_for_a_second(
    tracker: tuple[BoardTracker, Watched], default_board: Board, paper_camera: Camera
) -> None:
    track, detector = tracker[0].track, tracker[1]
    picture = frame(default_board, paper_camera, 0, 0, 0, 0, 0, 0.4)
    track(picture)
    detector.blind = 1
    assert track(picture).count == 40
    assert detector.looks[1:] == ["quick near", "full near"]
    del detector.looks[:]
    for _ in range(40):
        track(picture)
    assert detector.looks[0] == "full near" and detector.looks[-1] == "quick near"
    assert detector.looks.count("full near") < 25


def test_a_board_that_leaves_its_region_is_found_again(
    tracker: tuple[BoardTracker, Watched], default_board: Board, paper_camera: Camera
) -> None:
    track, detector = tracker[0].track, tracker[1]
    track(frame(default_board, paper_camera, 0, 0, 0, -0.25, -0.1, 0.8))
    seen = track(frame(default_board, paper_camera, 0, 0, 0, 0.25, 0.1, 0.8))
    assert seen.count == 40
    assert detector.looks[-1] == "full everywhere"


def test_an_observation_carries_its_board_and_its_picture(
    default_board: Board, paper_camera: Camera
) -> None:
    """The detector believes the printed layout; nobody has to ask it which frame that was."""
    printed = replace(default_board, legacy=True)
    tracker = BoardTracker(Detector(default_board))
    picture = frame(printed, paper_camera, 20, -20, 0, 0, 0, 0.45)
    seen = tracker.track(picture)
    assert seen.image is picture.image and seen.board == printed
    assert [diagnosis.kind for diagnosis in seen.board_diagnoses] == ["wrong-layout"]
    assert seen.without_image().image is None and seen.without_image().board == printed
    nothing = tracker.track(Frame(np.full((720, 1280), 90, np.uint8), 1.0, ""))
    assert nothing.count == 0 and nothing.board == printed and nothing.image is not None
