"""The handle for dragging a board in space."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from venus3d.engine.geometry.pose import Pose
from venus3d.render.arrows import handle_shapes
from venus3d.render.shapes import MeshShape
from venus3d.scene.web.scene_view import Host

_SCALE = 0.16


class BoardGizmo:
    """Follows the board until somebody drags it; then the board follows it."""

    def __init__(self, host: Host, dragged: Callable[[Pose], None]) -> None:
        """`dragged` is called with `T_camera_board`, in order, and must not block."""
        self._held = False
        self._pose: Pose | None = None
        self._handle = host.scene.add_transform_controls(
            "/gizmo",
            scale=_SCALE,
            depth_test=False,
            opacity=0.0,  # its colours are not the steps': `shapes` are seen in its place
            disable_sliders=True,
            position=(0.0, 0.0, 0.5),
        )

        # Async, so that viser keeps the events of a drag in order.
        @self._handle.on_update
        async def _(event: Any) -> None:  # pyright: ignore[reportUnusedFunction]
            self._held = event.phase != "end"
            dragged(Pose.from_wxyz(event.target.wxyz, event.target.position))

    @property
    def is_held(self) -> bool:
        """Whether somebody is dragging it."""
        return self._held

    def follow(self, pose: Pose | None, *, shown: bool) -> None:
        """Go to the board, unless somebody holds the gizmo or the board is not seen. Hidden while
        the autopilot moves the board: it would cover the arrows."""
        self._handle.visible, self._pose = shown, pose
        if pose is not None and not self._held:
            self._handle.wxyz, self._handle.position = pose.wxyz, pose.t

    def shapes(self, *, dark: bool) -> tuple[MeshShape, ...]:
        """What is seen of it, in the colours of the steps that turn about its axes."""
        if self._pose is None or not self._handle.visible:
            return ()
        arrows, arcs = not self._handle.disable_axes, not self._handle.disable_rotations
        return handle_shapes(self._pose, _SCALE, arrows=arrows, arcs=arcs, dark=dark)

    def offer(self, free: Sequence[bool]) -> None:
        """Show only the handles of the free ones of xr, yr, zr, xt, yt, zt."""
        self._handle.disable_rotations = not any(free[:3])
        self._handle.disable_axes = not any(free[3:])
