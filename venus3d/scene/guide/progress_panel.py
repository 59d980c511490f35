"""How well the camera is known: views, errors promised and come, parameters, the sigmas' trend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np
from viser import uplot

from venus3d.engine.camera import PARAMETERS
from venus3d.engine.pose import Array
from venus3d.engine.snapshot import Forecast, Progress, Snapshot
from venus3d.engine.words import PARAMETER_WORDS
from venus3d.scene.style import Theme

_IN_PIXELS = 4
"""The first four parameters are in pixels, the others have no unit."""


def progress_html(snapshot: Snapshot | None) -> str:
    """Views, errors, what the last view brought, what the next pose is for and should bring."""
    if snapshot is None or (snapshot.calibration is None and snapshot.target is None):
        return (
            "<div class='v-progress'>The camera is not known yet. "
            "After the first view its parameters appear here.</div>"
        )
    parts = _summary(snapshot) + _outcome(snapshot) + _reason(snapshot)
    return f"<div class='v-progress'>{parts}</div>"


def parameters_html(snapshot: Snapshot | None) -> str:
    """The table of parameters."""
    return "" if snapshot is None else f"<div class='v-progress'>{_table(snapshot)}</div>"


def _summary(snapshot: Snapshot) -> str:
    last = snapshot.history[-1] if snapshot.history else None
    boxes = [(str(len(snapshot.views)), "views captured")]
    if last is not None:
        boxes.append((_short(last.rms_px), "px rms, misfit of the corners"))
        boxes.append((_short(last.error_px), "px, error to expect in the image"))
    cells = "".join(f"<div><b>{value}</b><span>{words}</span></div>" for value, words in boxes)
    return f"<div class='v-big'>{cells}</div>"


def _outcome(snapshot: Snapshot) -> str:
    """What the last view brought, and how many more it takes."""
    lines = [brought_text(snapshot.history)]
    if snapshot.forecast is not None and snapshot.phase != "finished":
        goes_on = snapshot.phase == "guiding"
        lines.append(f"<b>{forecast_text(snapshot.forecast, goes_on=goes_on)}</b>")
    return "".join(f"<div class='v-line'>{line}</div>" for line in lines if line)


def brought_text(history: Sequence[Progress]) -> str:
    """What the last view brought and what its target had promised; empty if unknown.

    Unknown it is, too, once an earlier view was dropped: nobody calibrated without just this one.
    """
    if not history or not np.isfinite(history[-1].error_px):
        return ""
    if history[-1].views != (history[-2].views if len(history) > 1 else 0) + 1:
        return ""
    before = history[-2].error_px if len(history) > 1 else np.nan
    now, promised = px_text(history[-1].error_px), history[-1].predicted_error_px
    if not np.isfinite(before):
        return f"The last view brought the error to {now} px."
    extra = f" (promised {px_text(promised)})" if np.isfinite(promised) else ""
    return f"The last view: {px_text(before)} → {now} px{extra}."


def px_text(error_px: float) -> str:
    """An error with the figures it is worth."""
    return f"{error_px:.2f}" if error_px >= 0.1 else f"{error_px:.3f}"


def forecast_text(forecast: Forecast, *, goes_on: bool = False) -> str:
    """About how many more views, with the interval; `goes_on` if guidance does although none is
    needed."""
    goal = f"until {forecast.wanted_px:g} px"
    low, high, views = forecast.low, forecast.high, forecast.views
    if views == 0:
        why = "; some parameters are still to settle" if goes_on else ""
        return f"The error is below {forecast.wanted_px:g} px already{why}."
    if views is None or low is None:
        least = forecast.looked_ahead if low is None else low
        return f"{least} more views or more {goal}."
    if high is None:
        return f"About {views} more views {goal} ({low} or more)."
    words = f"About {views} more view{'' if views == 1 else 's'} {goal}"
    return f"{words} ({low} to {high})." if low < high else f"{words}."


def _promise(snapshot: Snapshot) -> str:
    target = snapshot.target
    # After a single view the noise is hardly known, so neither is what the next one brings.
    if target is None or not np.isfinite(target.gain_px):
        return ""
    return (
        f"It should bring the error from {px_text(target.error_px)} to "
        f"{px_text(target.predicted_error_px)} px."
    )


def _reason(snapshot: Snapshot) -> str:
    target = snapshot.target
    if target is None:
        return ""
    looked = f"{target.evaluated} poses were looked at. " if target.evaluated > 1 else ""
    serves = ", ".join(target.serves[:3])
    serves = f"Helps most: {serves}." if serves else ""
    small = f"<small>{escape(looked + serves)}</small>" if looked or serves else ""
    text = f"{target.reason} {_promise(snapshot)}".strip()
    reason = f"<div class='v-reason'>{escape(text)}{small}</div>"
    return f"<h3>What pose {target.number} is for</h3>{reason}"


def _table(snapshot: Snapshot) -> str:
    calibration = snapshot.calibration
    if calibration is None:
        return ""
    settled = (False,) * 9
    if snapshot.convergence is not None:
        settled = snapshot.convergence.parameters
    rows: list[str] = []
    values, sigmas = calibration.camera.parameters, calibration.sigma
    for index, name in enumerate(PARAMETERS):
        if not calibration.free[index]:
            mark, kind = "not yet estimated", ""
        elif settled[index]:
            mark, kind = "✓ settled", " v-yes"
        else:
            mark, kind = "improving", ""
        amount = _value_text(values[index], sigmas[index], index)
        rows.append(
            f"<div class='v-row'><b>{name}</b><span class='v-word'>{PARAMETER_WORDS[index]}</span>"
            f"<span class='v-mark{kind}'>{mark}</span><span class='v-value'>{amount}</span></div>"
        )
    return "<h3>Camera parameters, value ± one sigma</h3>" + "".join(rows)


def _value_text(value: float, sigma: float, index: int) -> str:
    unit = " px" if index < _IN_PIXELS else ""
    if not sigma > 0:
        return f"{value:.1f}{unit}" if index < _IN_PIXELS else f"{value:.4f}"
    # Two figures of the sigma are all that it is worth.
    places = min(max(1 - math.floor(math.log10(sigma)), 0), 6)
    return f"{value:.{places}f} <i>± {sigma:.{places}f}{unit}</i>"


def _short(value: float) -> str:
    return "–" if not np.isfinite(value) else f"{value:.3f}" if value < 1 else f"{value:.2f}"


def trend(history: tuple[Progress, ...]) -> tuple[Array, ...] | None:
    """Numbers of views, then nine sigmas over those of the first full calibration.

    None until two calibrations estimated all nine parameters.
    """
    full = [entry for entry in history if (entry.sigma > 0).all()]
    if len(full) < 2:
        return None
    sigmas = np.array([entry.sigma for entry in full])
    relative = 100 * sigmas / sigmas[0]
    views = np.array([entry.views for entry in full], dtype=np.float64)
    return (views, *(relative[:, index].copy() for index in range(9)))


def trend_series(theme: Theme) -> tuple[uplot.Series, ...]:
    """Looks of the nine lines: one colour for each kind of parameter."""
    colours = [theme.info] * 2 + [theme.good] * 2 + [theme.quiet] * 5
    solid: tuple[float, ...] = ()
    dashes = [solid] * 4 + [(6.0, 5.0)] * 5
    series: list[uplot.Series] = [{"label": "views"}]
    for name, colour, dash in zip(PARAMETERS, colours, dashes, strict=True):
        series.append(
            {
                "label": name,
                "stroke": colour,
                "width": 2,
                "dash": dash,
                "points": {"show": False},
            }
        )
    return tuple(series)


def trend_caption(theme: Theme) -> str:
    """Words for the plot: what it shows, and which line is which."""
    return (
        "<div class='v-progress'><h3>Sigma over the views (first full set = 100 %)</h3>"
        f"<span style='color:{theme.info}'>━ focal length</span> &nbsp; "
        f"<span style='color:{theme.good}'>━ centre</span> &nbsp; "
        f"<span style='color:{theme.quiet}'>┅ distortion</span></div>"
    )
