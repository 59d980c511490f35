"""Where to hold the board next: the pose that would tell most about the camera, and why."""

import numpy as np

import venus3d


def main() -> None:
    board = venus3d.Board()
    truth = venus3d.Camera(1280, 720, 1068, 1073, 635, 355, k1=-0.0031, k2=-0.2059, k3=0.2478)
    rng = np.random.default_rng(0)

    def take_view(pose: venus3d.Pose) -> venus3d.Observation:
        """The corners that a real camera would find; with one, use `Detector.detect`."""
        corners = truth.project(pose.apply(board.corners))
        noisy = corners + rng.normal(0, 0.3, corners.shape)
        return venus3d.Observation(np.arange(board.corner_count), noisy, truth.image_size)

    # Any views to begin with; angles in degrees, the board's centre in metres.
    begin = ([45, 0, 0, 0, 0, 0.5], [0, 35, 0, 0.05, 0, 0.45], [-20, -25, 10, -0.05, 0.02, 0.4])
    views = [take_view(venus3d.Pose.from_vector(vector)) for vector in begin]
    for _ in range(3):
        calibration = venus3d.calibrate(views, board)
        fx, sigma = calibration.camera.fx, calibration.sigma[0]
        print(f"{len(views)} views: fx {fx:.1f} ± {sigma:.1f} px")
        print(f"  uncertainty {calibration.uncertainty_px:.2f} px")

        target = venus3d.suggest(calibration)
        print(f"  next {np.round(target.pose.vector(), 2).tolist()}: {target.reason}")
        print(f"  uncertainty expected after it {target.predicted_uncertainty_px:.2f} px")
        views.append(take_view(target.pose))


if __name__ == "__main__":
    main()
