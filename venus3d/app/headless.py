"""Guiding without a screen: everything in order on one thread, so that a seed repeats a run."""

from __future__ import annotations

from contextlib import suppress

from venus3d.app.eyes import Eyes
from venus3d.engine.errors import CalibrationError
from venus3d.engine.session import Session
from venus3d.engine.snapshot import Snapshot
from venus3d.sources.frame import Source
from venus3d.sources.sim import Simulation


def run_headless(session: Session, source: Source, eyes: Eyes) -> Snapshot:
    """Guide without a screen until convergence, enough views, or the recording's end."""
    with suppress(KeyboardInterrupt):  # what was captured until then is a result, too
        while session.phase not in ("converged", "finished"):
            frame = source.read()
            if frame is None:
                break
            observation = eyes.look(frame)
            session.use_board(eyes.detector.board)
            snapshot = session.observe(observation)
            while session.pending is not None:
                work = session.pending
                try:
                    snapshot = session.apply(work.run())
                except CalibrationError as error:
                    snapshot = session.fail(work, error)
            if isinstance(source, Simulation):
                source.follow(snapshot.target, snapshot.pose)
    return session.snapshot()
