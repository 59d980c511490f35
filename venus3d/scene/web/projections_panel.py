"""The four steps as the camera would see them, two by two, with the current one marked.

Words and amounts are this moment's and change with every frame; a picture stays until another one
is drawn. So they are separate pieces: the pictures are a style sheet's, and the tiles name them.
"""

from __future__ import annotations

import base64
from collections.abc import Callable
from concurrent.futures import Future
from html import escape

import cv2
import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.amounts import step_amount
from venus3d.engine.guidance.prompts import Wording
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import translated
from venus3d.render.palette import step_style
from venus3d.render.projections import Projections, corners_outside_text
from venus3d.render.redrawing import shows_another, still_shows
from venus3d.scene.web import step_texts as say
from venus3d.scene.web.drawing import Failures
from venus3d.scene.web.terminal_texts import STEPS_FAILED
from venus3d.scene.web.theme import Theme

Picture = NDArray[np.uint8]
Sources = tuple[str, ...]
"""Sources of the four images: empty while being drawn, `FAILED` if they could not be."""
FAILED = "failed"
Flags = tuple[bool, ...]
"""Of each of the four steps."""
NONE: Flags = (False,) * 4


class ProjectionsPanel:
    """The four tiles of one page."""

    def __init__(self, gui: viser.GuiApi) -> None:
        """An empty panel inside the current one."""
        self._pictures, self._tiles = gui.add_html(""), gui.add_html("")

    @property
    def visible(self) -> bool:
        """Whether anything is shown."""
        return bool(self._tiles.visible)

    @visible.setter
    def visible(self, on: bool) -> None:
        self._tiles.visible = self._pictures.visible = on

    def show(
        self,
        remaining: RemainingSteps | None,
        sources: Sources | None,
        step: int,
        theme: Theme,
        note: str = "",
        wording: Wording = "holder",
        outdated: Flags = NONE,
    ) -> None:
        """Show these steps with these pictures, and `step` marked. A done step has a tick over its
        picture.

        Args:
            remaining: None while nothing is to be done; the pictures then stay without words.
            sources: None without a target.
            outdated: of each picture, whether it shows something else than is said; it is faint
                until the next one comes.
        """
        self._pictures.content = "" if sources is None else pictures_html("steps", sources)
        if sources is None:
            self._tiles.content = f"<div class='v-steps'><h3>{say.TILES_EMPTY}</h3></div>"
            return
        upright = remaining is not None and remaining.from_upright
        title = say.TILES_FROM_UPRIGHT if upright else say.TILES_TITLE
        tiles = "".join(
            _tile(number, source, remaining, number == step, theme, wording, outdated[number - 1])
            for number, source in enumerate(sources, start=1)
        )
        foot = f"<div class='v-legend'>{escape(translated(note))}</div>" if note else ""
        self._tiles.content = (
            f"<div class='v-steps' data-marked='{step}'><h3 title='{escape(say.TILES_HINT)}'>"
            f"{title}</h3><div class='v-legend'>{say.READERS[wording]}</div>"
            f"<div class='v-grid'>{tiles}</div>{foot}</div>"
        )


def _tile(
    number: int,
    source: str,
    remaining: RemainingSteps | None,
    is_on: bool,
    theme: Theme,
    wording: Wording,
    is_old: bool,
) -> str:
    fact = words = warning = ""
    mark = " v-old" if is_old else ""
    if remaining is not None:
        step = remaining.step(number)
        mark = " v-done" if step.done else mark
        left = say.DONE if step.done else step_amount(step.step)
        fact = say.TILE_FACT.format(number=number, fact=left)
        words = translated(step.prompt.text(wording))
        warning = "" if step.done else corners_outside_text(len(step.step.corners_outside))
        fact = escape(fact) if step.done else f"{escape(fact)}<em> {say.TO_GO}</em>"
    mark += " v-on" if is_on else ""
    return tile_html("steps", number, source, fact, words, theme, mark=mark, warning=warning)


def tile_html(
    name: str,
    number: int,
    source: str,
    fact: str,
    words: str,
    theme: Theme,
    *,
    mark: str = "",
    warning: str = "",
) -> str:
    """One step's tile: number, title, a fact (HTML), words, and its picture in the set of this
    name, with a warning over its lower edge; `mark` is more of its class."""
    return (
        f"<div class='v-tile{mark}' style='--step:{theme.steps[number - 1]}'>"
        f"<div class='v-told'><b>{number}</b><strong>{step_style(number).title}"
        f"<small>{fact}</small></strong><span>{escape(words)}</span></div>"
        f"{_inside(name, number, source)}{warning_html(warning)}</div>"
    )


def warning_html(warning: str) -> str:
    """A warning over the lower edge of a tile's picture; nothing for none."""
    return f"<div class='v-warning'>{escape(warning)}</div>" if warning else ""


def _inside(name: str, number: int, source: str) -> str:
    if source == FAILED:
        return f"<div class='v-wait'>{say.TILE_FAILED}</div>"
    if not source:
        return f"<div class='v-wait'>{say.TILE_WAITING.format(number=number)}</div>"
    alt = say.TILE_ALT.format(number=number)
    return f"<div class='v-shot' data-shot='{name}-{number}' role='img' aria-label='{alt}'></div>"


def pictures_html(name: str, sources: Sources) -> str:
    """A style sheet with a set of pictures, for its tiles."""
    rules = (
        f"[data-shot={name}-{number}]{{background-image:url({source})}}"
        for number, source in enumerate(sources, start=1)
        if source not in ("", FAILED)
    )
    return f"<style>{''.join(rules)}</style>"


def encoded(picture: Picture) -> str:
    """An RGB picture as the source of an HTML image."""
    bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    _, buffer = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 88])
    return "data:image/jpeg;base64," + base64.b64encode(buffer.tobytes()).decode("ascii")


class Tiles:
    """Four pictures of steps, as they are finished."""

    def __init__(self) -> None:
        """No pictures yet."""
        self._failures = Failures()
        self.key: object = None
        """What the pictures are of."""
        self._coming: tuple[Future[Picture], ...] = ()
        self._sources: Sources | None = None

    @property
    def is_waiting(self) -> bool:
        """Whether pictures are being drawn."""
        return bool(self._coming)

    def expect(self, key: object, futures: tuple[Future[Picture], ...]) -> None:
        """Wait for these four pictures; the old ones stay until then."""
        self.key, self._coming = key, futures
        if self._sources is None or not all(self._sources):
            self._sources = ("",) * len(futures)

    def forget(self) -> None:
        """Drop the pictures: there is nothing to show."""
        self.key, self._coming, self._sources = None, (), None

    def shown(self) -> Sources | None:
        """What can be shown now; never waits."""
        if self._coming and all(future.done() for future in self._coming):
            self._sources, self._coming = self._encoded(self._coming), ()
        return self._sources

    def _encoded(self, futures: tuple[Future[Picture], ...]) -> Sources:
        try:
            return tuple(encoded(future.result()) for future in futures)
        except Exception as error:
            # Our error, in these pictures only: the next ones may come.
            self._failures.tell(error, STEPS_FAILED)
            return (FAILED,) * len(futures)


class RemainingTiles(Tiles):
    """The pictures of the remaining steps, drawn again only when they no longer show what is to be
    done."""

    def __init__(self, projections: Projections | None, wake: Callable[[], None]) -> None:
        """`wake` is called on another thread when pictures are ready; without `projections` there
        are none."""
        super().__init__()
        self._projections, self._wake = projections, wake
        self._drawn: RemainingSteps | None = None
        self._seen: RemainingSteps | None = None
        """The steps in the pictures that are shown; `_drawn` may still be on their way."""

    def order(self, snapshot: Snapshot, *, dark: bool) -> None:
        """Have the pictures drawn, if those that there are do not fit this moment. One set at a
        time is drawn for a target."""
        remaining = snapshot.remaining
        if self._projections is None or remaining is None:
            return
        target, key = remaining.steps[3].after, (dark, snapshot.camera)
        if self._drawn is not None and target is self._drawn.steps[3].after:
            fits = key == self.key and still_shows(self._drawn, remaining)
            if fits or self.is_waiting:
                return
        pictures = self._projections.of(
            remaining.steps,
            snapshot.camera,
            snapshot.board,
            done=remaining.done,
            dark=dark,
            header=False,
            letters=False,
        )
        self._drawn = remaining
        self.expect(key, pictures)
        pictures[-1].add_done_callback(lambda _: self._wake())

    def shown(self) -> Sources | None:
        was_waiting, sources = self.is_waiting, super().shown()
        if was_waiting and not self.is_waiting:
            self._seen = self._drawn
        return sources

    def outdated(self, now: RemainingSteps | None) -> Flags:
        """Of each picture that `shown` gave last, whether it shows something else than `now`."""
        return NONE if self._seen is None or now is None else shows_another(self._seen, now)

    def forget(self) -> None:
        super().forget()
        self._drawn = self._seen = None
