"""The uncertainty layer: a tab with maps and captured views, and its shapes in the scene. Buttons
and keys change a frozen state under a lock; the drawing thread reads it. A map is redrawn only when
its content has changed."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import viser

from venus3d.engine.amounts import figure
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import LivePicture, small_picture
from venus3d.render.shapes import Shape
from venus3d.render.strip import shows_strip
from venus3d.scene.pages.guide.uncertainty import texts
from venus3d.scene.pages.guide.uncertainty.captured_views import (
    captured_view_shapes,
    misfit_end_px,
    view_of,
)
from venus3d.scene.pages.guide.uncertainty.maps import (
    MAP_KINDS,
    MapKind,
    even_ticks,
    map_html,
    map_of,
)
from venus3d.scene.pages.guide.uncertainty.search_replay import SearchReplay
from venus3d.scene.pages.guide.uncertainty.view_card import ViewWindow, view_html
from venus3d.scene.web import texts as web_texts
from venus3d.scene.web.buttons import ButtonRow, ChoiceList
from venus3d.scene.web.help import Command
from venus3d.scene.web.keys import KEYS
from venus3d.scene.web.legend import scale_html
from venus3d.scene.web.projections_panel import encoded
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.theme import Theme

_VIEW_PICTURE_WIDTH = 320
Switch = Literal["views", "search"]


@dataclass(frozen=True)
class UncertaintyState:
    """What a person has chosen to see."""

    map: MapKind = "now"
    views: bool = False
    """Whether the captured views are in the scene."""
    search: bool = False
    """Whether searches are replayed."""
    view: int | None = None
    """Number of the selected view."""


class UncertaintyPanel:
    """A layer (`scene.web.layer.Layer`) of a calibration's page."""

    icon = viser.Icon.MAP_2

    @property
    def title(self) -> str:
        """Of its tab."""
        return texts.TAB

    def __init__(self, on_drop: Callable[[int], None] | None, wake: Callable[[], None]) -> None:
        """Nothing is shown until `lay_out`.

        Args:
            on_drop: called on viser's threads with the number of a view to exclude; None: no view
                can be.
            wake: called on any thread when something must be redrawn.
        """
        self._on_drop, self._wake = on_drop, wake
        self._lock = threading.Lock()
        self.state = UncertaintyState()
        self._pictures: dict[int, str] = {}
        self._snapshot: Snapshot | None = None
        self._theme = Theme(True)
        self._replay = SearchReplay()

    @property
    def commands(self) -> tuple[Command, ...]:
        """Its commands, which the page adds."""
        views, search = partial(self._switch, "views"), partial(self._switch, "search")
        return (
            Command(texts.NEXT_MAP, KEYS["map"], texts.NEXT_MAP_HINT, self._next_map),
            Command(texts.TOGGLE_VIEWS, KEYS["views"], texts.TOGGLE_VIEWS_HINT, views),
            Command(texts.NEXT_VIEW, KEYS["next_view"], texts.NEXT_VIEW_HINT, self._next_view),
            Command(texts.REPLAY_SEARCH, KEYS["search"], texts.REPLAY_SEARCH_HINT, search),
        )

    @property
    def is_moving(self) -> bool:
        """Whether it must be redrawn soon without new input."""
        return self._replay.is_moving or self._wanted != self._drawn

    @property
    def caption(self) -> str:
        """One line on the search shown in the scene; empty for none."""
        return self._replay.caption

    def lay_out(self, gui: viser.GuiApi) -> None:
        """Create all widgets in the current panel."""
        self._wanted: tuple[object, ...] = ()
        self._drawn: tuple[object, ...] = ()
        self._card: tuple[object, ...] = ()
        self._told: tuple[object, ...] = ()
        self._bound: set[str] = set()
        self._window = ViewWindow()
        self._maps = ButtonRow(
            gui,
            texts.MAPS_LABEL,
            _map_labels("now"),
            lambda kind, _: self._change(map=kind),
            hint=texts.MAPS_HINT,
        )
        self._switches = ButtonRow(
            gui,
            texts.SHOW_LABEL,
            _switch_labels(self.state),
            lambda switch, _: self._switch(switch),
            hint=texts.SHOW_HINT,
        )
        self._views = ChoiceList[int](
            gui,
            texts.VIEWS_LABEL,
            {0: texts.NO_VIEW},
            lambda number: self._change(view=number or None),
            hint=texts.VIEWS_HINT,
            visible=False,
        )
        self._legend = gui.add_html("", visible=False)
        self._about = gui.add_html("", visible=False)
        self._drop = gui.add_button(
            texts.LEAVE_OUT, icon=viser.Icon.TRASH, hint=texts.LEAVE_OUT_HINT, visible=False
        )
        self._drop.on_click(lambda _: self._leave_out(self.state.view))
        self._map = gui.add_html("")

    # -- what the page's threads call ------------------------------------------------------------

    def keep_picture(self, number: int, image: LivePicture) -> None:
        """Keep a small copy of the picture of the view of this number."""
        source = encoded(small_picture(image, _VIEW_PICTURE_WIDTH))
        with self._lock:
            self._pictures[number] = source
        self._wake()

    def put(self, snapshot: Snapshot, shapes: tuple[Shape, ...], theme: Theme) -> tuple[Shape, ...]:
        """The scene's shapes with the captured views, which are not among steps side by side; a
        replayed search replaces the steps."""
        state = self.state
        if state.views and snapshot.views and not shows_strip(shapes):
            views = captured_view_shapes(snapshot.board, snapshot.views, state.view, theme.dark)
            shapes = (*shapes, *views)
        return self._replay.of(snapshot, shapes, on=state.search, dark=theme.dark)

    def show(self, snapshot: Snapshot, theme: Theme) -> None:
        """Update the tab, except for the map."""
        self._snapshot, self._theme = snapshot, theme
        state = self.state
        numbers = [view.number for view in snapshot.views]
        chosen = state.view if state.view in numbers else None
        labels = {
            view.number: texts.VIEW_OPTION.format(number=view.number, rms=figure(view.rms_px))
            for view in snapshot.views
        }
        self._views.show({0: texts.NO_VIEW, **labels}, chosen or 0)
        self._views.visible = bool(numbers)
        picture = self._pictures.get(chosen or 0, "")
        card = (snapshot.calibration, chosen, picture)
        if card != self._card:
            self._card = card
            self._forget_old(numbers)
            self._about.content = "" if chosen is None else view_html(snapshot, chosen, picture)
            self._about.visible = chosen is not None
            self._drop.visible = chosen is not None and self._may_drop(snapshot)
        if (snapshot.calibration, theme) != self._told:  # also while a window is open
            self._told = snapshot.calibration, theme
            html_of = partial(self._window_html, snapshot)
            self._window.update(html_of, may_leave_out=self._may_drop(snapshot))
        self._legend.content = _legend(snapshot, state, self._theme)
        self._legend.visible = bool(self._legend.content)
        self._maps.show(_map_labels(state.map))
        self._switches.show(_switch_labels(state))

    def show_late(self, snapshot: Snapshot, theme: Theme) -> None:
        """Start drawing the tab's map if it has changed: in the next call, since the scene of a new
        target, drawn just before, took time enough."""
        state = self.state
        chosen = state.view if state.map == "misfit" else None
        # “now” and “next” share a scale.
        target = snapshot.target if state.map in ("now", "after") else None
        key = (snapshot.calibration, target and target.pose, state.map, theme.dark, chosen)
        if key != self._wanted:
            self._wanted = key
        elif key != self._drawn:
            self._drawn = key
            shown = map_of(snapshot, state.map, dark=theme.dark, chosen=chosen)
            self._map.content = map_html(shown)

    def bind(self, scene: SceneView) -> None:
        """Make the drawn views clickable."""
        for name in scene.names:
            number = view_of(name)
            if number is not None and name not in self._bound:
                self._bound.add(name)
                scene.node(name).on_click(partial(self._clicked, number))

    # -- the tab ---------------------------------------------------------------------------------

    def _forget_old(self, numbers: list[int]) -> None:
        """Drop pictures of excluded views; those still being calibrated stay."""
        newest = max(numbers, default=0)
        with self._lock:
            self._pictures = {
                number: picture
                for number, picture in self._pictures.items()
                if number in numbers or number > newest
            }

    def open_view(self, number: int, client: viser.ClientHandle) -> None:
        """Select a view, as in the list, and open its card in this tab."""
        snapshot = self._snapshot
        self._change(view=number)
        html = "" if snapshot is None else self._window_html(snapshot, number)
        if snapshot is not None and html:
            drop, may_drop = partial(self._leave_out, number), self._may_drop(snapshot)
            self._window.open(client, number, html, drop, may_leave_out=may_drop)

    def _window_html(self, snapshot: Snapshot, number: int) -> str:
        html = view_html(snapshot, number, self._pictures.get(number, ""))
        return html and self._theme.sheet + html

    def _may_drop(self, snapshot: Snapshot) -> bool:
        return self._on_drop is not None and len(snapshot.views) > 1

    # -- what people do; on viser's threads ------------------------------------------------------

    def _clicked(self, number: int, event: Any) -> None:
        self.open_view(number, event.client)

    def _change(self, **changes: Any) -> None:
        with self._lock:
            self.state = replace(self.state, **changes)
        self._wake()

    def _next_map(self) -> None:
        self._change(map=MAP_KINDS[(MAP_KINDS.index(self.state.map) + 1) % len(MAP_KINDS)])

    def _switch(self, switch: Switch) -> None:
        self._change(**{switch: not getattr(self.state, switch)})

    def _next_view(self) -> None:
        numbers = [] if self._snapshot is None else [v.number for v in self._snapshot.views]
        later = [number for number in numbers if number > (self.state.view or 0)]
        self._change(view=later[0] if later else None, views=self.state.views or bool(later))

    def _leave_out(self, number: int | None) -> None:
        if number is not None and self._on_drop is not None:
            self._change(view=None)
            self._on_drop(number)


def _legend(snapshot: Snapshot, state: UncertaintyState, theme: Theme) -> str:
    """The legend for the colours in the scene; empty without any."""
    told = ""
    if state.views and snapshot.views:
        ticks = even_ticks(misfit_end_px(snapshot.views))
        told += f"<h3>{texts.CAPTURED_VIEWS_LEGEND}</h3>{scale_html(ticks, texts.PIXELS)}"
    if state.search:
        dots = texts.SEARCH_LEGEND_DARK if theme.dark else texts.SEARCH_LEGEND_LIGHT
        told += f"<h3>{dots}</h3>"
    return f"<div class='v-progress' data-panel='uncertainty'>{told}</div>" if told else ""


def _map_labels(shown: MapKind) -> dict[MapKind, str]:
    return {kind: _marked(text, kind == shown) for kind, text in texts.MAPS.items()}


def _switch_labels(state: UncertaintyState) -> dict[Switch, str]:
    return {
        "views": _marked(texts.SHOW_VIEWS, state.views),
        "search": _marked(texts.SHOW_SEARCH, state.search),
    }


def _marked(label: str, on: bool) -> str:
    return web_texts.SWITCHED_ON.format(label=label) if on else label
