"""Guiding without a viewer: everything in order on one thread, so that a seed repeats a run."""

from __future__ import annotations

from collections.abc import Callable

from venus3d.engine.errors import SourceError
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import terminal_texts
from venus3d.sources.board_tracker import Tracker
from venus3d.sources.frame import Source
from venus3d.sources.sim import Simulation
from venus3d.sources.source_news import Remarks

# About ten times what the simulated hand takes for a target.
_PATIENCE_FRAMES = 400


def run_headless(
    session: Session, source: Source, tracker: Tracker, keep: Callable[[Snapshot], None]
) -> str:
    """Guide without a viewer until convergence, enough views, or the recording's end; `keep` is
    called after every view.

    Returns a sentence on any other end (the source failed after captured views, or the simulated
    hand got stuck); the views are kept. Raises `SourceError` if the source failed before.
    """
    waited, views, remarks = 0, 0, Remarks()
    try:
        if session.pending is not None:  # a session that is gone on with
            keep(session.run_pending())
        while session.phase not in ("converged", "finished"):
            if isinstance(source, Simulation) and waited > _PATIENCE_FRAMES:
                return terminal_texts.HAND_TOO_FAR
            frame = source.read()
            if not isinstance(source, Simulation):  # its own are told at the end
                remarks.look(source)
            if frame is None:
                break
            session.observe(tracker.track(frame))
            session.count_kept(wait=True)
            if session.pending is not None:
                keep(session.run_pending())
            if isinstance(source, Simulation):
                snapshot = session.snapshot()
                source.follow(snapshot.target, snapshot.pose, begins=not snapshot.captured)
                waited = waited + 1 if len(snapshot.views) == views else 0
                views = len(snapshot.views)
    except KeyboardInterrupt:
        # The views captured until then are a result too.
        session.run_pending(stop=lambda: True)
    except SourceError as error:
        if session.snapshot().calibration is None:
            raise
        return terminal_texts.SOURCE_BROKE.format(error=error)
    return ""
