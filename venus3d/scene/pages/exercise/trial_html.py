"""The trial page's texts as HTML: participant, progress, instruction, and the times at the end."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from statistics import median
from typing import Any

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.prompts import HOLD_STILL, NOT_SEEN
from venus3d.render.overlay import BOARD_FILL, OVERLAP_FILL, TARGET_FILL
from venus3d.render.palette import hex_of
from venus3d.scene.pages.exercise import trial_texts as say
from venus3d.scene.pages.exercise.trial_plan import HelpTimes, times_of
from venus3d.scene.pages.exercise.view_model import TRIAL_HELPS, TrialViewModel
from venus3d.scene.web.step_card import guide_card, hold_card, second_line, step_card, step_chips
from venus3d.scene.web.step_texts import FROM_UPRIGHT
from venus3d.scene.web.theme import Theme

_HELP_COLOURS: dict[str, int] = {"steps": 3, "axes": 2, "outline": 4}
"""Each help's colour in the plot, as the number of the step with that colour."""


def side_html(view: TrialViewModel) -> str:
    """The left column: participant, help, pose, time, and a remark."""
    if view.snapshot.number == 0:
        return f"<div class='v-progress'>{say.WAITING}</div>"
    place, helps = view.place, len(view.order)
    what = say.HELP_OF.format(place=place, helps=helps, name=say.HELP_NAMES[view.help])
    if view.stage == "over":
        what = say.ALL_DONE
    rows = "".join(_order_row(view, number) for number in range(1, helps + 1))
    return (
        f"<div class='v-progress'><div class='v-participant'>{escape(view.participant)}</div>"
        f"<div class='v-what'>{escape(what)}</div>{_counters(view)}"
        f"<h3>{say.ORDER_TITLE}</h3><div class='v-order'>{rows}</div>"
        f"<div class='v-remark'>{escape(view.note)}</div></div>"
    )


def _counters(view: TrialViewModel) -> str:
    if not view.is_running:
        return ""
    since = say.SINCE_START if view.number == 1 else say.SINCE_FIRST
    poses = say.OF_POSES.format(poses=view.poses)
    return (
        f"<div class='v-count'><div><b>{view.number} <small>{poses}</small></b>"
        f"<span>{say.POSE}</span></div>"
        f"<div><b>{clock(view.seconds)}</b><span>{since}</span></div></div>"
    )


def _order_row(view: TrialViewModel, number: int) -> str:
    help_ = view.order[number - 1]
    now = view.stage != "over" and number == view.place
    done = view.stage == "over" or number < view.place
    mark = "✓ " if done else f"{number} "
    return f"<div class='{'v-current' if now else ''}'>{mark}{say.HELP_NAMES[help_]}</div>"


def clock(seconds: float) -> str:
    """Elapsed minutes and whole seconds, m:ss."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def card_html(view: TrialViewModel, theme: Theme) -> str:
    """The large text above the picture: what comes, what to do; the same for each help."""
    if view.snapshot.number == 0:
        return _card(theme.info, "…", say.STARTING, say.WAITING)
    how = say.HOW[view.help]
    if view.stage == "over":
        return _card(theme.reached, "✓", say.DONE, say.DONE_SENTENCE)
    if view.stage == "ready":
        name = say.HELP_NAMES[view.help]
        return _card(theme.info, "▶", say.NEXT.format(name=name), how)
    if view.pose is None:
        return _card(theme.info, "?", say.NOT_SEEN, NOT_SEEN.holder)
    if view.stage == "hold":
        return _card(theme.reached, "✓", say.HOLD_STILL, HOLD_STILL.holder)
    headline = say.POSE_OF.format(pose=view.number, poses=view.poses)
    return _card(theme.info, str(view.number), headline, how)


def _card(colour: str, badge: str, headline: str, sentence: str) -> str:
    return (
        f"<div class='v-wide'><div class='v-guide v-card' style='--step:{colour}'>"
        f"<span class='v-badge'>{badge}</span><div><b>{escape(headline)}</b>"
        f"<span class='v-say'>{escape(sentence)}</span></div></div></div>"
    )


def steps_html(view: TrialViewModel, theme: Theme) -> str:
    """The large text of the steps, as in a guided calibration."""
    snapshot, remaining = view.snapshot, view.snapshot.remaining
    if remaining is None or remaining.from_upright:
        sentence, chips = snapshot.instruction.holder, step_chips(remaining, view.step, theme)
        below = f"{chips}{second_line(FROM_UPRIGHT)}" if chips else ""
        text = guide_card(theme.info, "?", snapshot.headline, sentence, below=below, note=view.note)
    elif remaining.is_over:
        text = hold_card(theme, remaining, view.step, view.note)
    else:
        text = step_card(remaining, view.step, theme, view.note)
    return f"<div class='v-wide'>{text}</div>"


def legend_html(view: TrialViewModel) -> str:
    """The legend below the picture."""
    if not view.is_running:
        return ""
    if view.help == "axes":
        keys = (f"<b>{escape(name)}</b>: {meaning}" for name, meaning in say.AXES_LEGEND)
        text = " &nbsp; ".join((*keys, say.AXES_MEANING))
    else:
        names = zip((TARGET_FILL, OVERLAP_FILL, BOARD_FILL), say.OUTLINE_LEGEND, strict=True)
        text = " &nbsp; ".join(f"{_swatch(colour)}{name}" for colour, name in names)
    return f"<div class='v-wide'><div class='v-steps v-key-line'>{text}</div></div>"


def _swatch(colour: Any) -> str:
    return f"<span class='v-swatch' style='background:{hex_of(colour)}'></span>"


def result_html(view: TrialViewModel, theme: Theme) -> str:
    """The times of each help at the end, and where they are written."""
    head = f"<tr>{''.join(f'<th>{title}</th>' for title in say.RESULT_HEAD)}</tr>"
    rows = "".join(_time_row(times, theme) for times in times_of(view.rows))
    written = escape(say.WRITTEN.format(path=view.written))
    return (
        f"<div class='v-wide'><div class='v-progress'><table class='v-times'>{head}{rows}"
        f"</table><div class='v-path'>{written}</div></div></div>"
    )


def _time_row(times: HelpTimes, theme: Theme) -> str:
    middle = f"{median(times.reached_s):.1f} s" if times.reached_s else "–"
    whole = clock(round(times.ends_s[-1])) if times.ends_s else "–"
    name = f"{_swatch(_colour(times.help, theme))}{say.HELP_NAMES[times.help]}"
    return f"<tr><td>{name}</td><td>{middle}</td><td>{whole}</td><td>{times.given_up}</td></tr>"


def _colour(help_: str, theme: Theme) -> tuple[int, int, int]:
    return theme.step_colours[_HELP_COLOURS[help_] - 1]


def progress_lines(times: Sequence[HelpTimes]) -> tuple[Array, ...] | None:
    """For a plot: pose numbers, then for each of `TRIAL_HELPS` the seconds since the first pose at
    which each was finished, zeros for a help without times. None if no help was finished."""
    ends = {entry.help: entry.ends_s for entry in times}
    count = max((len(e) for e in ends.values()), default=0)
    if count < 2 or any(len(e) != count for e in ends.values()):
        return None
    x = np.arange(1, count + 1, dtype=np.float64)
    return (x, *(np.array(ends.get(help_, (0.0,) * count)) for help_ in TRIAL_HELPS))


def progress_series(theme: Theme, shown: Sequence[str] = TRIAL_HELPS) -> tuple[Any, ...]:
    """Styles of those lines; a help without times is hidden."""
    series: list[dict[str, Any]] = [{"label": say.POSE}]
    for help_ in TRIAL_HELPS:
        series.append(
            {
                "label": say.HELP_NAMES[help_],
                "stroke": hex_of(_colour(help_, theme)),
                "width": 3,
                "points": {"show": True, "size": 8},
                "show": help_ in shown,
            }
        )
    return tuple(series)
