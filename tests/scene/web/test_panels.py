"""A panel is as wide as suits the window, in whichever pixels the scene is drawn."""

from __future__ import annotations

import pytest

from tests.scene.raw_client import RawClient
from tests.waiting import wait_until
from venus3d.scene.web.panels import fit_width
from venus3d.scene.web.server import LocalServer


@pytest.mark.parametrize(
    ("cookie", "height"),
    [
        ("other=1; venus3d-window-height=768", 768),
        ("venus3d-window-height=1e9", 1440),
        ("venus3d-window-height=123456789", 1440),
        ("", 1440),
    ],
)
def test_the_height_is_the_windows_in_css_pixels(
    server: LocalServer, cookie: str, height: int
) -> None:
    """A screen of two device pixels for one: the scene alone would tell twice the height. And on a
    slow machine viser draws fewer pixels after a while, at which the panel jumped."""
    seen: list[int] = []

    def width(told: int) -> int:
        seen.append(told)
        return 500

    fit_width(server, server.gui.main_panel, width)
    with RawClient(server.get_port(), cookie=cookie) as tab:
        tab.look(2000, 1440)
        wait_until(lambda: bool(seen), "the width was asked for")
        tab.look(1500, 1080)
        tab.look(2000, 1440)
        wait_until(
            lambda: next(iter(server.get_clients().values())).camera.image_width == 2000, "came"
        )
    assert seen == [height]


def test_the_width_is_fitted_again_when_the_window_was_resized(server: LocalServer) -> None:
    """The page writes the new height, and the time, into a field that is not seen."""
    seen: list[int] = []

    def width(told: int) -> int:
        seen.append(told)
        return 500

    fit_width(server, server.gui.main_panel, width)
    with RawClient(server.get_port(), cookie="venus3d-window-height=1080") as tab:
        tab.look(1920, 1080)
        field = next(m["uuid"] for m in tab.backlog() if m["type"] == "GuiTextMessage")
        wait_until(lambda: seen == [1080], "the width was asked for")
        for text in ("nonsense", "768 5312"):
            tab.send({"type": "GuiUpdateMessage", "uuid": field, "updates": {"value": text}})
        wait_until(lambda: 768 in seen, "the width was asked for again")
