"""The bundle adjustment beside `cv2.calibrateCamera`, on the same corners: `make speed`.

Both from the closed form to the optimum, alternating, so that a busy machine slows down both alike.
"All of it" is `venus3d.calibrate`: several starts, outliers, the board's shape and the covariance
with shared errors. A benchmark, no test: it prints figures and fails at nothing.

    python scripts/adjustment_speed.py [--rounds 40]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.bundle import Corners, Problem, adjust
from venus3d.engine.calibration.initial_values import initial_parameters
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Pose

_NOISE_PX = 0.1
_CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-12)


def views_of(board: Board, count: int) -> list[Observation]:
    """Random views of the whole board by the paper's camera."""
    rng = np.random.default_rng(count)
    found: list[Observation] = []
    while len(found) < count:
        turns, place = rng.uniform(-40, 40, 3), rng.uniform([-0.1, -0.1, 0.4], [0.1, 0.1, 0.7])
        pixels = PAPER_CAMERA.project(Pose.from_vector([*turns, *place]).apply(board.corners))
        if (pixels >= 0).all() and (pixels < PAPER_CAMERA.image_size).all():
            noisy = pixels + rng.normal(0, _NOISE_PX, pixels.shape)
            found.append(Observation(np.arange(len(pixels)), noisy, PAPER_CAMERA.image_size))
    return found


def milliseconds(parts: list[Callable[[], Any]], rounds: int) -> list[float]:
    """The median time of each part, run in turn."""
    times: list[list[float]] = [[] for _ in parts]
    for _ in range(rounds):
        for part, taken in zip(parts, times, strict=True):
            start = time.perf_counter()
            part()
            taken.append(time.perf_counter() - start)
    return [1000 * float(np.median(taken)) for taken in times]


def main() -> None:
    parser = argparse.ArgumentParser(description="Bundle adjustment beside OpenCV")
    parser.add_argument("--rounds", type=int, default=40)
    rounds: int = parser.parse_args().rounds
    board, size = Board(), PAPER_CAMERA.image_size
    print("views  OpenCV      ours   ratio   all of it")
    for count in (4, 12, 40):
        views = views_of(board, count)
        objects = [board.corners.astype(np.float32).reshape(-1, 1, 3)] * count
        images = [v.corners.astype(np.float32).reshape(-1, 1, 2) for v in views]

        def opencv(objects: Any = objects, images: Any = images) -> None:
            K, distortion = np.eye(3), np.zeros(5)
            cv2.calibrateCamera(objects, images, size, K, distortion, criteria=_CRITERIA)

        def ours(views: list[Observation] = views) -> None:
            corners = Corners.of([board.corners] * len(views), [v.corners for v in views])
            adjust(Problem(corners, np.eye(9)), next(initial_parameters(corners, size)))

        def whole(views: list[Observation] = views) -> None:
            calibrate(board, views)

        theirs, own, every = milliseconds([opencv, ours, whole], rounds)
        print(f"{count:5d}  {theirs:5.1f} ms  {own:5.1f} ms  {own / theirs:5.2f}  {every:7.1f} ms")


if __name__ == "__main__":
    main()
