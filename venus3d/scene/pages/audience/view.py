"""The second monitor's page in viser: a picture in the scene, HTML around it, no controls. Every
browser's camera is put in the real camera's place, and back if it was moved."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.audience.glance import glance_html, sheet
from venus3d.scene.pages.audience.lens import Plane, plain_plane
from venus3d.scene.pages.audience.sound import cue_html, speech_html, switches_html
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.audience.view_model import AudienceViewModel, Cue
from venus3d.scene.web.server import LocalServer

JPEG_QUALITY = 80
_DISTANCE = 30.0
"""Distance of the picture, metres: behind everything."""
_HERE, _AHEAD, _UP = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)
_USUAL_ASPECT = 16 / 9


class AudienceView:
    """The page for all spectators. All methods but the callback belong to the drawing threads."""

    def __init__(self, server: LocalServer, on_window: Callable[[], None]) -> None:
        """Lay the page out. `on_window` is called, on any thread, when a browser's window or the
        picture's shape has changed and the thread that calls `show` must call `fit`."""
        self._server, self._on_window = server, on_window
        self._plane = plain_plane((16, 9))
        self._fitted: dict[int, tuple[float, Plane]] = {}
        self._image: Any = None
        self._aspect = self._shown_aspect = _USUAL_ASPECT
        self._hung: Plane | None = None
        camera = server.initial_camera
        camera.position, camera.look_at, camera.up = _HERE, _AHEAD, _UP
        camera.near, camera.far = 0.01, 2 * _DISTANCE
        camera.fov = self._plane.fov_rad(_USUAL_ASPECT)
        gui = server.gui
        self._sheet, self._glance = gui.add_html(""), gui.add_html("")
        self._sounds, self._cue, self._speech = (gui.add_html("") for _ in range(3))
        self._played = self._spoken = 0
        self.play(None)
        self.speak("")
        self.dress(AudienceState())

        def connected(client: viser.ClientHandle) -> None:
            client.camera.on_update(lambda _: on_window())
            on_window()

        server.on_client_connect(connected)

    @property
    def watched(self) -> int:
        """Number of connected browsers."""
        return len(self._server.get_clients())

    def dress(self, look: AudienceState) -> None:
        """Apply the options of the whole page."""
        self._server.gui.configure_theme(
            dark_mode=not look.light, show_logo=False, show_share_button=False
        )
        self._look = look
        self._sheet.content = sheet(look, self._aspect)
        self._sounds.content = switches_html(look.sound)

    def show(self, moment: AudienceViewModel, snapshot: Snapshot | None, *, dark: bool) -> None:
        """Show this moment's texts."""
        self._glance.content = glance_html(moment, snapshot, dark=dark)

    def play(self, cue: Cue | None) -> None:
        """Play the tones of an achievement or an alarm in browsers with tones on."""
        self._played += cue is not None
        self._cue.content = cue_html(cue, self._played)

    def speak(self, sentence: str) -> None:
        """Speak this in browsers with the voice on; nothing if it is empty."""
        self._spoken += bool(sentence)
        self._speech.content = speech_html(sentence, self._spoken)

    def show_picture(self, rgb: NDArray[np.uint8], plane: Plane) -> None:
        """Show this picture (H, W, 3) RGB on this plane."""
        self._aspect = rgb.shape[1] / rgb.shape[0]
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
                    jpeg_quality=JPEG_QUALITY,
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
        if self._aspect != self._shown_aspect:
            self._shown_aspect = self._aspect
            self.dress(self._look)
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
