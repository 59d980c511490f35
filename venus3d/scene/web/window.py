"""What only a browser knows of its window, as it told it in cookies (window.js)."""

from __future__ import annotations

from contextlib import suppress
from http.cookies import CookieError, SimpleCookie

import viser

from venus3d.scene.web.viser_private import headers_of, server_of, sockets_of

_HEIGHT, _CALM = "venus3d-window-height", "venus3d-reduced-motion"


def window_height(client: viser.ClientHandle) -> int:
    """Of a tab's window, CSS pixels. Its camera tells the scene's height in pixels of the device,
    of which viser takes fewer when drawing is slow."""
    height = _cookie(client, _HEIGHT)
    return int(height) if is_height(height) else client.camera.image_height


def is_height(text: str) -> bool:
    """Whether this is a height as a browser tells it."""
    return text.isascii() and text.isdecimal() and len(text) < 6


def wants_less_motion(client: viser.ClientHandle) -> bool:
    """Whether the person has asked their system for less motion (prefers-reduced-motion)."""
    return _cookie(client, _CALM) == "1"


def _cookie(client: viser.ClientHandle, name: str) -> str:
    """Its value; empty if the browser sent none."""
    headers = headers_of(sockets_of(server_of(client)), client.client_id)
    for line in headers.get_all("cookie"):
        with suppress(CookieError):
            cookie = SimpleCookie(line).get(name)
            if cookie is not None:
                return cookie.value
    return ""
