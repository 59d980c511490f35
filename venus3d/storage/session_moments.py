"""A session's journal as moments: what was known at each, and what was seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Literal

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import StorageError
from venus3d.engine.guidance.record import SessionState
from venus3d.storage.damaged import DAMAGED
from venus3d.storage.session_events import state_of
from venus3d.storage.session_reader import Event, damaged, pictures_by_number, read_journal

LONGEST_PAUSE_S = 20.0
"""A pause between two moments is no longer than this on the time line."""

Kind = Literal["captured", "calibrated", "changed"]


@dataclass(frozen=True, eq=False)
class Moment:
    """One moment of a session."""

    at: datetime
    play_s: float
    """Its place on the time line, seconds: pauses are shortened."""
    kind: Kind
    """"captured": the view before it counts, against its target; "calibrated": after it; "changed":
    a view taken back, another pose asked for, begun anew, gone on with."""
    state: SessionState
    """What was known then; without views at the first capture."""
    seen: Observation
    """The view captured last."""
    number: int
    """Its number."""
    picture: Path | None
    """Its picture."""


def moments_of(directory: Path) -> tuple[Moment, ...]:
    """The moments in order. Raises `StorageError` for a journal that cannot be read, or without a
    view."""
    events, _ = read_journal(directory)
    try:
        moments = _moments(directory, events)
    except DAMAGED as error:
        raise damaged(directory) from error
    if not moments:
        raise StorageError(f"No view was captured in {directory}; there is nothing to show.")
    return moments


def _moments(directory: Path, events: Sequence[Event]) -> tuple[Moment, ...]:
    names = pictures_by_number(events)
    events = [event for event in events if event["event"] in ("captured", "state")]
    moments: list[Moment] = []
    known: SessionState | None = None
    last: tuple[Observation, int] | None = None
    for index, event in enumerate(events):
        kind: Kind = "changed"
        after = state_of(events[: index + 1])
        if after is None:
            known = None
            continue
        state = after
        if event["event"] == "captured":
            view = after.views[-1]
            last = view.observation, view.number
            state, kind = known or _before_the_first(after, events[index + 1 :]), "captured"
        else:
            kind = "calibrated" if moments and moments[-1].kind == "captured" else "changed"
            known = after
        if last is None:  # views of another session
            last = after.views[-1].observation, after.views[-1].number
        name = names.get(last[1])
        picture = None if name is None else directory / name
        at = datetime.fromisoformat(event["at"])
        moments.append(Moment(at, _play_s(moments, at), kind, state, last[0], last[1], picture))
    return tuple(moments)


def _before_the_first(after: SessionState, later: Sequence[Event]) -> SessionState:
    """The start-up: its estimate is written with the first view."""
    start = after.start
    if later and later[0]["event"] == "state":
        width, height = start.image_size
        start = start.from_parameters(later[0]["start"]["parameters"], (width, height))
    return replace(after, views=(), history=(), next_view=1, next_target=1, start=start)


def _play_s(moments: Sequence[Moment], at: datetime) -> float:
    if not moments:
        return 0.0
    pause = (at - moments[-1].at).total_seconds()
    return moments[-1].play_s + min(max(pause, 0.0), LONGEST_PAUSE_S)
