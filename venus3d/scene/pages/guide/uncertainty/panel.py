"""What is known, on the page: a tab with maps and captured views, and what they put into the scene.

Buttons and keys change a frozen state under a lock; the thread that draws the scene reads it. A map
is drawn again only when what it shows has changed. What a view left out means is the session's.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import viser

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.intents import DropView, Intent
from venus3d.scene.pages.guide.uncertainty import texts
from venus3d.scene.pages.guide.uncertainty.ghosts import ghost_shapes, misfit_end_px, view_of
from venus3d.scene.pages.guide.uncertainty.search_replay import SearchReplay
from venus3d.scene.pages.guide.uncertainty.topics import (
    TOPICS,
    Topic,
    even_ticks,
    figure,
    map_html,
    map_of,
    scale_html,
)
from venus3d.scene.pages.guide.uncertainty.view_card import view_html
from venus3d.scene.pages.guide.uncertainty.view_window import ViewWindow
from venus3d.scene.render.annotated_picture import LivePicture, small_picture
from venus3d.scene.render.shapes import Shape
from venus3d.scene.web.help import Command
from venus3d.scene.web.projections_panel import encoded
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.theme import Theme

_VIEW_PICTURE_WIDTH = 320


@dataclass(frozen=True)
class KnowledgeState:
    """What a person has chosen to see."""

    topic: Topic = "error"
    ghosts: bool = False
    """Whether the captured views stand in the scene."""
    watching: bool = False
    """Whether searches are replayed."""
    view: int | None = None
    """Number of the view looked at."""


class KnowledgePanel:
    """The tab of one server, and its part of the scene. `ask` is called on viser's threads."""

    def __init__(
        self,
        gui: viser.GuiApi,
        ask: Callable[[Intent], None],
    ) -> None:
        """Make everything in the current panel."""
        self._ask = ask
        self.on_change: Callable[[], None] = lambda: None
        """Called on viser's threads when there is something else to draw."""
        self._lock = threading.Lock()
        self.state = KnowledgeState()
        self._pictures: dict[int, str] = {}
        self._snapshot: Snapshot | None = None
        self._theme = Theme(True)
        self._wanted: tuple[object, ...] = ()
        self._drawn: tuple[object, ...] = ()
        self._card: tuple[object, ...] = ()
        self._bound: set[str] = set()
        self._replay = SearchReplay()
        self._make(gui)

    @property
    def commands(self) -> tuple[Command, ...]:
        """What can be asked for by a key; whoever owns the page adds them to it."""
        return (
            Command(texts.NEXT_TOPIC, "M", texts.NEXT_TOPIC_HINT, self._next_topic),
            Command(texts.TOGGLE_VIEWS, "V", texts.TOGGLE_VIEWS_HINT, self._toggle_ghosts),
            Command(texts.NEXT_VIEW, "I", texts.NEXT_VIEW_HINT, self._next_view),
            Command(texts.WATCH, "Y", texts.WATCH_HINT, self._toggle_watching),
        )

    @property
    def is_moving(self) -> bool:
        """Whether something is to be drawn soon, though nothing comes in."""
        return self._replay.is_moving or self._wanted != self._drawn

    @property
    def caption(self) -> str:
        """What the scene shows of a search, in one line; empty if nothing."""
        return self._replay.caption

    def go_on_from(self, other: KnowledgePanel) -> None:
        """Take over what was chosen and kept on a page that this one replaces."""
        self.state, self._pictures = other.state, other._pictures

    # -- what the page's threads call ------------------------------------------------------------

    def keep(self, number: int, image: LivePicture) -> None:
        """Keep the picture of the view of this number, small."""
        source = encoded(small_picture(image, _VIEW_PICTURE_WIDTH))
        with self._lock:
            self._pictures[number] = source
        self.on_change()

    def put(self, snapshot: Snapshot, shapes: tuple[Shape, ...], theme: Theme) -> tuple[Shape, ...]:
        """The scene's shapes with what is known at this moment among them.

        A search that is replayed takes the steps' place.
        """
        state = self.state
        if state.ghosts and snapshot.views:
            ghosts = ghost_shapes(snapshot.board, snapshot.views, state.view, theme.dark)
            shapes = (*shapes, *ghosts)
        return self._replay.of(snapshot, shapes, on=state.watching, dark=theme.dark)

    def show(self, snapshot: Snapshot, theme: Theme) -> None:
        """Put what is known at this moment on the tab, all but the map."""
        self._snapshot, self._theme = snapshot, theme
        self._show_views(snapshot, self.state)

    def show_map(self, snapshot: Snapshot, theme: Theme) -> None:
        """Have the map on the tab drawn if it shows something else now: not in this call but in the
        next, since the scene with a new target, drawn just before, has had enough to do."""
        state = self.state
        chosen = state.view if state.topic == "misfit" else None
        # The scale of “now” is that of “next” as well.
        target = snapshot.target if state.topic in ("error", "after") else None
        key = (snapshot.calibration, target and target.pose, state.topic, theme.dark, chosen)
        if key != self._wanted:
            self._wanted = key
        elif key != self._drawn:
            self._drawn = key
            shown = map_of(snapshot, state.topic, dark=theme.dark, chosen=chosen)
            self._map.content = map_html(shown)

    def bind(self, scene: SceneView) -> None:
        """Let the captured views that have been drawn be clicked."""
        for name in scene.names:
            number = view_of(name)
            if number is not None and name not in self._bound:
                self._bound.add(name)
                scene.node(name).on_click(self._opener(number))

    # -- the tab ---------------------------------------------------------------------------------

    def _make(self, gui: viser.GuiApi) -> None:
        self._window = ViewWindow()
        self._topics = gui.add_button_group(
            texts.TOPICS_LABEL, _topic_labels("error"), hint=texts.TOPICS_HINT
        )
        self._topics.on_click(lambda event: self._pick_topic(str(event.target.value)))
        self._switches = gui.add_button_group(
            texts.SHOW_LABEL, _switch_labels(self.state), hint=texts.SHOW_HINT
        )
        self._switches.on_click(lambda event: self._pick_switch(str(event.target.value)))
        self._views = gui.add_dropdown(
            texts.VIEWS_LABEL, [texts.NO_VIEW], hint=texts.VIEWS_HINT, visible=False
        )
        self._views.on_update(self._pick_view)
        self._offered: tuple[tuple[str, ...], str] = ((), "")
        self._legend = gui.add_html("", visible=False)
        self._about = gui.add_html("", visible=False)
        self._drop = gui.add_button(
            texts.LEAVE_OUT,
            icon=viser.Icon.TRASH,
            hint=texts.LEAVE_OUT_HINT,
            visible=False,
        )
        self._drop.on_click(lambda _: self._leave_out(self.state.view))
        self._map = gui.add_html("")

    def _show_views(self, snapshot: Snapshot, state: KnowledgeState) -> None:
        numbers = [view.number for view in snapshot.views]
        chosen = state.view if state.view in numbers else None
        options = (
            texts.NO_VIEW,
            *(
                texts.VIEW_OPTION.format(number=view.number, rms=figure(view.rms_px))
                for view in snapshot.views
            ),
        )
        wanted = options[0 if chosen is None else 1 + numbers.index(chosen)]
        if (options, wanted) != self._offered:
            # Not otherwise: a pick is in the list before `_pick_view` hears of it.
            self._offered = (options, wanted)
            self._views.options = options
            self._views.value = wanted
        self._views.visible = bool(numbers)
        picture = self._pictures.get(chosen or 0, "")
        card = (snapshot.calibration, chosen, picture)
        if card != self._card:
            self._card = card
            self._forget_old(numbers)
            self._about.content = "" if chosen is None else view_html(snapshot, chosen, picture)
            self._about.visible = chosen is not None
            self._drop.visible = chosen is not None and len(numbers) > 1
        self._legend.content = _legend(snapshot, state, self._theme)
        self._legend.visible = bool(self._legend.content)
        self._topics.options = _topic_labels(state.topic)
        self._switches.options = _switch_labels(state)

    def _forget_old(self, numbers: list[int]) -> None:
        """Pictures of views that were left out go; of views still being calibrated they stay."""
        newest = max(numbers, default=0)
        with self._lock:
            self._pictures = {
                number: picture
                for number, picture in self._pictures.items()
                if number in numbers or number > newest
            }

    def _opener(self, number: int) -> Callable[[Any], None]:
        def opened(event: Any) -> None:
            self._open(event.client, number)

        return opened

    def _open(self, client: viser.ClientHandle, number: int) -> None:
        """All about a view, in the tab in which it was clicked."""
        snapshot = self._snapshot
        self._change(view=number)
        if snapshot is None:
            return
        html = view_html(snapshot, number, self._pictures.get(number, ""))
        if not html:
            return
        drop = partial(self._leave_out, number) if len(snapshot.views) > 1 else None
        self._window.open(client, number, self._theme.sheet + html, drop)

    # -- what people do; on viser's threads ------------------------------------------------------

    def _change(self, **changes: Any) -> None:
        with self._lock:
            self.state = replace(self.state, **changes)
        self.on_change()

    def _pick_topic(self, label: str) -> None:
        for topic in TOPICS:
            if texts.TOPICS[topic] == _bare(label):
                self._change(topic=topic)

    def _next_topic(self) -> None:
        self._change(topic=TOPICS[(TOPICS.index(self.state.topic) + 1) % len(TOPICS)])

    def _pick_switch(self, label: str) -> None:
        if _bare(label) == texts.SHOW_VIEWS:
            self._toggle_ghosts()
        elif _bare(label) == texts.SHOW_SEARCH:
            self._toggle_watching()

    def _toggle_ghosts(self) -> None:
        self._change(ghosts=not self.state.ghosts)

    def _toggle_watching(self) -> None:
        self._change(watching=not self.state.watching)

    def _pick_view(self, event: Any) -> None:
        if event.client is None:
            return  # set by `show`
        number = str(event.target.value).split(" ")[0]
        self._change(view=int(number) if number.isdigit() else None)

    def _next_view(self) -> None:
        numbers = [] if self._snapshot is None else [v.number for v in self._snapshot.views]
        later = [number for number in numbers if number > (self.state.view or 0)]
        self._change(view=later[0] if later else None, ghosts=self.state.ghosts or bool(later))

    def _leave_out(self, number: int | None) -> None:
        if number is not None:
            self._change(view=None)
            self._ask(DropView(number))


def _legend(snapshot: Snapshot, state: KnowledgeState, theme: Theme) -> str:
    """What the colours mean of what stands in the scene; empty if nothing does."""
    told = ""
    if state.ghosts and snapshot.views:
        ticks = even_ticks(misfit_end_px(snapshot.views))
        told += f"<h3>{texts.GHOSTS_LEGEND}</h3>{scale_html(ticks, texts.PIXELS)}"
    if state.watching:
        dots = texts.SEARCH_LEGEND_DARK if theme.dark else texts.SEARCH_LEGEND_LIGHT
        told += f"<h3>{dots}</h3>"
    return f"<div class='v-progress' data-panel='uncertainty'>{told}</div>" if told else ""


def _topic_labels(shown: Topic) -> tuple[str, ...]:
    return tuple(("✓ " if topic == shown else "") + label for topic, label in texts.TOPICS.items())


def _switch_labels(state: KnowledgeState) -> tuple[str, ...]:
    pairs = ((texts.SHOW_VIEWS, state.ghosts), (texts.SHOW_SEARCH, state.watching))
    return tuple(("✓ " if on else "") + label for label, on in pairs)


def _bare(label: str) -> str:
    return label.removeprefix("✓ ")
