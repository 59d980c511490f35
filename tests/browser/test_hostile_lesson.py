"""A lesson from a stranger, opened live and exported: it neither runs nor loads anything.

Once `<iframe srcdoc="<script>...">` in a lesson's text ran in the page's own origin.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from tests.browser.conftest import Program
from tests.ports import free_port
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.reading import read_lesson
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.teach.export.files import export_files
from venus3d.scene.pages.teach.view_model import PoseAnalysis

pytestmark = [pytest.mark.browser, pytest.mark.slow]

_MARK = "top.__ran=1;alert(1)"
_HOSTILE = (
    f'<iframe srcdoc="<script>{_MARK}</script>"></iframe>',
    f'<img src=x onerror="{_MARK}">',
    f'<svg onload="{_MARK}"></svg>',
    f"<script>{_MARK}</script>",
    "<style>body{background:url(https://x.invalid/css)}</style>",
    f"[link](javascript:{_MARK})",
    f"{{{_MARK}}}",
    '<img src="https://x.invalid/a.png"> ![b](https://x.invalid/b.png)',
    '<link rel=stylesheet href="https://x.invalid/c.css"><meta http-equiv=refresh content="0;/x">',
)
_LINE, _TEXT = " ".join(_HOSTILE), "\n\n".join(_HOSTILE)
_SEEN = f'<iframe srcdoc="<script>{_MARK}</script>"></iframe>'
_LESSON = f"""
title = '''title {_LINE}'''
summary = '''summary {_LINE}'''
[[page]]
title = '''page {_LINE}'''
text = '''{_TEXT}'''
pose = [0, 0, 0, 0, 0, 500]
[page.question]
text = '''question {_LINE}'''
answers = ['''one {_LINE}''', '''two {_LINE}''']
right = 2
why = '''why {_LINE}'''
"""
# Each way in that is left when something has been written into the page after all.
_INJECT = """async ([mark, outside]) => {
  const refused = new Set();
  addEventListener('securitypolicyviolation', event => refused.add(event.effectiveDirective));
  document.body.insertAdjacentHTML('beforeend',
    `<img src="data:," onerror="${mark}"><img src="${outside}a.png">` +
    `<iframe srcdoc="<script>${mark}</` + `script>"></iframe>` +
    `<link rel=stylesheet href="${outside}a.css"><base href="${outside}">`);
  const script = document.createElement('script');
  script.textContent = mark;
  document.body.append(script);
  await fetch(outside, {mode: 'no-cors'}).catch(() => null);
  await new Promise(go => setTimeout(go, 1000));
  return [...refused];
}"""


class Watched:
    """A tab, and what it did that it should not."""

    def __init__(self, browser: Any, address: str) -> None:
        """Open the address, and nothing else."""
        self.tab = browser.new_page(viewport={"width": 1280, "height": 720})
        self.wrong: list[str] = []
        own = (address, "data:", "blob:")
        self.tab.on("dialog", self._spoke)
        self.tab.on("request", lambda r: r.url.startswith(own) or self.wrong.append(r.url))
        self.tab.set_default_timeout(60_000)
        self.tab.goto(address)

    def _spoke(self, dialog: Any) -> None:
        self.wrong.append(f"said: {dialog.message}")
        dialog.dismiss()

    def check(self) -> None:
        """Nothing ran in any frame, and nothing was asked for outside."""
        self.tab.wait_for_timeout(1000)
        assert self.tab.evaluate("window.__ran ?? null") is None
        assert self.wrong == []


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("lesson") / "hostile.toml"
    file.write_text(_LESSON, "utf-8")
    return file


@pytest.fixture(scope="module")
def exported_page(file: Path, paper_camera: Camera, default_board: Board) -> Path:
    with Offscreen("painter") as offscreen:
        study = PoseAnalysis(paper_camera, default_board)
        (content,) = export_files(read_lesson(file), "html", study, offscreen)
    page = file.with_suffix(".html")
    page.write_bytes(content)
    return page


@pytest.fixture
def export(chromium: Any, exported_page: Path) -> Iterator[Watched]:
    """The hostile lesson as a web page, opened from the disk."""
    watched = Watched(chromium, exported_page.as_uri())
    watched.tab.query_selector("#scene").content_frame().wait_for_selector("canvas")
    yield watched
    watched.tab.close()


@pytest.fixture
def outside() -> Iterator[tuple[str, list[str]]]:
    """The address of a server that a page has nothing to do with, and what it was asked for."""
    asked_for: list[str] = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked_for.append(self.path)
            self.send_error(404)

        def log_message(self, format: str, *args: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/", asked_for
        server.shutdown()


def test_a_hostile_lesson_is_only_text_in_the_live_page(
    chromium: Any, file: Path, start: Callable[..., Program]
) -> None:
    address = start("teach", str(file), "--port", str(free_port())).url
    watched = Watched(chromium, address)
    tab = watched.tab
    tab.wait_for_selector(".v-lesson >> text=page")
    tab.click("button:has-text('one')")
    tab.wait_for_selector(".v-refused >> text=why")
    for place in (".v-lesson h2", ".v-lesson .v-text", ".v-question", "button:has-text('two')"):
        assert _SEEN in tab.inner_text(place), place
    assert tab.locator(".v-lesson").locator("img, iframe, svg, script, style, link").count() == 0
    tab.click(".v-text >> text=link")
    watched.check()


def test_a_hostile_lesson_is_only_text_in_the_export(export: Watched) -> None:
    tab = export.tab
    tab.click("button:has-text('one')")
    for place in ("h1", "header p", "h2", ".v-text", ".question p >> nth=0", "[data-verdict='0']"):
        assert _SEEN in tab.inner_text(place), place
    assert tab.title().startswith("title <iframe")
    tab.click(".v-text >> text=link")
    export.check()


def test_what_got_into_an_export_after_all_neither_runs_nor_loads(
    export: Watched, outside: tuple[str, list[str]]
) -> None:
    address, asked_for = outside
    refused = export.tab.evaluate(_INJECT, [_MARK, address])
    expected = {"script-src-attr", "script-src-elem", "connect-src", "img-src", "base-uri"}
    assert expected | {"style-src-elem"} <= set(refused)
    assert export.tab.evaluate("window.__ran ?? null") is None
    assert asked_for == []
    assert not any(what.startswith("said") for what in export.wrong)
