"""A whole guided session on an RTSP camera, by the real program, with its report.

The camera is cut off three times and stalls once, and the program is killed by SIGKILL once and
resumed. The camera's pictures are those of the simulated camera, as H.264 over GStreamer's RTSP
server; the simulated hand is told the target that the program's page shows. Prints what happened,
and ends with 1 unless the calibration converged with every view that had been reported.

    python -m tests.sources.soak.session [FOLDER]     keeps the session and its report there
"""

from __future__ import annotations

import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.ports import free_port
from tests.sources.soak.rtsp_camera import RtspCamera, has_rtsp, rtsp_camera
from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.sources.sim import Simulation

_SIZE, _RATE = (960, 540), 12
_PATIENCE_S = 600.0
_CUTS_S = {1: 3.0, 2: 6.0, 3: 12.0}
"""After so many views the camera is cut off for so many seconds."""
_STALL_AFTER, _STALL_S = 5, 10.0
_KILL_AFTER = 4
_REPORTED = re.compile(r"View (\d+) is kept")


class Program:
    """`venus3d guide`, and what its page shows."""

    def __init__(self, folder: Path) -> None:
        self.folder, self._told, self._log = folder, folder.with_suffix(".told"), None
        self.log = folder.with_suffix(".log")
        self._port = free_port()

    def start(self, *arguments: str) -> None:
        self._told.unlink(missing_ok=True)
        command = [sys.executable, "-m", "tests.sources.soak.told", "guide", *arguments]
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                [*command, "--port", str(self._port), "--no-tour"],
                stdout=log,
                stderr=subprocess.STDOUT,
                env={**os.environ, "TOLD": str(self._told)},
            )

    @property
    def shown(self) -> dict[str, Any]:
        """Empty until there is something."""
        try:
            return pickle.loads(self._told.read_bytes())
        except FileNotFoundError:
            return {}

    @property
    def reported(self) -> set[int]:
        return {int(number) for number in _REPORTED.findall(self.log.read_text())}


def _spoil(camera: RtspCamera, views: int) -> None:
    """Cut the camera off, or let it stall, once there are so many views."""
    if views in _CUTS_S:
        camera.kill()
        time.sleep(_CUTS_S[views])
        camera.start()
    elif views == _STALL_AFTER:
        camera.stall()
        time.sleep(_STALL_S)
        camera.go_on()


def guided(folder: Path) -> tuple[dict[str, Any], set[int]]:
    """What the page shows at the end, and the numbers of the views that were reported."""
    hand = Simulation(PAPER_CAMERA.scaled(_SIZE), Board(), realtime=True, fps=_RATE, speed=1.5)

    def picture() -> NDArray[np.uint8]:
        frame = hand.read()
        assert frame is not None
        return frame.image

    program, began_s, views, killed = Program(folder), time.monotonic(), 0, False
    with rtsp_camera(picture, _SIZE, _RATE) as camera:
        time.sleep(1.5)
        program.start(camera.address, "--output", str(folder))
        shown: dict[str, Any] = {}
        while shown.get("phase") not in ("converged", "finished"):
            time.sleep(0.05)
            if program.process.poll() is not None or time.monotonic() - began_s > _PATIENCE_S:
                break
            shown = program.shown or shown
            if not shown:
                continue
            hand.follow(shown["target"], shown["pose"], begins=not shown["captured"])
            if len(shown["captured"]) > views:
                views = len(shown["captured"])
                print(f"{time.monotonic() - began_s:4.0f} s: view {views}", flush=True)
                threading.Thread(target=_spoil, args=(camera, views), daemon=True).start()
            if views == _KILL_AFTER and not killed:
                killed = True
                program.process.kill()
                program.process.wait()
                print("        killed, resumed", flush=True)
                program.start("--resume", str(folder))
        program.process.send_signal(signal.SIGINT)
        program.process.wait(60)
    hand.close()
    print(f"{time.monotonic() - began_s:4.0f} s: {shown.get('phase', 'nothing')}")
    return shown, program.reported


def main() -> int:
    if not has_rtsp():
        print("Not run: python3-gi with gir1.2-gst-rtsp-server-1.0 is missing")
        return 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(sys.argv[1] if sys.argv[1:] else scratch) / "session"
        folder.parent.mkdir(parents=True, exist_ok=True)
        shown, reported = guided(folder)
        trouble = [line for line in folder.with_suffix(".log").read_text().splitlines() if line]
        print(
            *(f"    {line}" for line in trouble if "picture" in line or "again" in line), sep="\n"
        )
        report = [sys.executable, "-m", "venus3d", "report", str(folder)]
        made = subprocess.run(report, capture_output=True, text=True)
        print(made.stdout + made.stderr, end="")
        lost = reported - set(shown.get("captured", ()))
        if shown:
            truth = PAPER_CAMERA.scaled(_SIZE)
            print(
                f"{len(reported)} views reported, lost: {sorted(lost) or 'none'}; rms "
                f"{shown['rms_px']:.3f} px, off the true camera by "
                f"{projection_diff_px(truth, shown['camera']):.3f} px"
            )
        good = shown.get("phase") == "converged" and not lost and made.returncode == 0
        return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
