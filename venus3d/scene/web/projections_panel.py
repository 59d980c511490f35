"""The four steps as the camera would see them, two by two, with the current one marked."""

from __future__ import annotations

import base64
from concurrent.futures import Future
from dataclasses import dataclass
from html import escape

import cv2
import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.geometry.decomposition import Step, Steps
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.render.palette import step_style
from venus3d.scene.web import texts as say
from venus3d.scene.web.drawing import Failures
from venus3d.scene.web.texts import STEPS_FAILED
from venus3d.scene.web.theme import Theme

Picture = NDArray[np.uint8]
FAILED = "failed"


@dataclass(frozen=True)
class ShownSteps:
    """Four steps and their pictures, replaced together."""

    steps: Steps
    sources: tuple[str, ...]
    """Sources of the four images: empty while being drawn, `FAILED` if they could not be."""


class ProjectionsPanel:
    """The four tiles of one server. Pictures and mark are separate pieces, so that changing the
    step resends no picture."""

    def __init__(self, gui: viser.GuiApi) -> None:
        """An empty panel inside the current one."""
        self._head, self._tiles = gui.add_html(""), gui.add_html("")

    @property
    def visible(self) -> bool:
        """Whether anything is shown."""
        return bool(self._head.visible)

    @visible.setter
    def visible(self, on: bool) -> None:
        self._head.visible = self._tiles.visible = on

    def show(self, shown: ShownSteps | None, step: int, theme: Theme, note: str = "") -> None:
        """Show these pictures with their words, and `step` marked; None: no target."""
        if shown is None:
            self._head.content, self._tiles.content = _EMPTY, ""
            return
        self._head.content = mark_html(step)
        self._tiles.content = tiles_html(shown, theme, note)


_EMPTY = f"<div class='v-steps'><h3>{say.TILES_EMPTY}</h3></div>"


def mark_html(step: int) -> str:
    """The heading; the style sheet marks the tile of the step in it."""
    title = f"<h3 title='{escape(say.TILES_HINT)}'>{say.TILES_TITLE}</h3>"
    return f"<div class='v-steps' data-marked='{step}'>{title}</div>"


def tiles_html(shown: ShownSteps, theme: Theme, note: str = "") -> str:
    """The tiles, each with number, title, words and picture; a note below."""
    pairs = zip(shown.steps, shown.sources, strict=True)
    tiles = "".join(_tile(step, source, theme) for step, source in pairs)
    foot = f"<div class='v-legend'>{escape(note)}</div>" if note else ""
    return f"<div class='v-steps'><div class='v-grid'>{tiles}</div>{foot}</div>"


def _tile(step: Step, source: str, theme: Theme) -> str:
    words, title = escape(step_prompt(step).camera), step_style(step.number).title
    return (
        f"<div class='v-tile' data-step='{step.number}' title='{words}' "
        f"style='--step:{theme.steps[step.number - 1]}'><div class='v-told'><b>{step.number}</b>"
        f"<strong>{title}</strong><span>{words}</span></div>{_inside(step.number, source)}</div>"
    )


def _inside(number: int, source: str) -> str:
    if source == FAILED:
        return f"<div class='v-wait'>{say.TILE_FAILED}</div>"
    if not source:
        return f"<div class='v-wait'>{say.TILE_WAITING.format(number=number)}</div>"
    return f"<img alt='{say.TILE_ALT.format(number=number)}' src='{source}'>"


def encoded(picture: Picture) -> str:
    """An RGB picture as the source of an HTML image."""
    bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    _, buffer = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 88])
    return "data:image/jpeg;base64," + base64.b64encode(buffer.tobytes()).decode("ascii")


class Tiles:
    """The pictures of one target, as they are finished."""

    def __init__(self) -> None:
        """No pictures yet."""
        self._failures = Failures()
        self.key: object = None
        self._coming: tuple[Steps, tuple[Future[Picture], ...]] | None = None
        self._shown: ShownSteps | None = None

    def expect(self, key: object, steps: Steps, futures: tuple[Future[Picture], ...]) -> None:
        """Wait for these four pictures; the old ones stay until then."""
        self.key, self._coming = key, (steps, futures)
        if self._shown is None or not all(self._shown.sources):
            self._shown = ShownSteps(steps, ("",) * len(futures))

    def forget(self) -> None:
        """Drop the pictures: there is no target."""
        self.key = self._coming = self._shown = None

    def shown(self) -> ShownSteps | None:
        """What can be shown now; never waits."""
        if self._coming is not None:
            steps, futures = self._coming
            if all(future.done() for future in futures):
                self._shown, self._coming = ShownSteps(steps, self._sources(futures)), None
        return self._shown

    def _sources(self, futures: tuple[Future[Picture], ...]) -> tuple[str, ...]:
        try:
            return tuple(encoded(future.result()) for future in futures)
        except Exception as error:
            # Our error, in these pictures only: the next target gets its own.
            self._failures.tell(error, STEPS_FAILED)
            return (FAILED,) * len(futures)
