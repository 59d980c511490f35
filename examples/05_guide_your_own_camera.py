"""A guided calibration in your own camera loop: an OpenCV window and venus3d side by side.

python examples/05_guide_your_own_camera.py [VIEWS] [--no-window]
"""

import re
import sys

import cv2

import venus3d


def main(views: str = "8", option: str = "") -> None:
    board = venus3d.Board()
    # Your own camera: cv2.VideoCapture(0), and its read(); then leave out `follow`.
    camera = venus3d.Simulation(board=board, fps=5, speed=2.5)
    detector, viewer = venus3d.Detector(board), venus3d.Viewer()
    session = venus3d.Session(board, camera.image_size, venus3d.Settings(max_views=int(views)))
    # OpenCV's headless builds have no windows.
    window = option != "--no-window" and not re.search("GUI: +NONE", cv2.getBuildInformation())
    print(f"Open {viewer.url}", flush=True)

    while session.phase not in ("converged", "finished") and (frame := camera.read()) is not None:
        observation = detector.detect(frame.image)
        session.observe(observation)
        snapshot = session.run_pending()  # after a capture: calibrates, searches the next target
        viewer.show_picture(frame.image, observation)
        viewer.show(snapshot)
        camera.follow(snapshot.target, snapshot.pose)
        if window:
            text, green = snapshot.instruction.holder, (0, 200, 0)
            cv2.imshow("camera", cv2.putText(frame.image, text, (20, 40), 0, 0.8, green, 2))
            if cv2.waitKey(1) == 27:  # Esc
                session.finish()

    found = session.snapshot()
    print(f"{found.phase} after {len(found.views)} views: fx {found.camera.fx:.1f} px")
    viewer.close()
    camera.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
