"""The practice page's texts as HTML: instruction, distance, results, keys."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from statistics import median
from typing import Any

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.exercise import detour
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.render.amounts import degrees
from venus3d.render.palette import STEP_STYLES
from venus3d.scene.pages.exercise import practice_texts as say
from venus3d.scene.pages.exercise.view_model import PracticeViewModel
from venus3d.scene.web.theme import Theme
from venus3d.storage.exercise import REACHED, ExerciseRow

_FAR_MM, _FAR_DEG = 300.0, 90.0  # a bar is full here


def card_html(view: PracticeViewModel, theme: Theme) -> str:
    """What to do now, in large letters; below it the numbers to change."""
    colour, badge, headline, sentence, amount = _card_of(view, theme)
    free = say.ALL_FREE
    if view.level < 6:
        names = [name for name, on in zip(say.FREE_NAMES, view.attempt.free, strict=True) if on]
        free = say.ONLY_FREE.format(names=", ".join(names))
    left = f"<em>{escape(amount)}</em>" if amount else ""
    small = " ".join([view.note, "" if view.stage == "reached" else free]).strip()
    first = "" if view.rows or view.stage == "hold" else f"<small>{say.HOW_TO}</small>"
    return (
        f"<div class='v-progress' style='--step:{colour}'><div class='v-do' "
        f"role='status'><header><span class='v-badge'>{badge}</span><b>{escape(headline)}</b>{left}"
        f"</header><p>{escape(sentence)}</p><small>{escape(small)}</small>{first}</div></div>"
    )


def _card_of(view: PracticeViewModel, theme: Theme) -> tuple[str, str, str, str, str]:
    good = theme.reached
    if view.stage == "reached":
        row = view.rows[-1]
        headline, ratio = say.REACHED_HEADLINE.format(seconds=row.seconds), detour_of(row)
        way = say.DETOUR_SENTENCE if ratio >= 1.05 else say.STRAIGHT_SENTENCE
        sentence = f"{way.format(detour=ratio)} {say.REACHED_SENTENCE}"
        return good, "✓", headline, sentence, ""
    if view.stage == "hold":
        return good, "✓", say.HOLD_HEADLINE, say.HOLD_SENTENCE, ""
    if view.help != "steps":
        return theme.info, "◎", say.HEADLINES[view.help], say.SENTENCES[view.help], ""
    step = view.match.steps[view.match.active_step - 1]
    style = STEP_STYLES[step.number - 1]
    amount = _amounts(view)[step.number - 1]
    colour = theme.steps[step.number - 1]
    return colour, str(step.number), style.title, step_prompt(step).camera, amount


def _amounts(view: PracticeViewModel) -> tuple[str, ...]:
    mm = float(np.linalg.norm(view.match.remaining_mm))
    return (f"{mm:.0f} mm", *(degrees(deg) for deg in view.match.remaining_deg))


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
            (f"{mm:.0f} mm", f"{largest:.0f}°"),
            (place, (_share(largest, _FAR_DEG), zone)),
            (match.within[0], all(match.within[1:])),
            (theme.info, theme.info),
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
    fact = f"{say.RIGHT} &nbsp;{escape(amount)}" if done else f"{escape(amount)} {say.TO_GO}"
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
        shortest = f"{view.attempt.shortest_mm:.0f} mm"
        boxes.append((f"{view.attempt.path_mm:.0f} mm", say.MOVED.format(shortest=shortest)))
    if any(view.attempt.free[:3]):
        shortest = f"{view.attempt.shortest_deg:.0f}°"
        boxes.append((f"{view.attempt.path_deg:.0f}°", say.TURNED.format(shortest=shortest)))
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


def detour_of(row: ExerciseRow) -> float:
    """Path length over the shortest one; NaN without a path."""
    return detour(row.path_mm, row.shortest_mm, row.path_deg, row.shortest_deg)


def _cells(row: ExerciseRow) -> str:
    reached, ratio = row.outcome == REACHED, detour_of(row)
    time = f"{row.seconds:.1f} s" if reached else say.GAVE_UP
    way = f"{ratio:.1f} ×" if reached and np.isfinite(ratio) else "–"
    cells = (f"{row.level}", say.SHORT_HELP_NAMES[row.help], time, way)
    return f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"


def plot_lines(rows: Sequence[ExerciseRow]) -> tuple[Array, Array, Array] | None:
    """For two plots: pose numbers, seconds, path ratios; None before two poses. Poses that were
    given up or have no path are NaN: a gap in the line."""
    reached = [row.outcome == REACHED for row in rows]
    if sum(reached) < 2:
        return None
    numbers = np.arange(1, len(rows) + 1, dtype=np.float64)
    lines = [[row.seconds for row in rows], [detour_of(row) for row in rows]]
    seconds, ways = (np.where(reached, line, np.nan) for line in lines)
    return numbers, seconds, ways


def series_of(label: str, theme: Theme) -> tuple[Any, ...]:
    """The style of one plot's line."""
    points = {"show": True, "size": 8}
    return (
        {"label": say.POSE_AXIS},
        {"label": label, "stroke": theme.steps[3], "width": 2, "points": points},
    )


def keys_html() -> str:
    """The keys that move the board, the mouse gestures, and the other keys."""
    head = "".join(f"<small>{name}</small>" for name in ("", *say.KEYS_HEAD))
    moves = "".join(
        f"<span>{_key(one)} {_key(other)}</span><span>{alone}</span><span>{shifted}</span>"
        for one, other, alone, shifted in say.MOVE_KEYS
    )
    mouse = "".join(f"<b>{how}</b><span>{what}</span>" for how, what in say.MOUSE_LINES)
    others = " &nbsp; ".join(f"{_key(key)} {what}" for key, what in say.OTHER_KEYS)
    return (
        f"<div class='v-progress'><h3>{say.KEYS_TITLE}</h3><div class='v-keylist'>{head}{moves}"
        f"</div><div class='v-keylist v-two'>{mouse}</div><div class='v-line'>{others}</div></div>"
    )


def legend_html(legend: str) -> str:
    """The legend below the picture."""
    return f"<div class='v-progress v-under'><div class='v-legend'>{escape(legend)}</div></div>"


def title_html(title: str) -> str:
    """The title above a picture."""
    return f"<div class='v-progress'><h3>{escape(title)}</h3></div>"


def _key(name: str) -> str:
    return f"<span class='v-key'>{name}</span>"
