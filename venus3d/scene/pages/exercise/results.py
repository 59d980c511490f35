"""The poses of one trainee so far: a list and two plots."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.panel import plot_lines, results_html, series_of
from venus3d.scene.pages.exercise.view_model import PracticeMoment
from venus3d.scene.web.theme import Theme

_HEIGHT = 150


class ResultsPanel:
    """The session's summary, in the current panel; it grows with every pose."""

    def __init__(self, gui: viser.GuiApi, theme: Theme) -> None:
        """Nothing is listed yet."""
        self._list = gui.add_html("")
        self._plots = [self._plot(gui, label, theme) for label in (say.TIME_PLOT, say.WAY_PLOT)]
        self._dark = theme.dark
        self._count = 0

    def show(self, moment: PracticeMoment, theme: Theme) -> None:
        """List and plot the moment's scores."""
        self._list.content = results_html(moment)
        if theme.dark != self._dark:
            self._dark = theme.dark
            for plot, label in zip(self._plots, (say.TIME_PLOT, say.WAY_PLOT), strict=True):
                plot.series = series_of(label, theme)
        lines = plot_lines(moment.scores)
        if lines is None or len(moment.scores) == self._count:
            return
        self._count = len(moment.scores)
        for plot, line in zip(self._plots, lines[1:], strict=True):
            plot.data = (lines[0], line)
            plot.visible = True

    def _plot(self, gui: viser.GuiApi, label: str, theme: Theme) -> Any:
        return gui.add_uplot(
            (np.array([0.0, 1.0]), np.array([0.0, 1.0])),
            series_of(label, theme),
            scales={"x": {"time": False}},
            axes=(
                {"label": say.POSE_AXIS, "labelSize": 18, "size": 30, "incrs": (1.0, 2.0, 5.0)},
                {"label": label, "labelSize": 18, "size": 46},
            ),
            legend={"show": False},
            height=_HEIGHT,
            padding=(12, 16, 0, 0),
            visible=False,
        )
