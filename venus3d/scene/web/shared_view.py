"""The point of view that all tabs share.

What depends on it (arrows drawn over what hides them, labels that face the person) can be right for
one point only. Arrows also wait until it has come to rest, since the program hears of a movement
too late.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import viser

from venus3d.render.viewpoints import SceneCamera

_REST_S = 0.2
_SAME = 0.02
"""Tabs whose eyes are nearer than this, relative to the distance looked at, share a view."""


class SharedView:
    """Watches the cameras of a server's tabs, or of one tab. Read by one thread."""

    def __init__(
        self, host: viser.ViserServer | viser.ClientHandle, wake: Callable[[], None]
    ) -> None:
        """`wake` is called on viser's threads when a view begins to move."""
        self._host, self._wake = host, wake
        self._moved_at = -_REST_S
        self._seen: tuple[float, ...] = ()
        self._view: SceneCamera | None = None
        self.window_px = (1, 1)
        """Width and height of a tab's window."""
        if isinstance(host, viser.ClientHandle):
            self._come(host)
        else:
            host.on_client_connect(self._come)

    @property
    def at_rest(self) -> bool:
        """Whether no view has moved for a moment."""
        return time.monotonic() - self._moved_at > _REST_S

    def now(self) -> SceneCamera | None:
        """The view, the same object as long as it is the same; None without tabs, and if they look
        from different points."""
        host = self._host
        tabs = (host,) if isinstance(host, viser.ClientHandle) else host.get_clients().values()
        cameras = [tab.camera for tab in tabs]
        eyes = [(camera.position.copy(), camera.look_at.copy(), camera.fov) for camera in cameras]
        seen = tuple(float(v) for eye, at, fov in eyes for v in (*eye, *at, fov))
        if seen != self._seen:
            self._seen, self._view = seen, None
            eye, at, fov = eyes[0] if eyes else (np.zeros(3), np.zeros(3), 1.0)
            near = _SAME * float(np.linalg.norm(eye - at))
            if eyes and all(np.linalg.norm(other - eye) <= near for other, _, _ in eyes):
                self._view = SceneCamera(eye, at, fov)
        if cameras:
            self.window_px = (cameras[0].image_width, cameras[0].image_height)
        return self._view

    def _come(self, tab: viser.ClientHandle) -> None:
        async def moved(_: object) -> None:  # on the loop's thread, which may not wait
            self._moved_at = time.monotonic()
            self._wake()

        tab.camera.on_update(moved)
        self._wake()
