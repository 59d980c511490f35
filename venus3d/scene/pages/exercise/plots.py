"""Plots of finished poses: a trainee's times and ways, and the times of a trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.exercise import detour
from venus3d.render.palette import hex_of
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.trial_plan import HelpTimes
from venus3d.scene.pages.exercise.view_model import TRIAL_HELPS
from venus3d.scene.web.theme import Theme
from venus3d.storage.exercise import REACHED, ExerciseRow

HELP_COLOURS = {"steps": 3, "axes": 2, "outline": 4}
"""Each help's colour, as the number of the step with that colour."""


class PosePlot:
    """Lines over pose numbers, hidden until there are any."""

    def __init__(self, gui: viser.GuiApi, label: str, height: int, lines: Sequence[str]) -> None:
        """A plot in the current panel; `label` is its vertical axis, `lines` are their names."""
        self._names, self._shown = lines, b""
        start = np.array([0.0, 1.0])
        self._plot = gui.add_uplot(
            tuple(start for _ in range(len(lines) + 1)),
            ({"label": say.POSE}, *({"label": name} for name in lines)),
            scales={"x": {"time": False}},
            axes=(
                {"label": say.POSE, "labelSize": 18, "size": 30, "incrs": (1.0, 2.0, 5.0)},
                {"label": label, "labelSize": 18, "size": 48},
            ),
            legend={"show": False},
            height=height,
            padding=(12, 16, 0, 0),
            visible=False,
        )

    def show(
        self, lines: Sequence[Array | None] | None, colours: Sequence[int], theme: Theme
    ) -> None:
        """Show these lines, (N,) each, in the colours of these steps; a line that is None is left
        out. None instead of all of them: nothing to show yet."""
        if lines is None:
            return
        count = max(len(line) for line in lines if line is not None)
        drawn = [np.zeros(count) if line is None else line for line in lines]
        shown = np.array([*drawn, np.full(count, theme.dark)]).tobytes()
        if shown == self._shown:
            return
        self._shown = shown
        series: list[Any] = [
            {
                "label": name,
                "stroke": hex_of(theme.step_colours[colour - 1]),
                "width": 3,
                "points": {"show": True, "size": 8},
                "show": line is not None,
            }
            for name, colour, line in zip(self._names, colours, lines, strict=True)
        ]
        self._plot.series = ({"label": say.POSE}, *series)
        across, up = self._plot.axes or ({}, {})
        self._plot.axes = ({**across, "stroke": theme.quiet}, {**up, "stroke": theme.quiet})
        self._plot.data = (np.arange(1, count + 1, dtype=np.float64), *drawn)
        self._plot.visible = True


def practice_lines(rows: Sequence[ExerciseRow]) -> tuple[Array, Array] | None:
    """Seconds and path ratio of each pose, (N,); None before two poses were reached. Poses that
    were given up or have no path are NaN: a gap in the line."""
    reached = [row.outcome == REACHED for row in rows]
    if sum(reached) < 2:
        return None
    seconds, ways = [row.seconds for row in rows], [detour_of(row) for row in rows]
    return np.where(reached, seconds, np.nan), np.where(reached, ways, np.nan)


def detour_of(row: ExerciseRow) -> float:
    """Path length over the shortest one; NaN without a path."""
    return detour(row.path_mm, row.shortest_mm, row.path_deg, row.shortest_deg)


def trial_lines(times: Sequence[HelpTimes]) -> tuple[Array | None, ...] | None:
    """For each of `TRIAL_HELPS` the seconds since the first pose at which each was finished, None
    for a help without times. None if no help was finished."""
    ends: Mapping[str, tuple[float, ...]] = {entry.help: entry.ends_s for entry in times}
    counts = {len(e) for e in ends.values()}
    if len(counts) != 1 or min(counts) < 2:
        return None
    return tuple(np.array(ends[help_]) if help_ in ends else None for help_ in TRIAL_HELPS)
