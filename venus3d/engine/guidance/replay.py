"""A session's snapshots once more, from what was known and seen at each moment.

A snapshot is worked out by the same `Session` with the same seed, from the views that there were:
what it shows is what was known then, and nothing of later.
"""

from __future__ import annotations

from dataclasses import replace

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.guidance.record import SessionState
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot


class Replay:
    """Works out one moment after the other. Used by one thread."""

    def __init__(self, settings: Settings) -> None:
        """With the session's settings."""
        self._settings = replace(settings, auto_capture=False)
        self._state: SessionState | None = None
        self._session: Session | None = None

    def snapshot(self, state: SessionState, seen: Observation) -> Snapshot:
        """The moment at which the session was in `state` and saw this; takes up to some seconds."""
        if self._session is None or state is not self._state:
            session = Session(state.board, seen.image_size, self._settings)
            session.restore(state)
            session.run_pending()
            self._session, self._state = session, state
        return self._session.observe(seen)
