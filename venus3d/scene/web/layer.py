"""A layer of a page's scene: shapes among the others, and a tab that tells of them.

The page knows nothing of what a layer is about, and the layer nothing of the page. For each moment
that is drawn the page calls `put` (shapes), `bind` (gestures on what was drawn), `show` (the tab),
and, when all that has been sent to the browsers, `show_late`.
"""

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
    """What a page may be given; it outlives the servers on which the page is laid out."""

    @property
    def title(self) -> str:
        """Of its tab."""
        ...

    @property
    def icon(self) -> Any:
        """Of its tab, one of viser's."""
        ...

    @property
    def commands(self) -> Sequence[Command]:
        """What can be asked for by key or name; the page adds them."""
        ...

    @property
    def is_moving(self) -> bool:
        """Whether it is to be drawn soon, though nothing comes in."""
        ...

    @property
    def caption(self) -> str:
        """What it shows in the scene now, in one line; empty if nothing is to be said."""
        ...

    def lay_out(self, gui: viser.GuiApi) -> None:
        """Make its widgets in the current panel, of a new server."""
        ...

    def keep_picture(self, number: int, image: LivePicture) -> None:
        """Take the picture (BGR or grey) of the captured view of this number."""
        ...

    def put(self, snapshot: Snapshot, shapes: tuple[Shape, ...], theme: Theme) -> tuple[Shape, ...]:
        """The scene's shapes with its own; it may take others away."""
        ...

    def bind(self, scene: SceneView) -> None:
        """Let what was drawn be clicked."""
        ...

    def show(self, snapshot: Snapshot, theme: Theme) -> None:
        """Bring its tab up to date."""
        ...

    def show_late(self, snapshot: Snapshot, theme: Theme) -> None:
        """The same for what takes longer, once the scene has been sent."""
        ...
