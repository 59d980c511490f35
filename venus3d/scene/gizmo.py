"""The handle by which the simulated board is dragged."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from venus3d.engine.pose import Pose

_SCALE = 0.16


class BoardGizmo:
    """Follows the board until somebody drags it; then the board follows the gizmo."""

    def __init__(self, server: viser.ViserServer, dragged: Callable[[Pose], None]) -> None:
        """`dragged` is called with `T_camera_board`, in order, and must not block."""
        self._held = False
        self._handle = server.scene.add_transform_controls(
            "/gizmo",
            scale=_SCALE,
            depth_test=False,
            opacity=0.75,
            disable_sliders=True,
            position=(0.0, 0.0, 0.5),
        )

        # Async, so that viser keeps the order of one gesture's events.
        @self._handle.on_update
        async def _(event: Any) -> None:  # pyright: ignore[reportUnusedFunction]
            self._held = event.phase != "end"
            dragged(Pose.from_wxyz(event.target.wxyz, event.target.position))

    def follow(self, pose: Pose | None, *, shown: bool) -> None:
        """Go to where the board is, unless somebody holds the gizmo or the board is not seen.

        Hidden while the autopilot has the board: it would cover the arrows that matter.
        """
        self._handle.visible = shown
        if pose is not None and not self._held:
            self._handle.wxyz, self._handle.position = pose.wxyz, pose.t
