"""Tells the terminal that a live source is gone, opened again, and back; and its remarks."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime, timedelta

from venus3d.engine.printable import printable
from venus3d.sources import terminal_texts as say
from venus3d.sources.frame import Source
from venus3d.sources.live import Live, OtherSize, Trouble
from venus3d.sources.reconnection import Outage

_TOLD_TRIES = (1, 2, 4)
_EVERY = 30
"""Later tries, of which one comes every 10 s, are told every five minutes."""
_MOST_REMARKS = 10


def tell_of_trouble(source: Source, tell: Callable[[str], None] | None = None) -> None:
    """Have `tell` called with a sentence at each news of a live source, and of no other. By default
    it is printed to stderr, as stdout holds results only."""
    if isinstance(source, Live):
        source.on_trouble = _News(source.name, tell or _print)


class Remarks:
    """What a source notes, told once, when it is found: a damaged picture, a rotation tag."""

    def __init__(self, tell: Callable[[str], None] | None = None) -> None:
        """`tell` is called with each; by default it is printed to stderr."""
        self._tell = tell or _print
        self._told: set[str] = set()

    @property
    def count(self) -> int:
        """How many have been told."""
        return len(self._told)

    def look(self, source: Source) -> None:
        """Tell what is new; call it after each frame."""
        for note in source.notes:
            # Each damaged picture changes the note: the rest is told at the end.
            if note not in self._told and self.count < _MOST_REMARKS:
                self._told.add(note)
                self._tell(note)


def _print(text: str) -> None:
    with suppress(OSError):  # a closed terminal stops no work
        print(printable(text), file=sys.stderr, flush=True)


class _News:
    def __init__(self, name: str, tell: Callable[[str], None]) -> None:
        self._name, self._tell = name, tell
        self._began_s: float | None = None

    def __call__(self, trouble: Trouble | None) -> None:
        text = ""
        match trouble:
            case None if self._began_s is not None:
                gone_s = time.monotonic() - self._began_s
                self._began_s = None
                text = say.SOURCE_BACK.format(name=self._name, seconds=gone_s)
            case OtherSize(was, now):
                was_px, now_px = (f"{width} x {height}" for width, height in (was, now))
                text = say.SOURCE_OTHER_SIZE.format(name=self._name, was=was_px, now=now_px)
            case Outage(silent_s, 0, _, _):
                self._began_s = time.monotonic() - silent_s
                since = f"{datetime.now() - timedelta(seconds=silent_s):%H:%M:%S}"
                text = say.SOURCE_GONE.format(name=self._name, since=since)
            case Outage(_, tries, _, reason) if tries in _TOLD_TRIES or tries % _EVERY == 0:
                text = say.SOURCE_TRIED.format(name=self._name, tries=tries, reason=reason)
            case _:
                pass
        if text:
            self._tell(text)
