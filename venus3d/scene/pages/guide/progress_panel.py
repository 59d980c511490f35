"""How well the camera is known: views, predicted and achieved uncertainties, the sigmas' trend."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np
from viser import uplot

from venus3d.engine.amounts import figure
from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.convergence import Convergence, Progress, last_gain
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.forecast import Forecast
from venus3d.languages import number, translated
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.web.theme import Theme


def captured_words(count: int) -> str:
    """What stands after this number of views."""
    return say.VIEW_CAPTURED if count == 1 else say.VIEWS_CAPTURED


def progress_html(snapshot: Snapshot | None) -> str:
    """Views, uncertainties, the last view's gain, the next pose's purpose and expected gain."""
    if snapshot is None or (snapshot.calibration is None and snapshot.target is None):
        return f"<div class='v-progress'>{say.NOT_KNOWN_YET}</div>"
    parts = _summary(snapshot) + _outcome(snapshot) + _reason(snapshot)
    return f"<div class='v-progress'>{parts}</div>"


def _summary(snapshot: Snapshot) -> str:
    last = snapshot.history[-1] if snapshot.history else None
    count = snapshot.captured_count
    boxes = [(str(count), captured_words(count), "")]
    if last is not None:
        boxes.append((number(figure(last.rms_px)), say.RMS, say.RMS_HINT))
        boxes.append((number(figure(last.uncertainty_px)), say.UNCERTAINTY, say.UNCERTAINTY_HINT))
    cells = "".join(
        f"<div title='{escape(hint)}'><b>{value}</b> <span>{words}</span></div>"
        for value, words, hint in boxes
    )
    return f"<div class='v-big'>{cells}</div>"


def _outcome(snapshot: Snapshot) -> str:
    """The last view's gain, and how many more views it takes."""
    lines = [brought_text(snapshot.history)]
    if snapshot.forecast is not None and snapshot.phase != "finished":
        why = _unsettled_text(snapshot.convergence)
        lines.append(f"<b>{forecast_text(snapshot.forecast, why)}</b>")
    if snapshot.calibration is not None and snapshot.calibration.lens_reason:
        lines.append(escape(translated(snapshot.calibration.lens_reason)))
    return "".join(f"<div class='v-line'>{line}</div>" for line in lines if line)


def brought_text(history: Sequence[Progress]) -> str:
    """The last view's gain and its target's prediction; empty if unknown."""
    before, after = last_gain(history)
    if not np.isfinite(after):
        return ""
    now, promised = figure(after), history[-1].predicted_uncertainty_px
    if not np.isfinite(before):
        return say.LAST_VIEW_ALONE.format(now=now)
    extra = say.PROMISED.format(error=figure(promised)) if np.isfinite(promised) else ""
    return say.LAST_VIEW.format(before=figure(before), now=now, promised=extra)


def _unsettled_text(judged: Convergence | None) -> str:
    """How many parameters have not settled; empty if all have, or before they are judged."""
    if judged is None or judged.converged:
        return ""
    count, total = len(judged.unsettled), len(judged.parameters)
    if count == total:
        return say.FORECAST_NONE_SETTLED
    if count == 1:
        return say.FORECAST_ONE_UNSETTLED
    return say.FORECAST_SOME_UNSETTLED.format(count=count, all=total)


def forecast_text(forecast: Forecast, why: str = "") -> str:
    """About how many more views, with the interval; `why` more are asked for where the uncertainty
    is small enough."""
    goal = say.FORECAST_GOAL.format(error=forecast.wanted_px)
    low, high, views = forecast.low, forecast.high, forecast.views
    if views == 0:
        return say.FORECAST_REACHED.format(error=forecast.wanted_px, why=why)
    if views is None or low is None:
        least = forecast.looked_ahead if low is None else low
        return say.FORECAST_LEAST.format(least=least, goal=goal)
    if high is None:
        return say.FORECAST_OPEN.format(views=views, goal=goal, low=low)
    words = say.FORECAST_ONE if views == 1 else say.FORECAST_MANY
    words = words.format(views=views, goal=goal)
    return say.FORECAST_RANGE.format(words=words, low=low, high=high) if low < high else f"{words}."


def _promise(snapshot: Snapshot) -> str:
    target = snapshot.target
    # After a single view the noise, and so the next view's gain, is hardly known.
    if target is None or not np.isfinite(target.gain_px):
        return ""
    now, then = figure(target.uncertainty_px), figure(target.predicted_uncertainty_px)
    return say.PROMISE.format(now=now, then=then)


def _reason(snapshot: Snapshot) -> str:
    target = snapshot.target
    if target is None or not target.reason:
        return ""
    looked = say.LOOKED_AT.format(count=target.evaluated) if target.evaluated > 1 else ""
    serves = ", ".join(target.serves[:3])
    serves = say.SERVES.format(names=serves) if serves else ""
    small = f"<small>{escape(looked + serves)}</small>" if looked or serves else ""
    text = f"{translated(target.reason)} {_promise(snapshot)}".strip()
    reason = f"<div class='v-reason'>{escape(text)}{small}</div>"
    return f"<h3 title='{escape(say.WHAT_FOR_HINT)}'>{say.WHAT_FOR}</h3>{reason}"


def trend(history: tuple[Progress, ...]) -> tuple[Array, ...] | None:
    """View numbers, then each parameter's sigma relative to the first full calibration with this
    lens; None until two calibrations have estimated all parameters."""
    full = [e for e in history if e.names == history[-1].names and (e.sigma > 0).all()]
    if len(full) < 2:
        return None
    sigmas = np.array([entry.sigma for entry in full])
    relative = 100 * sigmas / sigmas[0]
    views = np.array([entry.views for entry in full], dtype=np.float64)
    return (views, *(relative[:, index].copy() for index in range(sigmas.shape[1])))


def trend_series(theme: Theme, names: Sequence[str]) -> tuple[uplot.Series, ...]:
    """Styles of the lines: one look per kind of parameter, in colours that mean nothing."""
    lens = len(names) - 4
    colours = [theme.good] * 2 + [theme.quiet] * (2 + lens)
    solid: tuple[float, ...] = ()
    dashes = [solid] * 4 + [(6.0, 5.0)] * lens
    series: list[uplot.Series] = [{"label": say.TREND_VIEWS}]
    for name, colour, dash in zip(names, colours, dashes, strict=True):
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
    """Caption of the plot: what it shows, and which line is which."""
    looks = zip((theme.good, theme.quiet, theme.quiet), "━━┅", say.TREND_KEYS, strict=True)
    keys = " &nbsp; ".join(
        f"<span style='color:{colour}'>{stroke} {name}</span>" for colour, stroke, name in looks
    )
    title = f"<h3 title='{escape(say.TREND_HINT)}'>{say.TREND_TITLE}</h3>"
    return f"<div class='v-progress'>{title}{keys}</div>"
