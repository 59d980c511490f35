"""How well the camera is known: views, each parameter with its sigma, the trend of the sigmas."""

from __future__ import annotations

import math
from html import escape

import numpy as np
from viser import uplot

from venus3d.engine.camera import PARAMETERS
from venus3d.engine.pose import Array
from venus3d.engine.snapshot import Progress, Snapshot
from venus3d.engine.words import PARAMETER_WORDS
from venus3d.scene.style import Theme

_IN_PIXELS = 4
"""The first four parameters are in pixels, the others have no unit."""


def progress_html(snapshot: Snapshot | None) -> str:
    """Views, errors, what the next pose is for, and the table of parameters."""
    if snapshot is None or (snapshot.calibration is None and snapshot.target is None):
        return (
            "<div class='v-progress'>The camera is not known yet. "
            "After the first view its parameters appear here.</div>"
        )
    parts = _summary(snapshot) + _reason(snapshot) + _table(snapshot)
    return f"<div class='v-progress'>{parts}</div>"


def _summary(snapshot: Snapshot) -> str:
    last = snapshot.history[-1] if snapshot.history else None
    boxes = [(str(len(snapshot.views)), "views captured")]
    if last is not None:
        boxes.append((_short(last.rms_px), "px rms, misfit of the corners"))
        boxes.append((_short(last.error_px), "px, error to expect in the image"))
    cells = "".join(f"<div><b>{value}</b><span>{words}</span></div>" for value, words in boxes)
    return f"<div class='v-big'>{cells}</div>"


def _reason(snapshot: Snapshot) -> str:
    target = snapshot.target
    if target is None:
        return ""
    looked = f"Best of {target.evaluated} poses looked at. " if target.evaluated > 1 else ""
    serves = ", ".join(target.serves[:3])
    serves = f"Helps most: {serves}." if serves else ""
    small = f"<small>{escape(looked + serves)}</small>" if looked or serves else ""
    reason = f"<div class='v-reason'>{escape(target.reason)}{small}</div>"
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
