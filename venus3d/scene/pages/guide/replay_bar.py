"""The time line of a replayed session: play, speed, jump to a view."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from html import escape

import viser

from venus3d.scene.pages.guide import replay_texts as say
from venus3d.scene.web.buttons import ButtonRow, ChoiceList
from venus3d.scene.web.help import Command, add_commands
from venus3d.scene.web.keys import KEYS
from venus3d.storage.session_moments import Moment

SPEEDS = (1, 2, 5, 20)
_SLIDER_STEP_S = 0.1


@dataclass(frozen=True)
class Place:
    """Where a replay is."""

    time_s: float = 0.0
    """On the time line."""
    playing: bool = False
    speed: int = 1

    def after(self, seconds: float, end_s: float) -> Place:
        """The place `seconds` later, at `end_s` at the latest."""
        if not self.playing:
            return self
        time_s = min(self.time_s + seconds * self.speed, end_s)
        return replace(self, time_s=time_s, playing=time_s < end_s)


def moment_at(moments: Sequence[Moment], time_s: float) -> int:
    """Index of the last moment that had come by then; the first one's if none had."""
    come = [index for index, moment in enumerate(moments) if moment.play_s <= time_s + 1e-6]
    return come[-1] if come else 0


class ReplayBar:
    """The place on the time line, and its widgets on the page's server. Any thread may call it."""

    def __init__(self, moments: Sequence[Moment]) -> None:
        """At the first moment."""
        self._moments = tuple(moments)
        self._captures = [m for m in self._moments if m.kind == "captured"] or [moments[0]]
        self._lock = threading.Lock()
        self.place = Place()
        self._shown_s = -1.0

    @property
    def end_s(self) -> float:
        """The last moment's place."""
        return self._moments[-1].play_s

    def change(self, change: Callable[[Place], Place]) -> None:
        """Change the place."""
        with self._lock:
            self.place = change(self.place)

    def advance(self, seconds: float) -> None:
        """Play on."""
        self.change(lambda place: place.after(seconds, self.end_s))

    def play(self) -> None:
        """Play or pause; at the end, from the beginning."""

        def toggled(place: Place) -> Place:
            at_end = place.time_s >= self.end_s and not place.playing
            return replace(place, playing=not place.playing, time_s=0.0 if at_end else place.time_s)

        self.change(toggled)

    def go_by(self, views: int) -> None:
        """Go on by so many captured views."""
        now_s = self.place.time_s
        later = [m.play_s for m in self._captures if m.play_s > now_s + 1e-6]
        before = [m.play_s for m in self._captures if m.play_s < now_s - 1e-6]
        to = (later[:1] if views > 0 else before[-1:]) or [now_s]
        self.go_to(to[0])

    def go_to(self, time_s: float) -> None:
        """Go to a place of the time line, and stay there."""
        self.change(lambda place: replace(place, time_s=time_s, playing=False))

    def lay_out(self, server: viser.ViserServer, below: viser.PanelHandle) -> tuple[Command, ...]:
        """Make the widgets in a panel of their own; returns the commands."""
        gui = server.gui
        panel = gui.add_panel()
        with panel.add_tab(say.TAB, viser.Icon.MOVIE):
            self._where = gui.add_html("")
            self._slider = gui.add_slider(
                say.TIME,
                min=0.0,
                max=max(self.end_s, _SLIDER_STEP_S),
                step=_SLIDER_STEP_S,
                initial_value=0.0,
                hint=say.TIME_HINT,
            )
            self._slider.on_update(self._slid)
            self._row = ButtonRow(gui, say.ROW, self._buttons(), self._pressed, hint=say.ROW_HINT)
            speeds = {speed: say.TIMES.format(speed=speed) for speed in SPEEDS}
            self._speed = ChoiceList(
                gui, say.SPEED, speeds, self._set_speed, chosen=1, hint=say.SPEED_HINT
            )
            views = {m.play_s: str(m.number) for m in self._captures}
            ChoiceList(gui, say.VIEW, views, self.go_to, hint=say.VIEW_HINT)
        panel.dock_below(below)
        self._shown_s = -1.0
        commands = (
            Command(say.COMMAND_PLAY, KEYS["go_on"], say.COMMAND_PLAY_HINT, self.play),
            Command(
                say.COMMAND_NEXT, KEYS["next_page"], say.COMMAND_NEXT_HINT, partial(self.go_by, 1)
            ),
            Command(
                say.COMMAND_PREVIOUS,
                KEYS["previous_page"],
                say.COMMAND_PREVIOUS_HINT,
                partial(self.go_by, -1),
            ),
        )
        add_commands(server, commands)
        return commands

    def show(self, moment: Moment, done: int) -> None:
        """Show the place; `done`: how many moments are worked out."""
        place = self.place
        if abs(place.time_s - self._shown_s) >= _SLIDER_STEP_S or not place.playing:
            self._shown_s = place.time_s
            self._slider.value = round(place.time_s / _SLIDER_STEP_S) * _SLIDER_STEP_S
        self._row.show(self._buttons())
        words = say.WHERE[moment.kind].format(at=f"{moment.at:%H:%M:%S}", number=moment.number)
        if done < len(self._moments):
            words += " " + say.COMING.format(done=done, all=len(self._moments))
        self._where.content = f"<p class='v-replay'>{escape(words)}</p>"

    def _buttons(self) -> dict[str, str]:
        playing = self.place.playing
        return {"-": say.PREVIOUS, "play": say.PAUSE if playing else say.PLAY, "+": say.NEXT}

    def _pressed(self, what: str, _: viser.ClientHandle | None) -> None:
        if what == "play":
            self.play()
        else:
            self.go_by(1 if what == "+" else -1)

    def _set_speed(self, speed: int) -> None:
        self.change(lambda place: replace(place, speed=speed))

    def _slid(self, event: viser.GuiEvent[viser.GuiSliderHandle[float]]) -> None:
        if event.client is not None:
            self.go_to(float(event.target.value))
