"""The camera's parameters: their table, how their sigmas shrink, and leaving a view out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser

from venus3d.engine.snapshot import Snapshot
from venus3d.scene.guide.intents import DropView, Intent
from venus3d.scene.guide.progress_panel import (
    parameters_html,
    trend,
    trend_caption,
    trend_series,
)
from venus3d.scene.help import Command
from venus3d.scene.style import Theme
from venus3d.scene.texts import guide as say


class ParametersPanel:
    """One tab's content, shared by all browsers. `ask` is called on viser's threads."""

    def __init__(self, gui: viser.GuiApi, theme: Theme, ask: Callable[[Intent], None]) -> None:
        """Make it in the current tab."""
        self._ask = ask
        self._table = gui.add_html("")
        self._caption = gui.add_html(trend_caption(theme), visible=False)
        start = np.array([0.0, 1.0])
        self._trend = gui.add_uplot(
            (start, *(np.ones(2) for _ in range(9))),
            trend_series(theme),
            scales={"x": {"time": False}, "y": {"distr": 3}},
            axes=(
                {
                    "label": say.TREND_VIEWS,
                    "labelSize": 18,
                    "size": 30,
                    "incrs": (1.0, 2.0, 5.0, 10.0),
                    "stroke": theme.quiet,
                },
                {"label": "%", "labelSize": 16, "size": 44, "stroke": theme.quiet},
            ),
            legend={"show": False},
            height=160,
            padding=(12, 16, 0, 0),
            visible=False,
        )
        self._views = gui.add_dropdown(
            say.DROP_LABEL, ["–"], visible=False, hint=say.DROP_LABEL_HINT
        )
        self._drop = gui.add_button(
            say.DROP, icon=viser.Icon.TRASH, visible=False, hint=say.DROP_HINT
        )
        self._drop.on_click(lambda _: self._drop_chosen())

    @property
    def commands(self) -> tuple[Command, ...]:
        """What the button does, by its name."""
        return (Command(say.DROP_COMMAND, None, say.DROP_HINT.rstrip("."), self._drop_chosen),)

    def show(self, snapshot: Snapshot) -> None:
        """Put what is known at this moment there."""
        self._table.content = parameters_html(snapshot)
        lines = trend(snapshot.history)
        self._caption.visible = self._trend.visible = lines is not None
        if lines is not None:
            self._trend.data = lines
        options = tuple(f"{view.number} · {view.rms_px:.2f} px" for view in snapshot.views)
        self._views.visible = self._drop.visible = len(options) > 1
        if options and self._views.options != options:
            # viser falls back on the first option when the chosen one's text has changed.
            chosen = str(self._views.value).split(" ")[0]
            self._views.options = options
            same = [option for option in options if option.split(" ")[0] == chosen]
            self._views.value = same[0] if same else options[-1]

    def recolour(self, theme: Theme) -> None:
        """Take these colours."""
        self._trend.series = trend_series(theme)
        self._caption.content = trend_caption(theme)
        across, up = self._trend.axes or ({}, {})
        self._trend.axes = ({**across, "stroke": theme.quiet}, {**up, "stroke": theme.quiet})

    def _drop_chosen(self) -> None:
        number = str(self._views.value).split(" ")[0]
        if number.isdigit() and self._drop.visible:
            self._ask(DropView(int(number)))
