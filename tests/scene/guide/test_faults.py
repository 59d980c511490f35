"""Faults in the middle of a live session, all in one: it goes on and keeps capturing."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.waiting import wait_until
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.render.offscreen import Image, Offscreen
from venus3d.render.projections import Projections
from venus3d.render.shapes import Colour, LineShape, MeshShape
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.sim import Simulation
from venus3d.storage.session_folder import SessionFolder
from venus3d.storage.session_moments import moments_of

pytestmark = pytest.mark.slow
_PATIENCE_S = 120.0
_RECONNECTS = 50


class JumpingClock(Simulation):
    """A camera whose clock is set while it runs: back by an hour, then far ahead."""

    off_s = 0.0

    def read(self) -> Frame | None:
        frame = super().read()
        return None if frame is None else replace(frame, time_s=frame.time_s + self.off_s)


class LostContext:
    """OpenGL that has stopped."""

    def render(
        self, camera: Camera, shapes: Sequence[MeshShape | LineShape], background: Colour
    ) -> Image:
        raise RuntimeError("the context is lost")

    def close(self) -> None:
        raise RuntimeError("the context is lost")


def test_a_live_session_goes_on(tmp_path: Path) -> None:
    """The clock jumps, the renderer raises, and a browser reconnects as often as in a minute."""
    board, port = Board(), free_port()
    source = JumpingClock(PAPER_CAMERA.scaled((640, 360)), board, realtime=True, speed=3.0)
    folder = SessionFolder.create(tmp_path / "session", {"options": {}}, lambda _: None)
    # Never settled: on a busy machine the session was over before the browser had come back.
    settings = Settings(method="random", epsilon=1e-9, max_views=1000)
    session = Session(board, source.image_size, settings, folder)
    folder.changed(session.state)
    with (
        closing(folder),
        closing(Offscreen()) as offscreen,
        closing(Viewer(port=port, projections=Projections(offscreen))) as viewer,
    ):
        tracker = BoardTracker(Detector(board, find_layout=False))
        live = LiveGuide(session, source, tracker, viewer, lambda _: None, lambda: source)
        thread = threading.Thread(target=live.run)
        thread.start()
        try:
            for off_s, work in ((-3600.0, lambda: None), (1e9, lambda: reconnect(port))):
                views = len(session.snapshot().views)
                wait_for_views(session, views + 1)
                source.off_s = off_s
                work()
            offscreen._renderer = LostContext()  # pyright: ignore[reportPrivateUsage]
            wait_for_views(session, len(session.snapshot().views) + 1)
            assert thread.is_alive()
            wait_until(lambda: offscreen.backend == "painter", "the other renderer draws")
            assert "OpenGL failed" in offscreen.note
        finally:
            live.stop()
            thread.join(_PATIENCE_S)
        moments = moments_of(folder.directory)
        assert len([m for m in moments if m.kind == "captured"]) >= 3


def wait_for_views(session: Session, count: int) -> None:
    wait_until(lambda: len(session.snapshot().views) >= count, f"{count} views", _PATIENCE_S)


def reconnect(port: int) -> None:
    """Connect and leave; no handle and no thread stays."""
    process = psutil.Process()
    with RawClient(port) as browser:
        browser.window()
        before = process.num_fds()
    for _ in range(_RECONNECTS):
        with RawClient(port) as browser:
            browser.window()
    wait_until(lambda: process.num_fds() <= before, "the handles are closed", _PATIENCE_S)
