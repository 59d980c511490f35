"""Show your own calibration live: your program finds the pose, venus3d shows it.

python examples/04_show_your_calibration.py [SECONDS]
"""

import sys
import time

import numpy as np

import venus3d


def main(seconds: str = "60") -> None:
    # Of your own calibration: an OpenCV camera matrix, distortion coefficients, the image's size.
    K = np.array([[1068.0, 0, 635], [0, 1073, 355], [0, 0, 1]])
    camera = venus3d.Camera.from_opencv(K, np.zeros(5), (1280, 720))
    board = venus3d.Board()
    target = venus3d.Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])

    viewer = venus3d.Viewer(step_pictures=True)
    print(f"Open {viewer.url}", flush=True)
    start = time.monotonic()
    while (now := time.monotonic() - start) < float(seconds):
        # A pose as cv2.solvePnP gives it; here the board swings.
        rvec = np.radians([30 * np.sin(now), 20 * np.sin(0.7 * now), 0])
        pose = venus3d.Pose.from_rvec_tvec(rvec, [0, 0, 0.5])
        viewer.show_pose(board, camera, pose, target)
        time.sleep(1 / 25)
    viewer.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
