"""What a trial's page says: who and where we are, what to do, and at the end how long it took."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from statistics import median
from typing import Any

import numpy as np

from venus3d.engine.pose import Array
from venus3d.engine.words import HOLD_STILL, NOT_SEEN
from venus3d.scene.overlay import BOARD_FILL, OVERLAP_FILL, TARGET_FILL
from venus3d.scene.palette import hex_of
from venus3d.scene.style import Theme
from venus3d.scene.trial.moment import HELPS, Help, HelpTimes, TrialMoment

HELP_NAMES: dict[Help, str] = {
    "steps": "the four steps",
    "axes": "the axes",
    "outline": "the filled outline",
}
_HOW: dict[Help, str] = {
    "steps": "Do what the large text says, one step at a time: move the board, then turn it.",
    "axes": "Bring the board's axes (solid) onto the target's (dashed): X onto X', Y onto Y', "
    "Z onto Z'.",
    "outline": "Cover the orange shape with the board until all of it is blue. The spike marks the "
    "top edge.",
}
_HELP_COLOURS: dict[Help, int] = {"steps": 3, "axes": 2, "outline": 4}
"""Each help's colour in the plot, by the step that has it elsewhere."""

_SHEET = """<style>
.v-card{display:flex;align-items:center;gap:1.4cqw;padding:.2cqw 1.2cqw .8cqw;
min-height:0!important;flex-direction:row!important}
.mantine-ScrollArea-root:has(.v-card) img{width:100%}
.v-card .v-badge{width:5cqw;height:5cqw;font-size:3.2cqw}
.v-card b{display:block;font-size:3.4cqw;line-height:1.1;font-weight:750}
.v-card span.v-say{display:block;font-size:2.1cqw;line-height:1.25;margin-top:.3cqw}
.v-key-line{font-size:2cqw;line-height:1.3;color:var(--soft);padding:.3cqw 1.2cqw!important}
.v-key-line b{color:var(--text)}
.v-who{font-size:26px;font-weight:750;line-height:1.15;overflow-wrap:anywhere}
.v-what{font-size:19px;color:var(--soft);line-height:1.25;margin-bottom:8px}
.v-count{display:grid;grid-template-columns:1fr 1fr;gap:8px;margin:8px 0}
.v-count div{background:var(--tile);border-radius:7px;padding:6px 10px}
.v-count b{display:block;font-size:46px;line-height:1.05;font-weight:780;white-space:nowrap}
.v-count small{font-size:20px;font-weight:600;color:var(--soft)}
.v-count span{font-size:14px;color:var(--soft)}
.v-remark{font-size:16px;line-height:1.3;color:var(--info);margin-top:10px}
.v-order{font-size:15px;line-height:1.55}
.v-order div{padding:1px 8px;border-left:4px solid transparent;color:var(--soft)}
.v-order .v-now{border-left-color:var(--info);color:var(--text);font-weight:700}
.v-times{border-collapse:collapse;width:100%;font-size:2.4cqw;margin:.6cqw 0}
.v-times td,.v-times th{padding:.5cqw 1.2cqw;border-bottom:1px solid var(--line);text-align:right;
font-weight:650;white-space:nowrap}
.v-times th{color:var(--soft);font-size:1.8cqw;font-weight:600;white-space:normal}
.v-times td:first-child,.v-times th:first-child{text-align:left}
.v-path{font-size:1.9cqw;color:var(--soft);overflow-wrap:anywhere}
.v-swatch{display:inline-block;width:1em;height:.75em;border-radius:2px;margin:0 .35em 0 .1em}
</style>"""


def side_html(moment: TrialMoment | None, note: str = "") -> str:
    """The left column: participant, help, pose, time; and a remark."""
    if moment is None:
        return "<div class='v-progress'>Waiting for the first picture.</div>"
    place, helps = moment.place, len(moment.order)
    what = f"Help {place} of {helps}: {HELP_NAMES[moment.help]}"
    if moment.stage == "over":
        what = "All done, thank you"
    rows = "".join(_order_row(moment, number) for number in range(1, helps + 1))
    return (
        f"{_SHEET}<div class='v-progress'><div class='v-who'>{escape(moment.participant)}</div>"
        f"<div class='v-what'>{escape(what)}</div>{_counters(moment)}"
        f"<h3>Order of the helps</h3><div class='v-order'>{rows}</div>"
        f"<div class='v-remark'>{escape(note)}</div></div>"
    )


def _counters(moment: TrialMoment) -> str:
    if moment.stage != "running":
        return ""
    since = "since the start" if moment.pose == 1 else "since the first pose"
    return (
        f"<div class='v-count'><div><b>{moment.pose} <small>of {moment.poses}</small></b>"
        f"<span>pose</span></div><div><b>{clock(moment.elapsed_s)}</b><span>{since}</span></div>"
        "</div>"
    )


def _order_row(moment: TrialMoment, number: int) -> str:
    help_ = moment.order[number - 1]
    now = moment.stage != "over" and number == moment.place
    done = moment.stage == "over" or number < moment.place
    mark = "✓ " if done else f"{number} "
    return f"<div class='{'v-now' if now else ''}'>{mark}{HELP_NAMES[help_]}</div>"


def clock(seconds: float) -> str:
    """Minutes and whole seconds that have passed, m:ss."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def card_html(moment: TrialMoment | None, theme: Theme, *, seen: bool) -> str:
    """The large text above the picture: what comes, what to do; the same for each help."""
    if moment is None:
        return _card(theme.info, "…", "Starting", "Waiting for the first picture.")
    how = _HOW[moment.help]
    if moment.stage == "over":
        return _card(theme.good, "✓", "Done, thank you", "How long each help took:")
    if moment.stage == "ready":
        name = HELP_NAMES[moment.help]
        return _card(theme.info, "▶", f"Next: {name}. Press Start when ready.", how)
    if not seen:
        return _card(theme.info, "?", "Board not seen", NOT_SEEN.holder)
    if moment.there:
        return _card(theme.good, "✓", "Hold still", HOLD_STILL.holder)
    return _card(theme.info, str(moment.pose), f"Pose {moment.pose} of {moment.poses}", how)


def _card(colour: str, badge: str, headline: str, sentence: str) -> str:
    return (
        f"{_SHEET}<div class='v-wide'><div class='v-guide v-card' style='--step:{colour}'>"
        f"<span class='v-badge'>{badge}</span><div><b>{escape(headline)}</b>"
        f"<span class='v-say'>{escape(sentence)}</span></div></div></div>"
    )


def legend_html(moment: TrialMoment | None) -> str:
    """Under the picture: what is drawn in it."""
    if moment is None or moment.stage != "running":
        return ""
    if moment.help == "axes":
        text = (
            "<b>Solid X Y Z</b>: the board &nbsp; <b>dashed X' Y' Z'</b>: the target &nbsp; "
            "X to the right, Y down, Z out of the back"
        )
    else:
        names = ((TARGET_FILL, "the target"), (OVERLAP_FILL, "covered"), (BOARD_FILL, "the board"))
        text = " &nbsp; ".join(f"{_swatch(colour)}{name}" for colour, name in names)
    return f"<div class='v-wide'><div class='v-steps v-key-line'>{text}</div></div>"


def _swatch(colour: Any) -> str:
    return f"<span class='v-swatch' style='background:{hex_of(colour)}'></span>"


def result_html(moment: TrialMoment, theme: Theme) -> str:
    """At the end: the times of each help, and where they are written."""
    head = (
        "<tr><th>help</th><th>median of a pose</th><th>all poses after the first</th>"
        "<th>given up</th></tr>"
    )
    rows = "".join(_time_row(times, theme) for times in moment.times)
    return (
        f"{_SHEET}<div class='v-wide'><div class='v-progress'><table class='v-times'>{head}{rows}"
        f"</table><div class='v-path'>Written: {escape(moment.written)}</div></div></div>"
    )


def _time_row(times: HelpTimes, theme: Theme) -> str:
    middle = f"{median(times.reached_s):.1f} s" if times.reached_s else "–"
    whole = clock(round(times.ends_s[-1])) if times.ends_s else "–"
    name = f"{_swatch(_colour(times.help, theme))}{HELP_NAMES[times.help]}"
    return f"<tr><td>{name}</td><td>{middle}</td><td>{whole}</td><td>{times.given_up}</td></tr>"


def _colour(help_: Help, theme: Theme) -> tuple[int, int, int]:
    return theme.step_colours[_HELP_COLOURS[help_] - 1]


def progress_lines(times: Sequence[HelpTimes]) -> tuple[Array, ...] | None:
    """For a plot: numbers of the poses, then for each of `HELPS` the seconds since the first pose
    when each was done with. None if no help was finished; one that was not done has zeros."""
    ends = {entry.help: entry.ends_s for entry in times}
    count = max((len(e) for e in ends.values()), default=0)
    if count < 2 or any(len(e) != count for e in ends.values()):
        return None
    x = np.arange(1, count + 1, dtype=np.float64)
    return (x, *(np.array(ends.get(help_, (0.0,) * count)) for help_ in HELPS))


def progress_series(theme: Theme, shown: Sequence[Help] = HELPS) -> tuple[Any, ...]:
    """Looks of those lines; a help that was not done is hidden."""
    series: list[dict[str, Any]] = [{"label": "pose"}]
    for help_ in HELPS:
        series.append(
            {
                "label": HELP_NAMES[help_],
                "stroke": hex_of(_colour(help_, theme)),
                "width": 3,
                "points": {"show": True, "size": 8},
                "show": help_ in shown,
            }
        )
    return tuple(series)
