"""A scene seen from the real camera's place: its picture hangs far behind everything, and every
browser's camera is put there, and back if it was moved."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.render.picture_plane import Plane, plain_plane
from venus3d.scene.web.server import LocalServer

_JPEG_QUALITY = 80
_DISTANCE = 30.0
"""Distance of the picture, metres: behind everything."""
_HERE, _AHEAD, _UP = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)
_USUAL_ASPECT = 16 / 9


class LensView:
    """The picture and the cameras of all browsers of a server. All methods belong to the drawing
    threads."""

    def __init__(self, server: LocalServer, on_window: Callable[[], None]) -> None:
        """`on_window` is called, on any thread, when a browser's window or the picture's shape has
        changed and `fit` is due."""
        self._server, self._on_window = server, on_window
        self._plane = plain_plane((16, 9))
        self._fitted: dict[int, tuple[float, Plane]] = {}
        self._image: Any = None
        self._hung: Plane | None = None
        camera = server.initial_camera
        camera.position, camera.look_at, camera.up = _HERE, _AHEAD, _UP
        camera.near, camera.far = 0.01, 2 * _DISTANCE
        camera.fov = self._plane.fov_rad(_USUAL_ASPECT)

        def connected(client: viser.ClientHandle) -> None:
            client.camera.on_update(lambda _: on_window())
            on_window()

        server.on_client_connect(connected)

    def show_picture(self, rgb: NDArray[np.uint8], plane: Plane) -> None:
        """Show this picture (H, W, 3) RGB on this plane."""
        if plane == self._hung:
            self._image.image = rgb
            return
        width, height = plane.right - plane.left, plane.bottom - plane.top
        centre = np.array([plane.left + plane.right, plane.top + plane.bottom, 2.0]) / 2
        with self._server.atomic():
            if self._image is None:
                self._image = self._server.scene.add_image(
                    "/picture",
                    rgb,
                    1.0,
                    1.0,
                    format="jpeg",
                    jpeg_quality=_JPEG_QUALITY,
                    cast_shadow=False,
                    receive_shadow=False,
                )
            self._image.render_width = _DISTANCE * width
            self._image.render_height = _DISTANCE * height
            self._image.position, self._image.image = _DISTANCE * centre, rgb
            self._plane = self._hung = plane
            self._server.initial_camera.fov = plane.fov_rad(_USUAL_ASPECT)
        self._on_window()

    def fit(self) -> None:
        """Show the whole picture from the real camera in every browser, whatever its window."""
        clients = self._server.get_clients()
        for number, client in clients.items():
            camera = client.camera
            aspect = camera.image_width / max(camera.image_height, 1)
            astray = (
                float(np.abs(camera.position - _HERE).max()) > 1e-4
                or float(np.abs(camera.look_at - _AHEAD)[:2].max()) > 1e-4
            )
            if not astray and self._fitted.get(number) == (aspect, self._plane):
                continue
            self._fitted[number] = (aspect, self._plane)
            # A browser may report another camera meanwhile; ignore it.
            with contextlib.suppress(ValueError), client.atomic():
                if astray:
                    camera.up_direction, camera.position, camera.look_at = _UP, _HERE, _AHEAD
                camera.fov = self._plane.fov_rad(aspect)
        self._fitted = {number: seen for number, seen in self._fitted.items() if number in clients}
