"""The parameters in a table: value, sigma and its trend, settled or not, meaning. A row opens,
by a click or Enter, and explains the parameter's effect on the picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.guidance.convergence import Progress
from venus3d.engine.guidance.prompts import PARAMETER_DESCRIPTIONS
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import number, translated
from venus3d.scene.pages.guide.uncertainty import texts

_IN_PIXELS = 4
"""Number of leading parameters in pixels; the others have no unit."""
_SPARK = (58.0, 16.0)
"""Width and height of a sparkline, CSS pixels."""


def parameters_html(snapshot: Snapshot | None) -> str:
    """The table of parameters; a sentence without any."""
    if snapshot is None or snapshot.calibration is None:
        return f"<div class='v-progress'>{escape(texts.NO_PARAMETERS)}</div>"
    rows = "".join(_row(snapshot, index) for index in range(len(snapshot.calibration.free)))
    shared = _shared_errors_text(snapshot.calibration)
    hint = f"<div class='v-more'>{escape(texts.PARAMETERS_HINT)}{escape(shared)}</div>"
    title = f"<h3 title='{escape(texts.SIGMA_HINT)}'>{escape(texts.PARAMETERS_TITLE)}</h3>"
    return f"<div class='v-progress'>{title}{rows}{hint}</div>"


def _shared_errors_text(calibration: Calibration) -> str:
    """Why sigma is larger than other programs': nothing unless the residuals show shared errors."""
    if calibration.corner_errors.shared_px == 0:
        return ""
    return " " + texts.SHARED_ERRORS.format(noise_only=f"{calibration.sigma_noise_only[0]:.2g}")


def value_text(value: float, sigma: float, index: int) -> str:
    """Value ± sigma of the parameter of this index, with their significant figures."""
    unit = f" {texts.PIXELS}" if index < _IN_PIXELS else ""
    shown, spread = figures(value, sigma, index)
    return f"{shown} <i>± {spread}{unit}</i>" if spread else f"{shown}{unit}"


def figures(value: float, sigma: float, index: int) -> tuple[str, str]:
    """The same without the unit, apart; no sigma for a parameter held fixed."""
    if not sigma > 0:
        return number(f"{value:.1f}" if index < _IN_PIXELS else f"{value:.4f}"), ""
    # Two figures of the sigma are significant.
    places = min(max(1 - math.floor(math.log10(sigma)), 0), 6)
    return number(f"{value:.{places}f}"), number(f"{sigma:.{places}f}")


def sparkline(history: Sequence[Progress], index: int) -> str:
    """The sigma of the parameter of this index from view to view, as a small plot with a
    logarithmic scale; empty before two values."""
    sigmas = [float(entry.sigma[index]) for entry in _comparable(history)]
    if len(sigmas) < 2:
        return ""
    width, height = _SPARK
    levels = np.log(sigmas)
    span = max(float(np.ptp(levels)), math.log(2.0))
    x = np.linspace(2.0, width - 3.0, len(levels))
    y = 2.5 + (height - 5.0) * (levels.max() - levels) / span
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
    said = escape(texts.TREND_ALT.format(percent=f"{100 * sigmas[-1] / sigmas[0]:.0f}"))
    return (
        f"<svg class='v-spark' width='{width:.0f}' height='{height:.0f}' role='img' "
        f"aria-label='{said}'><title>{said}</title>"
        f"<polyline points='{points}'/><circle cx='{x[-1]:.1f}' cy='{y[-1]:.1f}' r='2.2'/></svg>"
    )


def _comparable(history: Sequence[Progress]) -> list[Progress]:
    """Those with all parameters estimated, of the lens that the last one has."""
    return [
        entry for entry in history if entry.names == history[-1].names and (entry.sigma > 0).all()
    ]


def _row(snapshot: Snapshot, index: int) -> str:
    calibration, judged = snapshot.calibration, snapshot.convergence
    if calibration is None:
        return ""
    if not calibration.free[index]:
        mark, kind = texts.NOT_YET, ""
    elif judged is not None and judged.parameters[index]:
        mark, kind = texts.SETTLED, " v-yes"
    else:
        mark, kind = texts.IMPROVING, ""
    value, sigma = calibration.camera.parameters[index], calibration.sigma[index]
    name = calibration.camera.parameter_names[index]
    sentence = escape(texts.PARAMETER_SENTENCES[name])
    return (
        f"<details class='v-row v-param'><summary title='{sentence}'><b>{name}</b>"
        f"<span class='v-word'>{translated(PARAMETER_DESCRIPTIONS[name])}</span>"
        f"<span class='v-mark{kind}'>{mark}</span>"
        f"<span class='v-value'>{value_text(float(value), float(sigma), index)}</span>"
        f"{sparkline(snapshot.history, index)}</summary>"
        f"<div class='v-does'>{sentence}</div></details>"
    )
