"""The engine without a screen: from three views to the pose that would help most."""

from __future__ import annotations

import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.suggest import suggest


def observed(camera: Camera, board: Board, pose: Pose, rng: np.random.Generator) -> Observation:
    """The corners that a camera with a little noise would find."""
    corners = camera.project(pose.apply(board.corners))
    noisy = corners + rng.normal(0, 0.3, corners.shape)
    return Observation(np.arange(board.corner_count), noisy, camera.image_size)


def main() -> None:
    rng = np.random.default_rng(0)
    truth = Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
    board = Board()
    poses = ([45, 0, 0, 0, 0, 0.5], [0, 35, 0, 0.05, 0, 0.45], [-20, -25, 10, -0.05, 0.02, 0.4])
    views = [observed(truth, board, Pose.from_vector(p), rng) for p in poses]

    for _ in range(3):
        known = calibrate(board, views)
        print(f"{len(views)} views: fx {known.camera.fx:.1f} ± {known.sigma[0]:.1f} px")
        print(f"  projection uncertainty {known.uncertainty_px:.2f} px")
        target = suggest(known)
        print(f"  next {np.round(target.pose.vector(), 2).tolist()}: {target.reason}")
        print(f"  projection uncertainty after it {target.predicted_uncertainty_px:.2f} px")
        views.append(observed(truth, board, target.pose, rng))


if __name__ == "__main__":
    main()
