"""The keys of our commands, as a page has them and as Playwright presses them."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from playwright.sync_api import TimeoutError as PlaywrightTimeout

from venus3d.scene.web.help import SHIFT

_NAMES = {
    "space": "Space",
    "backspace": "Backspace",
    "end": "End",
    "escape": "Escape",
    "pageup": "PageUp",
    "pagedown": "PageDown",
}


def pressed(hotkey: str) -> str:
    """A command's key, for `keyboard.press`."""
    alone = hotkey.removeprefix(SHIFT)
    name = _NAMES.get(alone, alone.lower())
    return name if alone == hotkey else f"Shift+{name}"


def hotkeys(gui: Any) -> list[str | None]:
    """The keys of all commands, in the palette's order; None: by name only."""
    commands = gui._command_handle_from_uuid.values()
    return [c.hotkey and (SHIFT + c.hotkey if c.modifier else c.hotkey) for c in commands]


def press_until(page: Any, key: str, selector: str) -> None:
    """Press a key until what it opens is seen: viser's keys listen some time after its canvas is
    there, on a busy machine seconds."""
    for _ in range(6):
        page.keyboard.press(key)
        with suppress(PlaywrightTimeout):
            page.wait_for_selector(selector, timeout=10_000)
            return
    raise AssertionError(f"{key} opens no {selector}")
