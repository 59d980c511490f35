"""A layer of a page's scene: its own shapes, and a tab about them. Page and layer know nothing of
each other's contents. For each moment drawn the page calls `put` (shapes), `bind` (gestures on what
was drawn), `show` (the tab) and, once everything has been sent to the browsers, `show_late`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import viser

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import LivePicture
from venus3d.render.shapes import Shape
from venus3d.scene.web.help import Command
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.theme import Theme


class Layer(Protocol):
    """A layer; it outlives the servers on which the page is laid out."""

    @property
    def title(self) -> str:
        """Title of its tab."""
        ...

    @property
    def icon(self) -> Any:
        """Icon of its tab, one of viser's."""
        ...

    @property
    def commands(self) -> Sequence[Command]:
        """Its commands, which the page adds."""
        ...

    @property
    def is_moving(self) -> bool:
        """Whether it must be redrawn soon without new input."""
        ...

    @property
    def caption(self) -> str:
        """One line on what it shows in the scene; empty for none."""
        ...

    def lay_out(self, gui: viser.GuiApi) -> None:
        """Create its widgets in the current panel of a new server."""
        ...

    def keep_picture(self, number: int, image: LivePicture) -> None:
        """Take the picture (BGR or grey) of the captured view of this number."""
        ...

    def put(self, snapshot: Snapshot, shapes: tuple[Shape, ...], theme: Theme) -> tuple[Shape, ...]:
        """The scene's shapes with its own; it may remove others."""
        ...

    def bind(self, scene: SceneView) -> None:
        """Make what was drawn clickable."""
        ...

    def show(self, snapshot: Snapshot, theme: Theme) -> None:
        """Update its tab."""
        ...

    def show_late(self, snapshot: Snapshot, theme: Theme) -> None:
        """Update the slow parts, once the scene has been sent."""
        ...
