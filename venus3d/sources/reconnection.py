"""When a live source that is gone is opened again: a state machine without thread or clock of its
own, so that a test can run a day of outages in no time.

    connected --silent or ended--> waiting --delay over--> trying --picture--> connected
                                      ^                       |
                                      `-----failed------------'
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

DELAYS_S = (0.5, 1.0, 2.0, 4.0, 10.0)
"""Seconds before each try; the last one again and again, for ever."""


@dataclass(frozen=True)
class Outage:
    """A live source without pictures, at one moment."""

    silent_s: float
    """Seconds since its last picture."""
    tries: int
    """How often it has been opened again since then."""
    next_try_s: float
    """Seconds until the next try; 0 while one goes on."""
    reason: str
    """What ended the connection, or why the last try failed."""


class Reconnection:
    """Decides when a source is given up and when it is opened again."""

    def __init__(self, silence_s: float, patience_s: float, clock: Callable[[], float]) -> None:
        """A source that has just sent a picture.

        Args:
            silence_s: without a picture for so long, a connection is given up.
            patience_s: the same for a try, from its beginning to its first picture.
            clock: seconds, never backwards.
        """
        self._silence_s, self._patience_s, self._clock = silence_s, patience_s, clock
        self._state: Literal["connected", "waiting", "trying"] = "connected"
        self._last_picture_s = self._since_s = clock()
        self._next_s = 0.0
        self._tries = 0
        self._reason = ""

    def observe(self, *, picture: bool, alive: bool, reason: str = "") -> bool:
        """Take note of the connection; call it often.

        Args:
            picture: whether one has come since the last call.
            alive: whether the connection, or the try to make one, goes on.
            reason: why it does not.

        Returns whether to open the source now, leaving any connection that there still is.
        """
        now_s = self._clock()
        if picture:
            self._state, self._tries, self._reason = "connected", 0, ""
            self._last_picture_s = self._since_s = now_s
            return False
        if self._state == "waiting":
            if now_s < self._next_s:
                return False
            self._state, self._since_s, self._tries = "trying", now_s, self._tries + 1
            return True
        allowed_s = self._silence_s if self._state == "connected" else self._patience_s
        if not alive or now_s - self._since_s >= allowed_s:
            silent = f"no picture for {allowed_s:g} s" if alive else ""
            self._state, self._reason = "waiting", silent or reason or self._reason
            self._next_s = now_s + DELAYS_S[min(self._tries, len(DELAYS_S) - 1)]
        return False

    def resume(self) -> None:
        """Nobody has looked for a while (a pause): silence counts from now."""
        if self._state == "connected":
            self._last_picture_s = self._since_s = self._clock()

    @property
    def outage(self) -> Outage | None:
        """The outage that goes on; None while connected."""
        if self._state == "connected":
            return None
        now_s = self._clock()
        wait_s = max(0.0, self._next_s - now_s) if self._state == "waiting" else 0.0
        return Outage(now_s - self._last_picture_s, self._tries, wait_s, self._reason)
