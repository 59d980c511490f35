"""How long it takes to follow a board of each kind from frame to frame: `make speed`.

Frames of 1280 x 720, each board at 0.5 m under 25 degrees, a little moved from one to the next,
with noise and blur. One thread's processor time; the kinds in turn, so that a busy machine slows
down all alike: "by charuco" is what can be compared between machines. "At best" is the tenth part
of the frames that took least. A benchmark, no test: it prints figures and fails at nothing.

    python scripts/detection_speed.py [--rounds 60]
"""

from __future__ import annotations

import argparse
import time

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame

_BOARDS = (
    Board(),
    Board(10, 7, kind="chessboard"),
    Board(kind="circles"),
    Board(4, 11, 0.02, 0.016, kind="asymmetric-circles"),
    Board(6, 5, 0.028, 0.0215, "DICT_APRILTAG_36H11", kind="aprilgrid"),
    Board(6, 4, 0.035, 0.0265, kind="aruco-grid"),
)
_SQUARE_PX = 80
_BLUR_PX, _NOISE = 0.6, 2.0
_FRAMES = 8
_WARM = 6
"""Frames until a board's layout is settled and the search is quick."""


def picture_of(board: Board, pose: Pose, rng: np.random.Generator) -> NDArray[np.uint8]:
    """(H, W) grey, by a camera without distortion, on a white sheet before a grey wall."""
    scale = _SQUARE_PX / board.square
    sheet = np.pad(board.texture(_SQUARE_PX), _SQUARE_PX, constant_values=255)
    origin = np.array([board.width, board.height]) / 2 + board.square
    metres = np.array(
        [
            [1 / scale, 0, 0.5 / scale - origin[0]],
            [0, 1 / scale, 0.5 / scale - origin[1]],
            [0, 0, 1],
        ]
    )
    H = PAPER_CAMERA.K @ np.column_stack([pose.R[:, :2], pose.t]) @ metres
    size = PAPER_CAMERA.image_size
    seen = cv2.warpPerspective(sheet, H, size, flags=cv2.INTER_AREA, borderValue=128)
    noisy = cv2.GaussianBlur(seen, (0, 0), _BLUR_PX) + rng.normal(0, _NOISE, seen.shape)
    return np.clip(np.rint(25 + 0.8 * noisy), 0, 255).astype(np.uint8)


def frames_of(board: Board) -> list[Frame]:
    """A board that moves by a pixel or two."""
    rng = np.random.default_rng(0)
    poses = [Pose.from_vector([25, 0, 0, 0.001 * n, 0, 0.5]) for n in range(_FRAMES)]
    return [Frame(picture_of(board, pose, rng), n / 30, str(n)) for n, pose in enumerate(poses)]


def main() -> None:
    parser = argparse.ArgumentParser(description="Milliseconds to follow a board")
    parser.add_argument("--rounds", type=int, default=60)
    rounds: int = parser.parse_args().rounds
    cv2.setNumThreads(1)
    trackers = [BoardTracker(Detector(board)) for board in _BOARDS]
    frames = [frames_of(board) for board in _BOARDS]
    times = np.zeros((rounds, len(_BOARDS)))
    first, counts = np.zeros(len(_BOARDS)), np.zeros(len(_BOARDS), dtype=int)
    for n in range(-_WARM, rounds):
        for kind, (tracker, shown) in enumerate(zip(trackers, frames, strict=True)):
            began = time.thread_time()
            counts[kind] = tracker.track(shown[n % _FRAMES]).count
            took = 1000 * (time.thread_time() - began)
            if n < 0:
                first[kind] = first[kind] or took
            else:
                times[n, kind] = took
    followed, best = np.percentile(times, [50, 10], axis=0)
    ratios = np.median(times / times[:, :1], axis=0)
    print("kind                points   first frame   followed    at best   by charuco")
    for kind, board in enumerate(_BOARDS):
        seen = f"{counts[kind]}/{board.corner_count}"
        print(
            f"{board.kind:18s} {seen:>7s}  {first[kind]:9.1f} ms  {followed[kind]:6.1f} ms"
            f"  {best[kind]:6.1f} ms  {ratios[kind]:10.2f}"
        )


if __name__ == "__main__":
    main()
