"""Measuring with the camera that was calibrated just now: a page beside the operator's.

It is fed like a second monitor, opens once a calibration is over, and then stays."""

from __future__ import annotations

from collections.abc import Callable

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.measurement import MeasuringCamera
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import VenusError
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import Language
from venus3d.render.annotated_picture import LivePicture
from venus3d.scene.pages.measure.page import MeasurePage


class MeasureMonitor:
    """The measuring page of a guided calibration. A `SecondMonitor`."""

    def __init__(self, host: str, port: int, language: Language | None = None) -> None:
        """Nothing is served yet; `port` is the first one to try."""
        self._host, self._port, self._language = host, port, language
        self._page: MeasurePage | None = None
        self._by: Calibration | None = None
        self._held = self._failed = False
        self.on_open: Callable[[str], None] = lambda url: None
        """Called with the page's address once it is served."""

    @property
    def page(self) -> MeasurePage | None:
        """The page; None until a calibration is over."""
        return self._page

    def show(self, snapshot: Snapshot) -> None:
        """Show the moment's picture, and take over the camera of a calibration that is over."""
        known = snapshot.calibration
        over = snapshot.phase in ("converged", "finished")
        if over and known is not None and known is not self._by and all(known.free):
            self._take_over(known)
        page = self._page
        if page is None or self._held or not page.server.get_clients():
            return
        if snapshot.observation.image_size == page.image_size:
            page.show(snapshot.observation)

    def show_picture(self, image: LivePicture, observation: Observation | None = None) -> None:
        """Nothing: a picture is shown once the board in it is known."""

    def pause(self, on: bool) -> None:
        """Nothing: the picture stays."""

    def no_pictures(self, since: str) -> None:
        """Nothing: the picture stays."""

    def close(self) -> None:
        """Stop serving. May be called twice."""
        if self._page is not None:
            self._page.close()

    def _take_over(self, known: Calibration) -> None:
        self._by = known
        by = MeasuringCamera(known.camera, known.covariance, known.residual_sigma_px)
        if self._page is not None:
            self._page.measure_by(by, known.board)
            return
        if self._failed:
            return
        try:
            page = MeasurePage(self._host, self._port, by, known.board, self._language)
        except VenusError:  # no port is free: the calibration does without
            self._failed = True
            return
        page.on_hold = self._hold
        self._page = page
        self.on_open(page.server.outside_url or page.url)

    def _hold(self, on: bool) -> None:
        self._held = on
