"""The camera's parameters: a table, and a plot of their sigmas."""

from __future__ import annotations

import numpy as np
import viser

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.progress_panel import trend, trend_caption, trend_series
from venus3d.scene.pages.guide.uncertainty.parameters import parameters_html
from venus3d.scene.web.theme import Theme


class ParametersPanel:
    """The content of one tab, shared by all browsers."""

    def __init__(self, gui: viser.GuiApi, theme: Theme) -> None:
        """Create it in the current tab."""
        self._shown: tuple[object, ...] = (self, self, self)  # nothing yet
        self._table = gui.add_html("")
        self._caption = gui.add_html(trend_caption(theme), visible=False)
        start = np.array([0.0, 1.0])
        self._theme = theme
        self._names = Camera.guess((2, 2)).parameter_names
        self._trend = gui.add_uplot(
            (start, *(np.ones(2) for _ in self._names)),
            trend_series(theme, self._names),
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

    def show(self, snapshot: Snapshot) -> None:
        """Show this moment's parameters."""
        shown = (snapshot.calibration, snapshot.convergence, snapshot.history)
        if all(a is b for a, b in zip(shown, self._shown, strict=True)):
            return
        self._shown = shown
        self._table.content = parameters_html(snapshot)
        lines = trend(snapshot.history)
        self._caption.visible = self._trend.visible = lines is not None
        if lines is not None:
            if snapshot.history[-1].names != self._names:
                self._names = snapshot.history[-1].names
                self._trend.series = trend_series(self._theme, self._names)
            self._trend.data = lines

    def recolour(self, theme: Theme) -> None:
        """Use these colours."""
        self._theme = theme
        self._trend.series = trend_series(theme, self._names)
        self._caption.content = trend_caption(theme)
        across, up = self._trend.axes or ({}, {})
        self._trend.axes = ({**across, "stroke": theme.quiet}, {**up, "stroke": theme.quiet})
