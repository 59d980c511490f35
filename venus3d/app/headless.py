"""Guiding without a screen: everything in order on one thread, so that a seed repeats a run."""

from __future__ import annotations

from collections.abc import Callable

from venus3d.app.eyes import Eyes
from venus3d.engine.errors import CalibrationError, SourceError
from venus3d.engine.session import Session
from venus3d.sources.frame import Source
from venus3d.sources.sim import Simulation


def run_headless(session: Session, source: Source, eyes: Eyes) -> str:
    """Guide without a screen until convergence, enough views, or the recording's end.

    Returns a sentence if the source broke after views had been captured; they are kept. Raises
    `SourceError` if it broke before.
    """
    try:
        while session.phase not in ("converged", "finished"):
            frame = source.read()
            if frame is None:
                break
            observation = eyes.look(frame)
            session.use_board(eyes.detector.board)
            session.observe(observation)
            work_out(session)
            if isinstance(source, Simulation):
                snapshot = session.snapshot()
                source.follow(snapshot.target, snapshot.pose)
    except KeyboardInterrupt:
        # What was captured until then is a result, too.
        work_out(session, stop=lambda: True)
    except SourceError as error:
        if session.snapshot().calibration is None:
            raise
        return f"The source broke: {error}"
    return ""


def work_out(session: Session, stop: Callable[[], bool] | None = None) -> None:
    """Run the session's pending work on the spot, until there is none."""
    while session.pending is not None:
        work = session.pending
        try:
            session.apply(work.run(stop))
        except CalibrationError as error:
            session.fail(work, error)
