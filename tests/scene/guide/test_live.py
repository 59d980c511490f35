"""The live loop with its real parts: rendered camera, detector, session, viewer, four threads."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from datetime import datetime, timedelta
from html import escape

import numpy as np
import pytest

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.waiting import wait_until
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.errors import SourceError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import LivePicture
from venus3d.scene.pages.audience import texts as audience_texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.guide import texts
from venus3d.scene.pages.guide.guidance_panel import guidance_html
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.step_card import NO_NOTE
from venus3d.scene.web.theme import Theme
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.sim import Simulation

pytestmark = pytest.mark.slow
_PATIENCE_S = 120.0
_SMALL = PAPER_CAMERA.scaled((640, 360))


class BreakingCamera(Simulation):
    """A simulated camera that stalls, or whose plug is pulled, when it is told to."""

    pulled = False
    stalled = False

    def read(self) -> Frame | None:
        while self.stalled:
            time.sleep(0.01)
        if self.pulled:
            raise SourceError("The camera was unplugged; plug it in and start again.")
        return super().read()


@pytest.fixture
def camera() -> Iterator[BreakingCamera]:
    source = BreakingCamera(_SMALL, Board(), realtime=True, speed=3.0)
    yield source
    source.close()


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    page = Viewer(port=free_port())
    yield page
    page.close()


def in_background(live: LiveGuide) -> tuple[threading.Thread, list[BaseException]]:
    raised: list[BaseException] = []

    def run() -> None:
        try:
            live.run()
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    return thread, raised


def wait_for(condition: Callable[[], bool]) -> None:
    wait_until(condition, within_s=_PATIENCE_S)


def shown_by(monitor: Audience) -> str:
    """All that a browser would be sent now."""
    with RawClient(monitor.port) as client:
        return str(client.backlog())


def guide(camera: Simulation, viewer: Viewer, results: list[Snapshot]) -> tuple[Session, LiveGuide]:
    session = Session(camera.board, camera.image_size, Settings(max_views=12))

    tracker = BoardTracker(Detector(camera.board, find_layout=False))
    return session, LiveGuide(session, camera, tracker, viewer, results.append, lambda: camera)


def test_a_camera_that_is_unplugged_leaves_what_was_captured(
    camera: BreakingCamera, viewer: Viewer
) -> None:
    results: list[Snapshot] = []
    session, live = guide(camera, viewer, results)
    thread, raised = in_background(live)
    wait_for(lambda: len(session.snapshot().views) >= 2)
    camera.pulled = True
    thread.join(_PATIENCE_S)
    assert not thread.is_alive()
    assert len(raised) == 1 and "unplugged" in str(raised[0])
    assert len(results[-1].views) >= 2 and results[-1].views == session.snapshot().views
    said = guidance_html(session.snapshot(), viewer.state, Theme(True), NO_NOTE)
    assert texts.NO_PICTURES in said and "captured is kept" in said, "the page's last words"


def test_pictures_that_stop_are_told_on_both_pages_until_they_come_again(
    camera: BreakingCamera, viewer: Viewer
) -> None:
    monitor = Audience("127.0.0.1", free_port())
    session = Session(camera.board, camera.image_size)
    tracker = BoardTracker(Detector(camera.board, find_layout=False))
    live = LiveGuide(session, camera, tracker, viewer, lambda _: None, lambda: camera, (monitor,))
    thread, raised = in_background(live)
    try:
        wait_for(lambda: session.snapshot().pose is not None)
        assert not viewer.state.no_pictures
        at = datetime.now()
        camera.stalled = True
        wait_for(lambda: bool(viewer.state.no_pictures))
        assert datetime.now() - at > timedelta(seconds=1.9)
        now = (at + timedelta(seconds=s) for s in (-1, 0, 1))
        assert any(f"{moment:%H:%M:%S}" in viewer.state.no_pictures for moment in now)
        # A picture that shows is old: whoever holds the board must know, too.
        wait_for(lambda: escape(viewer.state.no_pictures) in viewer.view.guidance.content)
        wait_for(lambda: audience_texts.NO_PICTURES[1] in shown_by(monitor))
        camera.stalled = False
        wait_for(lambda: not viewer.state.no_pictures)
        wait_for(lambda: audience_texts.NO_PICTURES[1] not in shown_by(monitor))
    finally:
        live.stop()
        thread.join(_PATIENCE_S)
        monitor.close()
    assert not thread.is_alive() and not raised


def test_the_picture_goes_on_while_the_mathematics_is_at_work(
    camera: BreakingCamera, viewer: Viewer
) -> None:
    """The process that works is stopped until we say so: frames and observations must go on."""
    others = set(multiprocessing.active_children())
    session, live = guide(camera, viewer, [])
    (works,) = set(multiprocessing.active_children()) - others
    assert works.pid is not None
    thread, raised = in_background(live)
    try:
        wait_for(lambda: session.phase == "startup" and session.snapshot().number > 0)
        os.kill(works.pid, signal.SIGSTOP)
        wait_for(lambda: session.phase == "captured")
        seen = session.snapshot().number
        wait_for(lambda: session.snapshot().number >= seen + 10)
        assert session.phase == "captured", "ten more frames were seen during the work"
        os.kill(works.pid, signal.SIGCONT)
        wait_for(lambda: session.phase == "guiding")
    finally:
        os.kill(works.pid, signal.SIGCONT)
        live.stop()
        thread.join(_PATIENCE_S)
    assert not thread.is_alive() and not raised


def test_the_picture_kept_of_a_view_is_the_one_it_was_measured_in(
    camera: BreakingCamera, viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The board moves on while a view is worked out: a later frame's corners are elsewhere."""
    kept: dict[int, LivePicture] = {}

    def keep(_: Viewer, number: int, image: LivePicture) -> None:
        kept[number] = image.copy()

    monkeypatch.setattr(Viewer, "keep_view", keep)
    session, live = guide(camera, viewer, [])
    thread, raised = in_background(live)
    wait_for(lambda: len(session.snapshot().views) >= 3)
    live.stop()
    thread.join(_PATIENCE_S)
    assert not thread.is_alive() and not raised
    views = session.snapshot().views
    assert len(views) >= 3 and set(kept) >= {view.number for view in views[:3]}
    for view in views[:3]:
        seen = Detector(camera.board, find_layout=False).detect(kept[view.number])
        ids, here, there = np.intersect1d(seen.ids, view.observation.ids, return_indices=True)
        assert len(ids) >= 15
        # It may have been followed, not searched: a corner in doubt is then another one.
        apart = np.linalg.norm(seen.corners[here] - view.observation.corners[there], axis=1)
        assert np.median(apart) < 0.05 and apart.max() < 0.6
