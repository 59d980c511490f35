"""The second monitor: takes snapshots and pictures as the viewer does, and gives nothing back.

Any thread may call it. Two small threads draw, each from a one-slot box in which the newest wins;
what goes wrong there is logged, told to the operator (`on_failure`), and the page is drawn anew.
What its browsers send reaches nobody (`scene.server.ReadOnlyServer`). Another program can feed it:
`Audience("127.0.0.1", 8090).show(snapshot)`.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.choices import AudienceChoices
from venus3d.scene.pages.audience.lens import plain_plane, undistortion
from venus3d.scene.pages.audience.lens_overlay import LensOverlay
from venus3d.scene.pages.audience.view import AudiencePage
from venus3d.scene.pages.audience.view_model import Cue, Moment, achieved, moment_of
from venus3d.scene.render.annotated_picture import LivePicture, annotate, small_picture
from venus3d.scene.web.drawing import DrawingThreads
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import ReadOnlyServer, serve_anew, start_read_only_server
from venus3d.scene.web.theme import Theme

PICTURE_WIDTH = 960
_SCENE_PERIOD_S, _PICTURE_PERIOD_S = 1 / 12, 1 / 15
_SENT_PER_S = 240
"""To all browsers together: a class of 30 gets 8 pictures a second, so that the operator's page,
which shares the machine, stays quick."""
_SHOWN_S: dict[Cue, float] = {"reached": 0.9, "captured": 1.8}
"""How long a person is given to see what was achieved."""


class Audience:
    """One read-only page, for any number of browsers."""

    def __init__(self, host: str, port: int, look: AudienceChoices | None = None) -> None:
        """Serve the page, on this very port.

        Raises `AddressError` if the address cannot be bound or the port is taken.
        """
        server = start_read_only_server(host, port)
        self.host, self.port = host, port
        self.on_failure: Callable[[str], None] = lambda text: None
        """Called on a drawing thread with a sentence for the operator."""
        self._look = look or AudienceChoices()
        self._snapshot: Snapshot | None = None
        self._achieved: tuple[Cue, Moment] | None = None
        self._picture: tuple[LivePicture, Observation | None] | None = None
        self._paused, self._changed = False, True
        self._wake = threading.Condition()
        self._picture_came = threading.Event()
        self._lay_out(server)
        self._threads = DrawingThreads(
            self._draw_anew, audience=self._loop, audience_picture=self._picture_loop
        )
        self._threads.start()

    @property
    def url(self) -> str:
        """The page's address on this machine."""
        return self.server.url

    @property
    def look(self) -> AudienceChoices:
        """How it is shown now."""
        return self._look

    def choose(self, change: Callable[[AudienceChoices], AudienceChoices]) -> None:
        """Change how it is shown; from any thread."""
        with self._wake:
            self._look = change(self._look)
        self._touch()
        self._picture_came.set()

    def show(self, snapshot: Snapshot) -> None:
        """Show this moment; the newest wins."""
        with self._wake:
            # What was achieved is seen here, since not every snapshot is drawn.
            self._achieved = achieved(self._snapshot, snapshot) or self._achieved
            self._snapshot = snapshot
        self._touch()

    def show_picture(self, image: LivePicture, observation: Observation | None = None) -> None:
        """Show this live picture (BGR or grey), with the corners of `observation`, or by default
        of the newest snapshot; the newest wins."""
        self._picture = (image, observation)
        self._picture_came.set()

    def pause(self, on: bool) -> None:
        """Say that no pictures are taken for now, or take it back."""
        self._paused = on
        self._touch()

    def close(self) -> None:
        """Stop drawing and serving. May be called twice."""
        if self._threads.end(self._came_or_changed):
            self.server.stop()

    # -- drawing ---------------------------------------------------------------------------------

    def _lay_out(self, server: ReadOnlyServer) -> None:
        self.server = server
        self._scene = SceneView(server)
        self._page = AudiencePage(server, self._came_or_changed)

    def _draw_anew(self, error: Exception) -> None:
        self._lay_out(serve_anew(self.server, self._threads.stop))
        self.on_failure(texts.DRAWN_ANEW.format(cause=type(error).__name__))
        self._came_or_changed()

    def _touch(self) -> None:
        with self._wake:
            self._changed = True
            self._wake.notify_all()

    def _came_or_changed(self) -> None:
        self._touch()
        self._picture_came.set()  # who comes while no frame does sees the last one

    def _loop(self) -> None:
        overlay, dressed = LensOverlay(), None  # the page and the look that it has
        praise: Moment | None = None
        until = 0.0
        while not self._threads.stop.is_set():
            with self._wake:
                if not self._changed:
                    self._wake.wait(timeout=0.5)
                now = time.monotonic()
                due = self._changed or (praise is not None and now > until)
                self._changed, snapshot, look = False, self._snapshot, self._look
                news, self._achieved = self._achieved, None
            if now > until:
                praise = None
            with self.server.atomic():
                if (self._page, look) != dressed:
                    self._page.dress(look)
                    dressed = (self._page, look)
                if news is not None:
                    praise, until = news[1], now + _SHOWN_S[news[0]]
                    if look.sound:
                        self._page.play(news[0])
                elif praise is None:
                    self._page.play(None)
                if due or news is not None:
                    moment = praise or moment_of(snapshot, paused=self._paused)
                    self._page.show(moment, snapshot, dark=not look.light)
                    self._scene.draw(overlay.shapes(snapshot, look), dark=True)
            self._page.fit()
            self._threads.stop.wait(
                max(0.0, now + self._period(_SCENE_PERIOD_S) - time.monotonic())
            )

    def _period(self, least: float) -> float:
        return max(least, self._page.watched / _SENT_PER_S)

    def _picture_loop(self) -> None:
        while not self._threads.stop.is_set():
            self._picture_came.wait()
            self._picture_came.clear()
            started, came = time.monotonic(), self._picture
            if came is None or self._threads.stop.is_set():
                continue
            if self._page.watched:
                self._draw_picture(*came)
            self._threads.stop.wait(
                max(0.0, started + self._period(_PICTURE_PERIOD_S) - time.monotonic())
            )

    def _draw_picture(self, image: LivePicture, observation: Observation | None) -> None:
        rgb, snapshot = small_picture(image, PICTURE_WIDTH), self._snapshot
        size = (rgb.shape[1], rgb.shape[0])
        if snapshot is None:
            self._page.show_picture(rgb, plain_plane(size))
        elif self._look.lens:
            straight = undistortion(snapshot.camera.scaled(size))
            self._page.show_picture(straight.straightened(rgb), straight.plane)
        else:
            step = 1 if snapshot.match is None else snapshot.match.active_step
            annotate(rgb, snapshot, observation, step, Theme(True).step_colours[step - 1])
            self._page.show_picture(rgb, plain_plane(size))
