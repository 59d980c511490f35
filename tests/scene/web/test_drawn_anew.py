"""What breaks the drawing of a page: it is logged once, the page is drawn anew, and those who feed
it or look at it go on.

Seen before: any error in a drawing thread was raised in the thread that guides, and six of eight
such sessions lost every view.
"""

from __future__ import annotations

import contextlib
import logging
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rich
from websockets.exceptions import WebSocketException

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.scene.teach_server import served_teaching
from tests.waiting import wait_until
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.exercise.practice import Practice, PracticeSettings
from venus3d.scene.pages.exercise.practice_page import PracticePage
from venus3d.scene.pages.exercise.run import PracticeServer, trial_server
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_page import TrialPage
from venus3d.scene.pages.exercise.trial_pictures import TrialPictures
from venus3d.scene.pages.exercise.trial_plan import plan_of
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.pages.teach.state import Vector
from venus3d.scene.pages.teach.view_model import PoseAnalysis, TaughtPose
from venus3d.scene.web import texts as common
from venus3d.scene.web.server import start_server
from venus3d.scene.web.step_texts import TILE_FAILED
from venus3d.storage.exercise import ExerciseFile

FRAME = np.full((72, 128, 3), 90, np.uint8)


class Fault:
    """Raises while `due`, and counts how often."""

    def __init__(self) -> None:
        self.due = 0
        self.raised = 0

    def __call__(self, *_: Any, **__: Any) -> None:
        if self.due > 0:
            self.due -= 1
            self.raised += 1
            raise RuntimeError("a mistake of ours")

    def before(self, owner: Any, name: str, patch: pytest.MonkeyPatch) -> None:
        """Let a function raise from now on whenever it is due."""
        real = getattr(owner, name)

        def faulty(*args: Any, **options: Any) -> Any:
            self()
            return real(*args, **options)

        patch.setattr(owner, name, faulty)


@pytest.fixture
def fault() -> Fault:
    return Fault()


@pytest.fixture
def viewer(painter: Offscreen) -> Iterator[Viewer]:
    viewer = Viewer(port=free_port(), projections=Projections(painter), draggable_board=True)
    yield viewer
    viewer.close()


def page_of(port: int, *wanted: str) -> str:
    """What a new tab is sent until all this came, as one text; it comes back as a browser does."""
    end = time.monotonic() + 40
    while time.monotonic() < end:
        came = ""
        with contextlib.suppress(WebSocketException, OSError), RawClient(port) as tab:
            tab.look()
            while not all(text in came for text in wanted):
                came += str(tab.window(timeout=20))
            return came
        time.sleep(0.1)
    raise AssertionError(f"never came: {wanted}")


def logged(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [r.getMessage() for r in caplog.records if r.name.startswith("venus3d")]


@pytest.mark.parametrize(
    ("module", "where"),
    [("scene.pages.guide.viewer", "describe"), ("scene.web.told_moment", "annotate")],
)
def test_a_guide_page_that_breaks_is_drawn_anew(
    viewer: Viewer,
    guided: Snapshot,
    fault: Fault,
    module: str,
    where: str,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """In the thread of the scene or in that of the picture; three times in all, told once."""
    fault.before(import_module(f"venus3d.{module}"), where, monkeypatch)
    viewer.keep_view(guided.views[0].number, FRAME)
    viewer.show(guided)
    viewer.show_picture(FRAME)
    page_of(viewer.port, "/board/live")
    for count in (1, 2, 3):
        before, fault.due = viewer.server, 1

        def fed(count: int = count) -> bool:
            viewer.show(guided)  # raises nothing
            viewer.show_picture(FRAME)
            return fault.raised == count

        wait_until(fed)
        wait_until(lambda: viewer.server is not before)  # noqa: B023  # called in this round
        viewer.show_picture(FRAME)
        text = page_of(viewer.port, "/board/live", "/target/board", "GuiImageMessage", "/gizmo")
        assert count > 1 or common.DRAWN_ANEW in page_of(viewer.port, common.DRAWN_ANEW)
        assert "v-guide" in text
    assert len(logged(caplog)) == 1 and "reloaded" in logged(caplog)[0]
    # What a person had captured and chosen is there again.
    assert vars(viewer.layers[0])["_pictures"]


def test_a_trials_page_that_breaks_is_drawn_anew(
    paper_camera: Camera, default_board: Board, fault: Fault, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the tab in which it broke; the trial goes on."""
    server, _ = start_server("127.0.0.1", free_port())
    plan, target = plan_of("Anna", []), Pose.from_vector([0, 0, 0, 0, 0, 0.5])
    trial = Trial(default_board, paper_camera, plan, (target,), lambda _: None)
    pictures, stop = TrialPictures(), threading.Event()
    trials = trial_server(server, trial, pictures)
    pictures.put(FRAME)

    def run() -> None:
        while not stop.wait(0.02):
            trial.observe(Observation.nothing(paper_camera.image_size))
            trials.step()

    loop = threading.Thread(target=run)
    loop.start()
    try:
        with RawClient(server.get_port()) as tab:
            tab.look()
            wait_until(lambda: trials.tabs and trials.tabs[0].shown)
            before = trials.tabs[0].page
            fault.before(TrialPage, "show", monkeypatch)
            fault.due, came = 1, ""
            wait_until(lambda: trials.tabs[0].page is not before)
            while not all(text in came for text in ("GuiImageMessage", common.DRAWN_ANEW)):
                came += str(tab.window(timeout=20))
            assert loop.is_alive()
    finally:
        stop.set()
        loop.join(timeout=10)
        trials.close()
        server.stop()


def test_a_page_that_cannot_be_drawn_anew_is_tried_again(
    viewer: Viewer,
    guided: Snapshot,
    fault: Fault,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """A page between two servers would look alive and stand still for ever."""
    import venus3d.scene.pages.guide.viewer as module

    again = Fault()
    fault.before(module, "describe", monkeypatch)
    again.before(module, "SceneView", monkeypatch)
    before, fault.due, again.due = viewer.server, 1, 1
    viewer.show(guided)
    wait_until(lambda: again.raised == 1 and viewer.server is not before)
    page_of(viewer.port, "/board/live", common.DRAWN_ANEW)
    assert len(logged(caplog)) == 2


def test_two_pages_that_break_at_once_leave_the_terminal_alone(
    viewer: Viewer, guided: Snapshot, fault: Fault, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both silence viser meanwhile; what the program prints must come out all the same."""
    import venus3d.scene.pages.audience.audience as other
    import venus3d.scene.pages.guide.viewer as module

    theirs = Fault()
    fault.before(module, "describe", monkeypatch)
    theirs.before(other, "view_model_of", monkeypatch)
    audience, stdout = Audience("127.0.0.1", free_port()), sys.stdout
    try:
        before, fault.due, theirs.due = (viewer.server, audience.server), 1, 1
        viewer.show(guided), audience.show(guided)
        wait_until(lambda: viewer.server is not before[0] and audience.server is not before[1])
        assert sys.stdout is stdout and not rich.get_console().quiet
    finally:
        audience.close()


def test_a_page_that_is_closed_while_it_is_drawn_anew_leaves_no_server(
    viewer: Viewer, guided: Snapshot, fault: Fault, monkeypatch: pytest.MonkeyPatch
) -> None:
    import venus3d.scene.pages.guide.viewer as module
    import venus3d.scene.web.page as base

    closing = threading.Thread(target=viewer.close)
    real = base.serve_anew

    def slow(*given: Any) -> Any:
        closing.start()
        viewer.wait(30)  # until it is being closed
        return real(*given)

    monkeypatch.setattr(base, "serve_anew", slow)
    fault.before(module, "describe", monkeypatch)
    fault.due = 1
    viewer.show(guided)
    wait_until(lambda: closing.ident is not None and not closing.is_alive())
    with pytest.raises(OSError):
        RawClient(viewer.port)


@pytest.mark.slow
def test_a_page_that_always_breaks_is_tried_less_and_less_often(
    viewer: Viewer,
    guided: Snapshot,
    fault: Fault,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    import venus3d.scene.pages.guide.viewer as module

    fault.before(module, "describe", monkeypatch)
    fault.due = 10**9
    end = time.monotonic() + 5.0
    while time.monotonic() < end:
        viewer.show(guided)
        viewer.show_picture(FRAME)
        time.sleep(0.01)
    assert 2 <= fault.raised <= 4  # at once, after 1 s, after 2 s more
    assert len(logged(caplog)) == 1
    fault.due = 0
    page_of(viewer.port, "/board/live")


def test_what_the_page_was_given_by_others_is_there_again(
    viewer: Viewer, guided: Snapshot, fault: Fault, monkeypatch: pytest.MonkeyPatch
) -> None:
    import venus3d.scene.pages.guide.viewer as module

    viewer.extend(lambda server: [server.gui.add_checkbox("an addition", True)][:0])
    fault.before(module, "describe", monkeypatch)
    before, fault.due = viewer.server, 1
    viewer.show(guided)
    wait_until(lambda: viewer.server is not before)
    page_of(viewer.port, "an addition")


def test_pictures_of_steps_that_fail_leave_the_page_alone(
    guided: Snapshot, painter: Offscreen, caplog: pytest.LogCaptureFixture
) -> None:
    class Broken(Projections):
        def of_step(self, *args: Any, **options: Any) -> Any:
            failed = Future[Any]()
            failed.set_exception(ZeroDivisionError())
            return failed

    viewer = Viewer(port=free_port(), projections=Broken(painter))
    try:
        server = viewer.server
        viewer.show(guided)
        page_of(viewer.port, "/board/live", TILE_FAILED.split(";")[0])
        assert viewer.server is server
        assert len(logged(caplog)) == 1 and "four steps" in logged(caplog)[0]
    finally:
        viewer.close()


def test_a_teaching_page_that_breaks_is_drawn_anew(
    paper_camera: Camera, default_board: Board, painter: Offscreen, fault: Fault
) -> None:
    study = PoseAnalysis(paper_camera, default_board)

    def faulty(vector: Vector, order: str) -> TaughtPose:
        fault()
        return study(vector, order)

    with (
        served_teaching(faulty, painter) as teach,
        RawClient(teach.port) as tab,
        RawClient(teach.port) as other,
    ):
        came = ""
        tab.look(), other.look()
        while "/target/board" not in came or "GuiImageMessage" not in came:
            came += str(tab.window(timeout=20))
        left_alone, came = teach.page(1), ""
        fault.due = 1
        teach.change(lambda state: state.with_vector((10.0, 20.0, 30.0, 0.0, 0.0, 400.0)))
        wait_until(lambda: fault.raised == 1)
        wanted = common.DRAWN_ANEW, "/target/board", "GuiImageMessage"
        while not all(part in came for part in wanted):
            came += str((tab, other)[teach.server.tabs[0].client.client_id].window(timeout=20))
        assert teach.state.vector[1] == 20.0
        assert teach.page(1) is left_alone


def test_a_second_page_that_breaks_is_drawn_anew_and_the_operator_is_told(
    guided: Snapshot, fault: Fault, monkeypatch: pytest.MonkeyPatch
) -> None:
    import venus3d.scene.pages.audience.audience as module

    fault.before(module, "view_model_of", monkeypatch)
    audience, told = Audience("127.0.0.1", free_port()), list[str]()
    audience.on_failure = told.append
    try:
        before, fault.due = audience.server, 1
        audience.show(guided)
        wait_until(lambda: audience.server is not before)
        audience.show(guided)
        page_of(audience.port, "v-is-step")
        assert len(told) == 1 and "Nothing is lost" in told[0]
    finally:
        audience.close()


def test_a_trainees_page_that_breaks_is_drawn_anew_and_leaves_the_others_alone(
    paper_camera: Camera,
    default_board: Board,
    painter: Offscreen,
    fault: Fault,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    server, _ = start_server("127.0.0.1", free_port())
    settings = PracticeSettings.of(paper_camera, default_board, 0, "practice.csv")
    practice = PracticeServer(
        server, settings, ExerciseFile(tmp_path / "practice.csv", "practice"), painter
    )
    loop = threading.Thread(target=practice.run)
    loop.start()
    real = PracticePage.show

    def faulty(page: PracticePage, view: Any) -> None:
        if page is practice.tabs[0].page:
            fault()
        real(page, view)

    try:
        with RawClient(server.get_port()) as one, RawClient(server.get_port()) as other:
            one.look(), other.look()
            wait_until(lambda: len(practice.tabs) == 2 and all(t.shown for t in practice.tabs))
            first, second = practice.tabs
            pages, trainee = (first.page, second.page), first.model
            assert isinstance(trainee, Practice)
            monkeypatch.setattr(PracticePage, "show", faulty)
            trainee.name = "Anna"
            fault.due = 1
            first.shown = None  # to be drawn again
            wait_until(lambda: first.page is not pages[0] and first.shown is not None)
            assert second.page is pages[1] and trainee.name == "Anna"
            tab, came = (one, other)[first.client.client_id], ""  # numbered as they came
            while common.DRAWN_ANEW_WHY.split("(")[0] not in came or "/board/live" not in came:
                came += str(tab.window(timeout=20))
            # At once again: it stands still and says so, and the others go on.
            fault.due, first.shown = 1, None
            while common.TAB_BROKEN not in came:
                came += str(tab.window(timeout=20))
            assert practice.tabs == (second,) and loop.is_alive()
    finally:
        practice.close()
        loop.join(timeout=10)
        server.stop()


@pytest.fixture(autouse=True)
def _told(caplog: pytest.LogCaptureFixture) -> None:  # pyright: ignore[reportUnusedFunction]
    caplog.set_level(logging.ERROR, logger="venus3d")


def test_a_click_that_raises_is_logged_once_and_its_tab_is_told(
    fault: Fault, caplog: pytest.LogCaptureFixture
) -> None:
    """viser printed each traceback, and nobody at the page knew."""
    server, _ = start_server("127.0.0.1", free_port())
    try:
        button = server.gui.add_button("b")
        button.on_click(fault)
        fault.due = 2
        with RawClient(server.get_port()) as tab:
            tab.backlog()
            tab.look()
            wait_until(server.get_clients)
            for _ in range(3):
                click = {"uuid": button._impl.uuid, "updates": {"value": True}}
                tab.send({"type": "GuiUpdateMessage", **click})
            came = ""
            while came.count(common.ACTION_FAILED) < 2:
                came += str(tab.window(timeout=20))
        assert "RuntimeError" in came and fault.raised == 2
        assert len(logged(caplog)) == 1
    finally:
        server.stop()


def test_what_raises_on_visers_loop_is_logged_once(
    fault: Fault, caplog: pytest.LogCaptureFixture
) -> None:
    """asyncio printed a traceback for each message."""
    server, _ = start_server("127.0.0.1", free_port())
    done = list[Any]()

    async def clicked(event: Any) -> None:
        done.append(event)
        fault(event)

    try:
        button = server.gui.add_button("b")
        button.on_click(clicked)
        fault.due = 2
        with RawClient(server.get_port()) as tab:
            tab.backlog()
            tab.look()
            wait_until(server.get_clients)
            for _ in range(3):
                click = {"uuid": button._impl.uuid, "updates": {"value": True}}
                tab.send({"type": "GuiUpdateMessage", **click})
            wait_until(lambda: len(done) == 3 and logged(caplog))
        assert fault.raised == 2 and len(logged(caplog)) == 1
    finally:
        server.stop()
