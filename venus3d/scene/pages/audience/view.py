"""The second monitor's page in viser: the picture in the scene, HTML around it, no controls."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.picture_plane import Plane
from venus3d.scene.pages.audience.glance import glance_html, sheet
from venus3d.scene.pages.audience.sound import cue_html, speech_html, switches_html
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.audience.view_model import AudienceViewModel, Cue
from venus3d.scene.web.lens_view import LensView
from venus3d.scene.web.server import LocalServer

_USUAL_ASPECT = 16 / 9


class AudienceView:
    """The page for all spectators. All methods but the callback belong to the drawing threads."""

    def __init__(self, server: LocalServer, on_window: Callable[[], None]) -> None:
        """Lay the page out. `on_window` is called, on any thread, when a browser's window or the
        picture's shape has changed and the thread that calls `show` must call `fit`."""
        self._server, self._lens = server, LensView(server, on_window)
        self._aspect = self._shown_aspect = _USUAL_ASPECT
        gui = server.gui
        self._sheet, self._glance = gui.add_html(""), gui.add_html("")
        self._sounds, self._cue, self._speech = (gui.add_html("") for _ in range(3))
        self._played = self._spoken = 0
        self.play(None)
        self.speak("")
        self.dress(AudienceState())

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
        self._lens.show_picture(rgb, plane)

    def fit(self) -> None:
        """Show the whole picture from the real camera in every browser, whatever its window."""
        if self._aspect != self._shown_aspect:
            self._shown_aspect = self._aspect
            self.dress(self._look)
        self._lens.fit()
