"""A whole guided session on a network camera that is cut off three times and stalls once.

The simulated camera's pictures go over HTTP as MJPEG; the simulated hand is told the target by what
a second monitor is shown. Prints what happened and ends with 1 unless the calibration converged.
"""

from __future__ import annotations

import sys
import threading
import time

import numpy as np
from numpy.typing import NDArray

from tests.ports import free_port
from tests.sources.network_camera import NetworkCamera, network_camera
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.guidance.work import Settings
from venus3d.render.annotated_picture import LivePicture
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.live import Live
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.sim import Simulation
from venus3d.sources.source_news import tell_of_trouble

_PATIENCE_S = 400.0


class Holder:
    """The simulated hand, which sees what a second monitor shows; it cuts the camera off."""

    def __init__(self, hand: Simulation, camera: NetworkCamera) -> None:
        self._hand, self._camera, self._cuts = hand, camera, 0

    def show(self, snapshot: Snapshot) -> None:
        taken = snapshot.captured or ()
        self._hand.follow(snapshot.target, snapshot.pose, begins=not taken)
        if self._cuts < 4 and len(taken) > self._cuts:
            self._cuts += 1
            threading.Thread(target=self._cut, args=(self._cuts,), daemon=True).start()

    def _cut(self, number: int) -> None:
        if number == 4:
            self._camera.stalled = True
            time.sleep(7)
            self._camera.stalled = False
            return
        self._camera.unplug()
        time.sleep(2.0 * number)
        self._camera.plug_in()

    def show_picture(self, image: LivePicture, observation: Observation | None = None) -> None: ...

    def pause(self, on: bool) -> None: ...

    def no_pictures(self, since: str) -> None: ...


def main() -> int:
    hand = Simulation(PAPER_CAMERA, Board(), realtime=True, fps=15.0, speed=1.5)
    lock = threading.Lock()

    def picture(number: int) -> NDArray[np.uint8]:
        with lock:
            frame = hand.read()
        assert frame is not None
        return frame.image

    with network_camera(picture, rate=1000) as camera:
        source = open_frame_source(camera.address)
        assert isinstance(source, Live)
        tell_of_trouble(source, lambda text: print(text, flush=True))
        viewer = Viewer(port=free_port())
        session = Session(Board(), source.image_size, Settings())
        tracker = BoardTracker(Detector(Board(), find_layout=False))
        live = LiveGuide(
            session,
            source,
            tracker,
            viewer,
            lambda _: None,
            lambda: source,
            (Holder(hand, camera),),
        )
        began_s = time.monotonic()
        running = threading.Thread(target=live.run, daemon=True)
        running.start()
        while session.phase not in ("converged", "finished") and running.is_alive():
            if time.monotonic() - began_s > _PATIENCE_S:
                break
            time.sleep(0.1)
        live.stop()
        running.join(20)
        viewer.close()
    end = session.snapshot()
    print(
        f"{end.phase} after {time.monotonic() - began_s:.0f} s with {len(end.views)} views, "
        f"{camera.connections} connections; off the true camera by "
        f"{projection_diff_px(PAPER_CAMERA, end.camera):.3f} px, rms "
        f"{end.calibration.rms_px if end.calibration else float('nan'):.3f} px"
    )
    hand.close()
    return 0 if end.phase == "converged" and not running.is_alive() else 1


if __name__ == "__main__":
    sys.exit(main())
