"""Texts of practice and trial as HTML: what to do, how far it is, results, keys."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from statistics import median
from typing import Any

import numpy as np

from venus3d.engine.amounts import degrees, size_deg, size_mm
from venus3d.engine.guidance.prompts import HOLD_STILL, NOT_SEEN
from venus3d.engine.guidance.remaining import instruction
from venus3d.languages import number, translated
from venus3d.render.palette import STEP_STYLES, hex_of
from venus3d.render.trial_helps import BOARD_FILL, OVERLAP_FILL, TARGET_FILL
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.plots import HELP_COLOURS, detour_of
from venus3d.scene.pages.exercise.trial_plan import HelpTimes
from venus3d.scene.pages.exercise.view_model import PracticeViewModel, TrialViewModel
from venus3d.scene.web import step_texts
from venus3d.scene.web.board_keys import board_keys_html, key_html
from venus3d.scene.web.step_card import (
    guide_card,
    hold_card,
    second_line,
    step_card,
    step_chips,
)
from venus3d.scene.web.theme import Theme
from venus3d.storage.exercise import REACHED, ExerciseRow

_FAR_MM, _FAR_DEG = 300.0, 90.0  # a bar is full here


def practice_card_html(view: PracticeViewModel, theme: Theme) -> str:
    """What to do now, in large letters; below it the numbers to change."""
    colour, badge, headline, sentence, amount = _practice_card(view, theme)
    free = say.ALL_FREE
    if view.level < 6:
        names = [name for name, on in zip(say.FREE_NAMES, view.attempt.free, strict=True) if on]
        free = say.ONLY_FREE.format(names=", ".join(names))
    left = f"<em>{escape(amount)}</em>" if amount else ""
    small = " ".join([view.note, "" if view.stage == "reached" else free]).strip()
    how_to = f"<small class='v-how-to'>{say.HOW_TO}</small>"
    first = "" if view.rows or view.stage == "hold" else how_to
    return (
        f"<div class='v-progress' style='--step:{colour}'><div class='v-do' "
        f"role='status'><header><span class='v-badge'>{badge}</span><b>{escape(headline)}</b>{left}"
        f"</header><p>{escape(sentence)}</p><small>{escape(small)}</small>{first}</div></div>"
    )


def _practice_card(view: PracticeViewModel, theme: Theme) -> tuple[str, str, str, str, str]:
    good = theme.reached
    if view.stage == "reached":
        row = view.rows[-1]
        headline, ratio = say.REACHED_HEADLINE.format(seconds=row.seconds), detour_of(row)
        way = say.DETOUR_SENTENCE if ratio >= 1.05 else say.STRAIGHT_SENTENCE
        sentence = f"{way.format(detour=ratio)} {say.REACHED_SENTENCE}"
        return good, "✓", headline, sentence, ""
    if view.stage == "hold":
        return good, "✓", say.HOLD_STILL, say.HOLD_SENTENCE, ""
    if view.help != "steps":
        return theme.quiet, "◎", say.HEADLINES[view.help], say.SENTENCES[view.help], ""
    step = view.match.steps[view.match.active_step - 1]
    style = STEP_STYLES[step.number - 1]
    amount = _amounts(view)[step.number - 1]
    colour = theme.steps[step.number - 1]
    words = translated(instruction(step, view.match).camera)
    return colour, str(step.number), style.title, words, amount


def _amounts(view: PracticeViewModel) -> tuple[str, ...]:
    mm = float(np.linalg.norm(view.match.remaining_mm))
    return (size_mm(mm), *(degrees(deg) for deg in view.match.remaining_deg))


def bars_html(view: PracticeViewModel, theme: Theme) -> str:
    """Distance to the target: with the steps a bar for each; otherwise one for position and one for
    the largest turn, since the other helps must not reveal more."""
    match = view.match
    mm, turns = float(np.linalg.norm(match.remaining_mm)), np.abs(match.remaining_deg)
    place = _share(mm, _FAR_MM), _share(match.limit_mm, _FAR_MM)
    zone = _share(match.limit_deg, _FAR_DEG)
    if view.help == "steps":
        shares = (place, *((_share(float(turn), _FAR_DEG), zone) for turn in turns))
        rows = zip(
            ("1", "2", "3", "4"),
            say.STEP_BARS,
            _amounts(view),
            shares,
            match.within,
            theme.steps,
            strict=True,
        )
    else:
        largest = float(turns.max())
        rows = zip(
            ("↔", "↻"),
            (say.PLACE_BAR, say.TURN_BAR),
            (size_mm(mm), size_deg(largest)),
            (place, (_share(largest, _FAR_DEG), zone)),
            (match.within[0], all(match.within[1:])),
            (theme.quiet, theme.quiet),
            strict=True,
        )
    # Numbers that this level leaves alone are right from the start and would distract.
    free = view.attempt.free
    asked = (any(free[3:]), *free[:3]) if view.help == "steps" else (any(free[3:]), any(free[:3]))
    bars = "".join(_bar(*row) for row, on in zip(rows, asked, strict=True) if on)
    legend = f"<div class='v-legend'>{say.BARS_LEGEND}</div>"
    return f"<div class='v-progress'><h3>{say.BARS_TITLE}</h3>{bars}{legend}</div>"


def _share(value: float, far: float) -> float:
    """Percent of a bar; a square-root scale, so that small rests are visible."""
    return 100 * float(np.sqrt(min(value / far, 1.0)))


def _bar(
    badge: str, name: str, amount: str, shares: tuple[float, float], done: bool, colour: str
) -> str:
    fact = f"{say.DONE_MARK} &nbsp;{escape(amount)}" if done else f"{escape(amount)} {say.TO_GO}"
    return (
        f"<div class='v-bar{' v-done' if done else ''}' style='--step:{colour}'>"
        f"<span class='v-badge'>{badge}</span><span>{escape(name)}</span><i>{fact}</i>"
        f"<div class='v-track'><span style='width:{shares[0]:.1f}%'></span>"
        f"<u style='width:{shares[1]:.1f}%'></u></div></div>"
    )


def clock_html(view: PracticeViewModel) -> str:
    """Time and path length of this pose."""
    boxes = [(f"{view.seconds:.0f} {say.TIME_UNIT}", say.TIME)]
    if any(view.attempt.free[3:]):
        shortest = size_mm(view.attempt.shortest_mm)
        boxes.append((size_mm(view.attempt.path_mm), say.MOVED.format(shortest=shortest)))
    if any(view.attempt.free[:3]):
        shortest = size_deg(view.attempt.shortest_deg)
        boxes.append((size_deg(view.attempt.path_deg), say.TURNED.format(shortest=shortest)))
    inside = "".join(f"<div><b>{value}</b><span>{name}</span></div>" for value, name in boxes)
    return f"<div class='v-progress'><div class='v-big v-clock'>{inside}</div></div>"


def results_html(view: PracticeViewModel) -> str:
    """The latest poses, newest first, and where all of them are written."""
    rows = view.rows
    if not rows:
        return (
            f"<div class='v-progress'><h3>{say.RESULTS_TITLE}</h3>"
            f"<div class='v-legend'>{say.NO_RESULTS}</div></div>"
        )
    head = "".join(f"<th>{name}</th>" for name in say.RESULTS_HEAD)
    cells = "".join(_cells(row) for row in rows[:-6:-1])
    times = [row.seconds for row in rows if row.outcome == REACHED]
    total = ""
    if times:
        total = say.RESULTS_SUM.format(reached=len(times), all=len(rows), median=median(times))
    written = say.WRITTEN.format(path=view.written) if view.written else ""
    return (
        f"<div class='v-progress'><h3>{say.RESULTS_TITLE}</h3><table class='v-list'>"
        f"<tr>{head}</tr>{cells}</table><div class='v-line'>{total}</div>"
        f"<div class='v-file'>{escape(written)}</div></div>"
    )


def _cells(row: ExerciseRow) -> str:
    reached, ratio = row.outcome == REACHED, detour_of(row)
    time = f"✓ {number(f'{row.seconds:.1f}')} s" if reached else f"✕ {say.GAVE_UP}"
    way = f"{number(f'{ratio:.1f}')} ×" if reached and np.isfinite(ratio) else "–"
    mark = "v-right" if reached else "v-wrong"
    return (
        f"<tr><td>{row.level}</td><td>{escape(say.SHORT_HELP_NAMES[row.help])}</td>"
        f"<td class='{mark}'>{escape(time)}</td><td>{way}</td></tr>"
    )


def keys_html() -> str:
    """The keys that move the board, the mouse gestures, and the other keys."""
    mouse = "".join(f"<b>{how}</b><span>{what}</span>" for how, what in say.MOUSE_LINES)
    others = " &nbsp; ".join(f"{key_html(key)} {what}" for key, what in say.OTHER_KEYS)
    return (
        f"<div class='v-progress v-all-keys'><h3>{say.KEYS_TITLE}</h3><div class='v-keylist'>"
        f"{board_keys_html()}</div><div class='v-keylist v-two'>{mouse}</div>"
        f"<div class='v-line'>{others}</div></div>"
    )


def practice_legend_html(legend: str, *, two: bool) -> str:
    """The legend below the picture; `two`: another picture follows."""
    marks = " ".join(["v-progress", "v-under", *(["v-two-pictures"] if two else [])])
    return f"<div class='{marks}'><div class='v-legend'>{escape(legend)}</div></div>"


def title_html(title: str) -> str:
    """The title above a picture."""
    return f"<div class='v-progress'><h3>{escape(title)}</h3></div>"


# -- the trial -------------------------------------------------------------------------------------


def side_html(view: TrialViewModel) -> str:
    """The left column: participant, help, pose, time, and a remark."""
    if view.snapshot.number == 0:
        return f"<div class='v-progress'>{say.WAITING}</div>"
    place, helps = view.place, len(view.order)
    what = say.HELP_OF.format(place=place, helps=helps, name=say.TRIAL_HELP_NAMES[view.help])
    if view.stage == "over":
        what = say.ALL_DONE
    rows = "".join(_order_row(view, number) for number in range(1, helps + 1))
    return (
        f"<div class='v-progress'><div class='v-participant'>{escape(view.participant)}</div>"
        f"<div class='v-what'>{escape(what)}</div>{_counters(view)}"
        f"<h3>{say.ORDER_TITLE}</h3><div class='v-order'>{rows}</div>"
        f"<div class='v-remark'>{escape(translated(view.note))}</div></div>"
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
    mark = "<b class='v-right'>✓</b> " if done else f"{number} "
    return f"<div class='{'v-current' if now else ''}'>{mark}{say.TRIAL_HELP_NAMES[help_]}</div>"


def clock(seconds: float) -> str:
    """Elapsed minutes and whole seconds, m:ss."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def trial_card_html(view: TrialViewModel, theme: Theme) -> str:
    """The large text above the picture: what comes, what to do; the same for each help."""
    if view.snapshot.number == 0:
        return _card(theme.quiet, "…", say.STARTING, say.WAITING)
    how = say.HOW[view.help]
    if view.stage == "over":
        return _card(theme.reached, "✓", say.DONE, say.DONE_SENTENCE)
    if view.stage == "ready":
        name = say.TRIAL_HELP_NAMES[view.help]
        return _card(theme.quiet, "▸", say.NEXT_HELP.format(name=name), how)
    if view.pose is None:
        return _card(theme.info, "?", say.NOT_SEEN, NOT_SEEN.holder)
    if view.stage == "hold":
        return _card(theme.reached, "✓", say.HOLD_STILL, HOLD_STILL.holder)
    headline = say.POSE_OF.format(pose=view.number, poses=view.poses)
    return _card(theme.quiet, str(view.number), headline, how)


def _card(colour: str, badge: str, headline: str, sentence: str) -> str:
    return (
        f"<div class='v-wide'><div class='v-guide v-card' style='--step:{colour}'>"
        f"<span class='v-badge'>{badge}</span><div><b>{escape(headline)}</b>"
        f"<span class='v-say'>{escape(translated(sentence))}</span></div></div></div>"
    )


def steps_html(view: TrialViewModel, theme: Theme) -> str:
    """The large text of the steps, as in a guided calibration."""
    snapshot, remaining = view.snapshot, view.snapshot.remaining
    if remaining is None or remaining.from_upright:
        sentence, chips = snapshot.instruction.holder, step_chips(remaining, view.step, theme)
        below = f"{chips}{second_line(step_texts.FROM_UPRIGHT)}" if chips else ""
        text = guide_card(theme.info, "?", snapshot.headline, sentence, below=below)
    elif remaining.is_over:
        text = hold_card(theme, remaining, view.step)
    else:
        text = step_card(remaining, view.step, theme)
    return f"<div class='v-wide'>{text}</div>"


def trial_legend_html(view: TrialViewModel) -> str:
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


def times_html(view: TrialViewModel, times: Sequence[HelpTimes], theme: Theme) -> str:
    """The times of each help at the end, and where they are written."""
    head = f"<tr>{''.join(f'<th>{title}</th>' for title in say.TIMES_HEAD)}</tr>"
    rows = "".join(_time_row(entry, theme) for entry in times)
    written = escape(say.WRITTEN.format(path=view.written))
    return (
        f"<div class='v-wide'><div class='v-progress'><table class='v-times'>{head}{rows}"
        f"</table><div class='v-path'>{written}</div></div></div>"
    )


def _time_row(times: HelpTimes, theme: Theme) -> str:
    middle = f"{number(f'{median(times.reached_s):.1f}')} s" if times.reached_s else "–"
    whole = clock(round(times.ends_s[-1])) if times.ends_s else "–"
    name = f"{_swatch(_colour(times.help, theme))}{say.TRIAL_HELP_NAMES[times.help]}"
    return f"<tr><td>{name}</td><td>{middle}</td><td>{whole}</td><td>{times.given_up}</td></tr>"


def _colour(help_: str, theme: Theme) -> tuple[int, int, int]:
    return theme.step_colours[HELP_COLOURS[help_] - 1]
