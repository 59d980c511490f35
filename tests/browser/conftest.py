"""One Chromium for all browser tests, and a viewer with real snapshots for each."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import sync_playwright

from tests.ports import free_port
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.guide.viewer import Viewer

_GL = {
    # Mesa's software renderer takes half the processor time of Chromium's own.
    "mesa": ("--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist"),
    "swiftshader": ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
}
_FLAGS = ("--no-sandbox", "--disable-gpu-compositing")
_HAS_GL = "() => document.createElement('canvas').getContext('webgl2') !== null"


class Program:
    """A command of ours that serves a page, in a process of its own."""

    def __init__(self, *arguments: str) -> None:
        """Run `venus3d` with these arguments until it says its page's address."""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "venus3d", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if found := re.search(r"http://\S+", line):
                self.url = found.group()
                return
        raise AssertionError(self.process.communicate()[1])

    def end(self) -> tuple[str, str]:
        """Ctrl-C; what it said on both streams."""
        self.process.send_signal(signal.SIGINT)
        return self.process.communicate(timeout=60)

    def kill(self) -> None:
        """Without a chance to say or keep anything."""
        self.process.kill()
        self.process.wait()


@pytest.fixture
def start() -> Iterator[Callable[..., Program]]:
    """Starts programs; none outlives the test."""
    started: list[Program] = []

    def start_one(*arguments: str) -> Program:
        started.append(Program(*arguments))
        return started[-1]

    yield start_one
    for program in started:
        program.kill()


_SLOW = """
window.requestAnimationFrame = draw => setTimeout(() => draw(performance.now()), 60);
window.cancelAnimationFrame = clearTimeout;
"""


class SlowScreen:
    """A browser whose pages have half the pixels each way and are drawn 16 times a second, which
    halves its work. For all who do not look at the picture; places and sizes are in CSS pixels."""

    def __init__(self, browser: Any) -> None:
        """Pages and contexts are the browser's own."""
        self.browser = browser

    def new_page(self, **options: Any) -> Any:
        """As Playwright's."""
        return self._slow(self.browser.new_page(**{"device_scale_factor": 0.5, **options}))

    def new_context(self, **options: Any) -> Any:
        """As Playwright's."""
        return self._slow(self.browser.new_context(**{"device_scale_factor": 0.5, **options}))

    @staticmethod
    def _slow(opened: Any) -> Any:
        opened.add_init_script(_SLOW)
        return opened


@pytest.fixture(scope="session")
def chromium(sharp_chromium: Any) -> SlowScreen:
    """A browser for what is written and pressed on a page."""
    return SlowScreen(sharp_chromium)


@pytest.fixture(scope="session")
def sharp_chromium() -> Iterator[Any]:
    """A browser without a window, for whoever looks at its picture."""
    names = ("chromium", "chromium-browser", "google-chrome")
    path = next((found for name in names if (found := shutil.which(name))), None)
    if path is None:
        pytest.skip("no Chromium on this machine; install the package 'chromium'")
    with sync_playwright() as playwright:
        browser = _launched(playwright, path, "mesa") or _launched(playwright, path, "swiftshader")
        assert browser is not None, "Chromium draws no WebGL on this machine"
        yield browser
        browser.close()


def _launched(playwright: Any, path: str, gl: str) -> Any:
    """A browser that draws WebGL in this way; None if it cannot."""
    browser = playwright.chromium.launch(executable_path=path, args=[*_FLAGS, *_GL[gl]])
    page = browser.new_page()
    if page.evaluate(_HAS_GL):
        page.close()
        return browser
    browser.close()
    return None


@pytest.fixture(scope="session")
def projections() -> Iterator[Projections]:
    """The painter's projections: no test here asks about OpenGL."""
    offscreen = Offscreen("painter")
    yield Projections(offscreen)
    offscreen.close()


@pytest.fixture
def viewer(projections: Projections) -> Iterator[Viewer]:
    """A dark page on a free port, with a draggable board."""
    page = Viewer(port=free_port(), projections=projections, draggable_board=True)
    yield page
    page.close()


@pytest.fixture
def open_page(chromium: Any, viewer: Viewer) -> Iterator[Callable[[], Any]]:
    """Opens a tab on the viewer and waits for the guidance text."""
    pages: list[Any] = []

    def opened() -> Any:
        page = chromium.new_page(viewport={"width": 1280, "height": 720})
        pages.append(page)
        page.set_default_timeout(60_000)
        page.goto(viewer.url)
        page.wait_for_selector(".v-guide")
        return page

    yield opened
    for page in pages:
        page.close()


@pytest.fixture(scope="session")
def guiding(paper_camera: Camera, default_board: Board) -> Snapshot:
    """A session after its first view, the board on step 3 of the way to its second."""
    noise = np.random.default_rng(3)
    session = Session(default_board, paper_camera.image_size)

    def look(pose: Pose) -> Snapshot:
        pixels = paper_camera.project(pose.apply(default_board.corners))
        pixels = pixels + noise.normal(0, 0.2, pixels.shape)
        inside = ((pixels > 0) & (pixels < [1279, 719])).all(axis=1)
        ids = np.flatnonzero(inside)
        return session.observe(Observation(ids, pixels[inside], paper_camera.image_size))

    for distance in (0.45, 0.5, 0.55):
        look(Pose.from_vector([30, 5, 0, 0, 0, distance]))
    assert session.capture() or session.phase != "startup"
    session.run_pending()
    target = session.snapshot().target
    assert target is not None
    steps = target.steps
    return look(steps[1].after.turned("y", 0.2 * steps[2].angle_deg))
