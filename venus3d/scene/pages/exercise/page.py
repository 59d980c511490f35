"""Base of both exercises' pages: one tab's panels and scene, and their updates. One thread calls
`show` and `advance`; the pictures may come from another."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, Generic

import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Pose
from venus3d.scene.pages.exercise.exercise import View
from venus3d.scene.pages.exercise.view_model import Action, MoveBoard, Press, Request
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.gizmo import BoardGizmo
from venus3d.scene.web.help import Command, HelpOverlay, add_commands
from venus3d.scene.web.panels import PanelStyle
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.steady_framing import SteadyFraming
from venus3d.scene.web.theme import Theme

Picture = NDArray[np.uint8]
Job = Callable[[], None]
"""Draws one picture and delivers it."""
Ask = Callable[[Request], None]
"""Called on viser's threads with a person's request; only queues it."""


class ExercisePage(ABC, Generic[View]):
    """One tab. A subclass lays out the panels and shows a view on them."""

    def __init__(self, client: viser.ClientHandle, ask: Ask, view: View) -> None:
        """Lay everything out and show this view.

        Args:
            client: the tab.
            ask: called on viser's threads with each request; must not block.
        """
        self._client, self._gui, self._ask = client, client.gui, ask
        self._style = PanelStyle(client.gui)
        self._shown: View | None = None
        self._rig = CameraRig(client)
        self._scene = SceneView(client, arrived=lambda: self._rig.arrived)
        self._framing = SteadyFraming(self._rig)
        with client.atomic():
            self._lay_out(view)
            commands = (*self._commands(), self._rig.command)
            add_commands(client, commands)
            self._help = HelpOverlay(client, commands, dark=view.dark)
        self.show(view)

    @property
    def is_moving(self) -> bool:
        """Whether `advance` is due."""
        return self._rig.is_due or self._scene.is_due

    def advance(self) -> None:
        """Advance the tab's camera, and what faces it."""
        self._scene.refresh()  # before the eye moves
        self._rig.advance()

    def show(self, view: View) -> None:
        """Show one view on the page."""
        before, self._shown = self._shown, view
        theme = Theme(view.dark)
        with self._client.atomic():
            if self._style.show(theme):
                self._help.show(theme)
            self._put(view, before, theme)
        self._client.flush()
        self._look(view, before)

    @abstractmethod
    def pictures(self) -> Iterable[tuple[str, Job]]:
        """The pictures that are due, by name: those whose contents have changed."""

    def warn(self, text: str) -> None:
        """Report an error in a persistent note."""
        self._client.add_notification(self._title, text, color="red")

    @property
    @abstractmethod
    def _title(self) -> str:
        """Title of the page's notes."""

    @abstractmethod
    def _lay_out(self, view: View) -> None:
        """Lay out the panels, and add the movable parts of the scene."""

    @abstractmethod
    def _commands(self) -> tuple[Command, ...]:
        """The page's commands."""

    @abstractmethod
    def _put(self, view: View, before: View | None, theme: Theme) -> None:
        """Show one view on panels and scene, after `before`."""

    @abstractmethod
    def _look(self, view: View, before: View | None) -> None:
        """Turn the tab's camera where needed."""

    def _make_gizmo(self) -> BoardGizmo:
        return BoardGizmo(self._client, lambda pose: self._ask_to_move(pose, "gizmo"))

    def _ask_to_move(self, pose: Pose, by: Any) -> None:
        self._ask(MoveBoard(pose, by))

    def _make_picture(self, width: int, quality: int) -> Any:
        blank = np.full((width * 9 // 16, width, 3), 96, np.uint8)
        return self._gui.add_image(blank, format="jpeg", jpeg_quality=quality)


def press_commands(
    keys: Mapping[Action, str], texts: Mapping[str, tuple[str, str]], ask: Ask
) -> tuple[Command, ...]:
    """A command for each of these actions with its key; `texts`: label and description."""
    return tuple(
        Command(texts[action][0], key, texts[action][1], partial(ask, Press(action)))
        for action, key in keys.items()
    )
