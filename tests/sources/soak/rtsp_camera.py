"""A network camera for the soaks: RTSP by GStreamer's server, that stalls, is killed and started
again when it is told to."""

from __future__ import annotations

import signal
import subprocess
import threading
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.ports import free_port

_SYSTEM_PYTHON = "/usr/bin/python3"
_SERVER = Path(__file__).with_name("rtsp_server.py")


class RtspCamera:
    """Sends pictures (H, W, 3) BGR of `size` to everybody who asks at `address`."""

    def __init__(
        self, picture: Callable[[], NDArray[np.uint8]], size: tuple[int, int], rate: int
    ) -> None:
        self._picture, self._size, self._rate = picture, size, rate
        self._port = free_port()
        self._closed = threading.Event()
        self.sent = 0
        self.start()
        self._feeder = threading.Thread(target=self._feed, daemon=True)
        self._feeder.start()

    @property
    def address(self) -> str:
        return f"rtsp://127.0.0.1:{self._port}/video"

    def start(self) -> None:
        """Start the server, again after `kill`."""
        numbers = map(str, (self._port, *self._size, self._rate))
        command = [_SYSTEM_PYTHON, str(_SERVER), *numbers]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE)

    def kill(self) -> None:
        """The server is gone, as with its power."""
        self._process.kill()
        self._process.wait()

    def stall(self) -> None:
        """The server goes on, and sends nothing."""
        self._process.send_signal(signal.SIGSTOP)

    def go_on(self) -> None:
        """After `stall`."""
        self._process.send_signal(signal.SIGCONT)

    def damage(self) -> None:
        """The server loses packets from now on, or no longer."""
        self._process.send_signal(signal.SIGUSR1)

    def close(self) -> None:
        """The end."""
        self._closed.set()
        self.kill()
        self._feeder.join(5)

    def _feed(self) -> None:
        due_s = time.monotonic()
        while not self._closed.is_set():
            content = np.ascontiguousarray(self._picture()).tobytes()
            pipe = self._process.stdin
            assert pipe is not None
            with suppress(OSError, ValueError):  # killed; it may be started again
                pipe.write(content)
                pipe.flush()
                self.sent += 1
            due_s = max(due_s + 1 / self._rate, time.monotonic() - 1.0)
            time.sleep(max(0.0, due_s - time.monotonic()))


@contextmanager
def rtsp_camera(
    picture: Callable[[], NDArray[np.uint8]], size: tuple[int, int], rate: int
) -> Generator[RtspCamera, None, None]:
    """One, for as long."""
    camera = RtspCamera(picture, size, rate)
    try:
        yield camera
    finally:
        camera.close()


def has_rtsp() -> bool:
    """Whether GStreamer's RTSP server is installed (setup.sh's system-soak)."""
    asks = "import gi; gi.require_version('GstRtspServer', '1.0')"
    try:
        return subprocess.run([_SYSTEM_PYTHON, "-c", asks], capture_output=True).returncode == 0
    except OSError:
        return False
