"""The second monitor: takes snapshots and pictures like the viewer, and accepts no input but each
browser's own point of view.

Any thread may call it, also of another program: `Audience("127.0.0.1", 8090).show(snapshot)`. Two
threads draw the newest snapshot and picture; errors are logged, reported to the operator
(`on_failure`), and the page is reloaded. All other browser input is dropped
(`scene.web.server.ReadOnlyServer`).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import Language
from venus3d.render.annotated_picture import LivePicture, small_picture
from venus3d.render.picture_plane import plain_plane, undistortion
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.lens import LensOverlay
from venus3d.scene.pages.audience.sound import Alarm, Speaker
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.audience.view import AudienceView
from venus3d.scene.pages.audience.view_model import (
    AudienceViewModel,
    Cue,
    achieved,
    view_model_of,
)
from venus3d.scene.web.delivery import deliver
from venus3d.scene.web.page import Page
from venus3d.scene.web.picture_feed import PICTURE_PERIOD_S, PictureFeed, SeenPicture
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer, start_read_only_server
from venus3d.scene.web.told_moment import ToldMoment

PICTURE_WIDTH = 960
_SCENE_PERIOD_S = 1 / 12
_SENT_PER_S = 240
"""Pictures per second to all browsers together: 30 get 8 each, so that the operator's page stays
responsive."""
_SHOWN_S: dict[Cue, float] = {"reached": 0.9, "captured": 1.8}
"""How long an achievement is shown."""


class Audience(Page[AudienceState]):
    """A read-only page for any number of browsers; its state is how things are shown."""

    def __init__(
        self,
        host: str,
        port: int,
        choices: AudienceState | None = None,
        language: Language | None = None,
        asks_token: bool = False,
    ) -> None:
        """Serve the page on exactly this port, in this language or the first browser's; beyond this
        machine on request only for browsers that show the token in its address. Raises
        `AddressError` if the address cannot be bound or the port is taken."""
        super().__init__(
            start_read_only_server(host, port, language, asks_token=asks_token),
            state=choices or AudienceState(),
            period_s=_SCENE_PERIOD_S,
        )
        self.on_failure: Callable[[str], None] = lambda text: None
        """Called on a drawing thread with a sentence for the operator."""
        self._snapshot: Snapshot | None = None
        self._achieved: tuple[Cue, AudienceViewModel] | None = None
        self._praise: tuple[AudienceViewModel, float] | None = None  # the message, until when
        self._paused, self._silent_since = False, ""
        self._shown, self._speaker, self._alarm = view_model_of(None), Speaker(), Alarm()
        self._overlay, self._told = LensOverlay(), ToldMoment()
        self._pictures = PictureFeed(self._draw_picture, lambda: self._paced(PICTURE_PERIOD_S))
        self._open(audience_picture=self._pictures.loop)

    def change(self, change: Callable[[AudienceState], AudienceState]) -> AudienceState:
        """Change the display options; from any thread."""
        choices = super().change(change)
        self._pictures.again()
        return choices

    def show(self, snapshot: Snapshot) -> None:
        """Show this moment; the newest wins."""
        with self.language.spoken(), self._lock:
            # Achievements are detected here, since not every snapshot is drawn.
            self._achieved = achieved(self._snapshot, snapshot) or self._achieved
            self._snapshot = snapshot
        self.wake()

    def show_picture(self, image: LivePicture, observation: Observation | None = None) -> None:
        """Show this live picture (BGR or grey), with the corners of `observation`, or by default of
        the newest snapshot; the newest wins."""
        self._pictures.put(image, observation)

    def pause(self, on: bool) -> None:
        """Say that pictures are paused, or are no longer."""
        self._paused = on
        self.wake()

    def no_pictures(self, since: str) -> None:
        """Say that no pictures come, since this time of day; empty: they come again."""
        self._silent_since = since
        self.wake()

    # -- drawing ---------------------------------------------------------------------------------

    def _lay_out(self, server: LocalServer) -> None:
        self._scene = SceneView(server)
        self._dressed: AudienceState | None = None
        self._view = AudienceView(server, self._wake_loops)

    def _tell_of_failure(self, error: Exception) -> None:
        self.on_failure(texts.DRAWN_ANEW.format(cause=type(error).__name__))

    def _wake_loops(self) -> None:
        if self._stopping.is_set():
            self._pictures.stop()
        self._pictures.again()  # a late visitor sees the last picture if no frame comes
        self.wake()

    @property
    def _period_s(self) -> float:
        return self._paced(_SCENE_PERIOD_S)

    def _paced(self, least: float) -> float:
        return max(least, self._view.watched / _SENT_PER_S)

    def _draw(self, changed: bool, seconds: float) -> None:
        with self._lock:
            snapshot, choices = self._snapshot, self._state
            news, self._achieved = self._achieved, None
        over = self._praise is not None and time.monotonic() > self._praise[1]
        if over:
            self._praise = None
        with self.server.atomic():
            if choices is not self._dressed:
                self._view.dress(choices)
                self._dressed = choices
            if news is not None:
                self._praise = news[1], time.monotonic() + _SHOWN_S[news[0]]
                self._view.play(news[0])
            if changed or over or news is not None:
                now = view_model_of(snapshot, self._paused, self._silent_since)
                self._shown = self._praise[0] if self._praise else now
                self._view.show(self._shown, snapshot, dark=not choices.light)
                if (
                    self._praise and snapshot is not None
                ):  # of what was reached, not of what is next
                    snapshot = replace(snapshot, remaining=self._shown.remaining)
                self._tell_of(snapshot)
                self._scene.draw(self._overlay.shapes(snapshot, choices), dark=True)
            if self._alarm.due(bool(self._silent_since), time.monotonic()):
                self._view.play("alarm")
            if sentence := self._speaker.due(self._shown, time.monotonic()):
                self._view.speak(sentence)
        deliver(self.server)
        self._view.fit()

    def _tell_of(self, snapshot: Snapshot | None) -> None:
        """Have the picture's overlay of this moment, too: at once if it says something else."""
        if snapshot is None:
            return
        active = 1 if snapshot.remaining is None else snapshot.remaining.active
        step = self._shown.step or active
        newest = self._pictures.newest
        if self._told.tell(snapshot, step) and newest is not None:
            self._draw_picture(newest)

    def _draw_picture(self, newest: SeenPicture) -> None:
        if not self._view.watched:
            return
        with self._told.lock:
            self._show_picture(newest)

    def _show_picture(self, newest: SeenPicture) -> None:
        rgb, snapshot = small_picture(newest.image, PICTURE_WIDTH), self._told.snapshot
        size = (rgb.shape[1], rgb.shape[0])
        if snapshot is None:
            self._view.show_picture(rgb, plain_plane(size))
        elif self._state.lens:
            straight = undistortion(snapshot.camera.scaled(size))
            self._view.show_picture(straight.straightened(rgb), straight.plane)
        else:
            self._told.annotate(rgb, newest.observation)
            self._view.show_picture(rgb, plain_plane(size))
