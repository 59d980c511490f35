"""A network camera for tests: MJPEG over HTTP, that stalls, breaks off, is restarted, or sends
damaged pictures, when it is told to."""

from __future__ import annotations

import http.server
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

import cv2
import numpy as np
from numpy.typing import NDArray

Picture = Callable[[int], NDArray[np.uint8]]
"""The picture of this number, counted from 0."""


class NetworkCamera:
    """Serves pictures at `address` to everybody who asks, while it is `plugged_in`."""

    def __init__(self, picture: Picture, rate: float = 50.0) -> None:
        self.picture, self.rate = picture, rate
        self.stalled = False
        self.damaged = False
        """Only half of each picture is sent."""
        self.sent = self.connections = 0
        self._unplugged = threading.Event()
        self._port = 0
        self.plug_in()

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self._port}/stream.mjpg"

    def plug_in(self) -> None:
        """Start sending; after `unplug` at the same address."""
        camera, self._unplugged = self, threading.Event()

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
                self.end_headers()
                with suppress(OSError):  # the reader hung up
                    camera._send(self.wfile.write, camera._unplugged)

            def log_message(self, format: str, *args: object) -> None:
                pass

        class Server(http.server.ThreadingHTTPServer):
            daemon_threads = True

            def handle_error(self, request: object, client_address: object) -> None:
                pass  # a reader that hung up before it was answered

        self._server = Server(("127.0.0.1", self._port), Handler)
        self._port = self._server.server_port
        threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True).start()

    def unplug(self) -> None:
        """Break all connections off and accept none."""
        self._unplugged.set()
        self._server.shutdown()
        self._server.server_close()

    def _send(self, write: Callable[[bytes], object], unplugged: threading.Event) -> None:
        self.connections += 1
        while not unplugged.wait(1 / self.rate):
            if self.stalled:
                continue
            jpeg = cv2.imencode(".jpg", self.picture(self.sent))[1].tobytes()
            jpeg = jpeg[: len(jpeg) // 2] if self.damaged else jpeg
            head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
            write(head.encode() + jpeg + b"\r\n")
            self.sent += 1


@contextmanager
def network_camera(picture: Picture, rate: float = 50.0) -> Iterator[NetworkCamera]:
    """One that is unplugged at the end."""
    camera = NetworkCamera(picture, rate)
    try:
        yield camera
    finally:
        camera.unplug()
