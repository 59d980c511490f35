"""Screenshots of every page in a real browser, and docs/gallery.md that shows them: `make gallery`.

Each shot starts the program as a person would, opens the page, presses keys, waits until the page
says what it should, and takes the picture. Nothing is retouched.

    python scripts/gallery.py [--only NAME ...]
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_ROOT = Path(__file__).resolve().parent.parent
_FOLDER = _ROOT / "docs" / "gallery"
_FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
_PATIENCE_MS = 120_000
_SETTLE_MS = 3_000  # software rendering: textures and flights of the camera take their time


@dataclass(frozen=True)
class Shot:
    """One picture of the gallery."""

    name: str
    caption: str
    command: tuple[str, ...]
    """Arguments of venus3d."""
    do: Callable[[Any], None] = lambda page: None
    """What is done on the page before the picture is taken."""
    size: tuple[int, int] = (1920, 1080)
    ready: str = ""
    """What the page has to say in the moment of the picture: most of them move by themselves."""
    address: str = r"(?:Viewer|Lessons|Practice): (http://\S+)"
    """Which of the printed addresses is opened."""


def press(page: Any, *keys: str) -> None:
    """Press keys, one after the other."""
    for key in keys:
        page.keyboard.press(key)
        page.wait_for_timeout(700)


def says(page: Any, text: str) -> None:
    """Wait until the page says this."""
    page.wait_for_function(
        "text => document.body.innerText.includes(text)", arg=text, timeout=_PATIENCE_MS
    )


def guided(page: Any, views: int = 3, *keys: str, stops: bool = True) -> None:
    """Wait until so many views are captured and the next target is shown, let the hand stop on its
    way there, and press keys."""
    page.wait_for_function(
        r"n => Number(/(\d+)\s+views? captured/.exec(document.body.innerText)?.[1]) >= n",
        arg=views,
        timeout=_PATIENCE_MS,
    )
    says(page, "Step ")
    page.wait_for_timeout(_SETTLE_MS // 2)
    page.wait_for_function("() => !document.body.innerText.includes('Board not seen')")
    press(page, *(["Shift+P"] if stops else []), *keys)


def at_rest(page: Any, ready: str) -> None:
    """Wait until the page says this and the flash of a captured view is over."""
    page.wait_for_function(
        """ready => document.body.innerText.includes(ready) && document.getAnimations().every(
            playing => !(playing.animationName ?? "").startsWith("v-flash"))""",
        arg=ready,
        timeout=_PATIENCE_MS,
    )


def last_capture(page: Any) -> str:
    """A mark that changes with each capture."""
    return page.evaluate("document.querySelector('.v-captured')?.dataset.turn ?? ''")


def known(page: Any) -> None:
    """Open what is known, its maps and the captured views."""
    page.get_by_role("tab", name="What is known").click()
    press(page, "Shift+V")


def searched(page: Any) -> None:
    """Open what is known, and the poses that the search has looked at."""
    page.get_by_role("tab", name="What is known").click()
    press(page, "Shift+G")


_PORT = "8460"
_GUIDE = ("guide", "sim", "--autopilot", "--no-tour", "--port", _PORT)
# A slow hand, so that the dial still shows something to do.
_AUDIENCE = (*_GUIDE, "--speed", "0.4", "--audience", "8461")
_SECOND = r"Second monitor: (http://\S+)"
_TEACH = ("teach", "--port", _PORT)
_STILL_MS = 20_000  # until the simulated hand is on its way to a later target


def later(page: Any) -> None:
    """Some pictures later: the audience's page has no keys, so there is only waiting."""
    page.wait_for_timeout(_STILL_MS)


SHOTS: tuple[Shot, ...] = (
    Shot("guide", "Guide: the step to do now", _GUIDE, guided, ready="to go"),
    Shot(
        "guide-light",
        "Guide in a bright room",
        _GUIDE,
        lambda page: guided(page, 3, "b"),
        ready="to go",
    ),
    Shot(
        "guide-strip",
        "Guide: the steps side by side",
        _GUIDE,
        lambda page: guided(page, 3, "t"),
        ready="to go",
    ),
    Shot(
        "loop",
        "Guide: the loop of the method above the page, for a class",
        (*_GUIDE, "--explain"),
        guided,
        ready="to go",
    ),
    Shot(
        "done",
        "Guide: the end, the camera's figures to copy",
        (*_GUIDE, "--speed", "2"),
        lambda page: says(page, "Saved:"),
        ready="Field of view",
    ),
    Shot(
        "uncertainty",
        "Where in the image the camera is known, now and after the next view",
        _GUIDE,
        lambda page: guided(page, 3) or known(page),
        ready="to go",
    ),
    Shot(
        "guide-fisheye",
        "Guide with a fisheye lens of 190°",
        (*_GUIDE, "--sim.camera", "fisheye"),
        guided,
        ready="to go",
    ),
    Shot(
        "guide-chessboard",
        "Guide with a plain chessboard",
        (*_GUIDE, "--board.kind", "chessboard", "--board.columns", "10", "--board.rows", "7"),
        guided,
        ready="to go",
    ),
    Shot(
        "search",
        "The search for the next pose: all poses looked at",
        _GUIDE,
        lambda page: guided(page, 3) or searched(page),
        ready="a dot is a pose looked at",
    ),
    Shot(
        "teach",
        "Teach: a lesson, the steps in place",
        (*_TEACH, "what-a-pose-is"),
        lambda page: press(page, *["PageDown"] * 3, "p"),
    ),
    Shot(
        "teach-strip",
        "Teach: the four steps side by side",
        (*_TEACH, "what-a-pose-is"),
        lambda page: press(page, *["PageDown"] * 3, "t"),
    ),
    Shot(
        "teach-own-axes",
        "Teach: the camera's axes and the board's own",
        (*_TEACH, "whose-axes"),
        lambda page: press(page, "PageDown"),
    ),
    Shot(
        "teach-tilt",
        "Teach: why tilted boards calibrate",
        (*_TEACH, "why-tilted-boards"),
        lambda page: press(page, *["PageDown"] * 2),
    ),
    Shot("practice", "Practice: your own board", ("practice", "--port", _PORT)),
    Shot(
        "practice-outline",
        "Practice with six degrees of freedom and an outline",
        ("practice", "--port", _PORT),
        lambda page: press(page, "6", "Shift+H", "Shift+H"),
    ),
    Shot("audience", "The second monitor", _AUDIENCE, later, ready="to go", address=_SECOND),
    Shot(
        "audience-light",
        "The second monitor in a bright room",
        (*_AUDIENCE, "--audience-light"),
        later,
        ready="to go",
        address=_SECOND,
    ),
    Shot(
        "audience-unmirrored",
        "The second monitor for a class: the picture as the camera sees it",
        (*_AUDIENCE, "--no-audience-mirror"),
        later,
        ready="to go",
        address=_SECOND,
    ),
    Shot(
        "through-the-lens",
        "Through the lens: the steps over the live picture",
        (*_AUDIENCE, "--audience-view", "lens"),
        later,
        ready="to go",
        address=_SECOND,
    ),
    # Most panels are folded there, so there is nothing to count.
    Shot("phone", "Guide on a phone", _GUIDE, size=(420, 860), ready="to go"),
)


@contextmanager
def running(command: tuple[str, ...], address: str) -> Iterator[str]:
    """The program, and the page's address."""
    with tempfile.TemporaryDirectory() as folder:
        program = subprocess.Popen(
            [sys.executable, "-m", "venus3d", *command],
            cwd=folder,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        try:
            assert program.stdout is not None
            lines = (re.search(address, line) for line in program.stdout)
            url = next((found.group(1) for found in lines if found), None)
            if url is None:
                sys.exit(f"venus3d {' '.join(command)} ended before its page was up.")
            yield url
        finally:
            program.terminate()
            program.wait(timeout=30)


def take(browser: Any, shot: Shot) -> Path:
    """Take one picture."""
    with running(shot.command, shot.address) as url:
        width, height = shot.size
        page = browser.new_page(viewport={"width": width, "height": height})
        page.set_default_timeout(_PATIENCE_MS)
        page.goto(url)
        page.wait_for_selector("canvas")
        page.wait_for_timeout(2 * _SETTLE_MS)
        for notice in page.locator(".mantine-Notification-root button:visible").all():
            notice.click()  # the browser's word on its software renderer
        shot.do(page)
        page.wait_for_timeout(_SETTLE_MS)
        path = _FOLDER / f"{shot.name}.jpg"
        before, still = None, False
        while before != (before := last_capture(page)) or not still:
            at_rest(page, shot.ready)
            page.screenshot(path=path, type="jpeg", quality=88)
            still = shot.ready in page.inner_text("body")  # a picture takes its time
        page.close()
    return path


def written(shots: tuple[Shot, ...]) -> str:
    """The page of the documentation."""
    lines = ["# Gallery", "", "Made by `make gallery` from the real pages in a real browser.", ""]
    for shot in shots:
        if not (_FOLDER / f"{shot.name}.jpg").is_file():
            continue
        command = " ".join(("venus3d", *shot.command))
        lines += [f"## {shot.caption}", "", f"`{command}`", ""]
        lines += [f"![{shot.caption}](gallery/{shot.name}.jpg)", ""]
    return "\n".join(lines)


def main() -> None:
    """Take the pictures and write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--only", nargs="*", default=[shot.name for shot in SHOTS])
    only = parser.parse_args().only
    from playwright.sync_api import sync_playwright

    names = ("chromium", "chromium-browser", "google-chrome")
    path = next((found for name in names if (found := shutil.which(name))), None)
    if path is None:
        sys.exit("No Chromium on this machine: install the package 'chromium'.")
    _FOLDER.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(_FLAGS))
        for shot in SHOTS:
            if shot.name in only:
                print(f"Written: {take(browser, shot).relative_to(_ROOT)}", flush=True)
        browser.close()
    (_ROOT / "docs" / "gallery.md").write_text(written(SHOTS), encoding="utf-8")


if __name__ == "__main__":
    main()
