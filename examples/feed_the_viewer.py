"""Another program feeds the viewer: it makes the snapshots, venus3d only shows them.

    python examples/feed_the_viewer.py [SECONDS]

A board swings in front of a camera; the page shows it, the target and the steps that are left.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.render.offscreen import Offscreen
from venus3d.scene.render.projections import Projections


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    camera, board = Camera(1280, 720, 1068, 1073, 635, 355), Board()
    session = Session(board, camera.image_size)
    offscreen = Offscreen()
    viewer = Viewer(projections=Projections(offscreen))
    print(viewer.url, *viewer.notes, flush=True)
    start = time.monotonic()
    try:
        while (now := time.monotonic() - start) < seconds:
            pose = Pose.from_vector([30 * np.sin(now), 20 * np.sin(0.7 * now), 0, 0, 0, 0.5])
            corners = camera.project(pose.apply(board.corners))
            seen = Observation(np.arange(board.corner_count), corners, camera.image_size)
            snapshot = session.observe(seen)
            if session.pending is not None:
                snapshot = session.apply(session.pending.run())
            viewer.show(snapshot)
            viewer.show_picture(np.full((720, 1280, 3), 90, np.uint8), seen)
            for intent in viewer.drain_intents():
                viewer.say(f"You asked for: {type(intent).__name__}")
            time.sleep(1 / 25)
    finally:
        viewer.close()
        offscreen.close()


if __name__ == "__main__":
    main()
