"""Guiding without a viewer: everything in order on one thread, so that a seed repeats a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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


@dataclass(frozen=True)
class End:
    """Why a run without a viewer has ended."""

    why: str
    """A sentence; empty if it has converged."""
    broke_off: bool = False
    """Whether it is not among the ends that are promised."""

    def told(self, snapshot: Snapshot) -> str:
        """A sentence on a result that has not converged; empty if it has."""
        judged = snapshot.convergence
        if judged is not None and judged.converged and not self.broke_off:
            return ""
        if judged is None:
            return self.why
        count = len(snapshot.views)
        return terminal_texts.NOT_CONVERGED.format(
            views="1 view" if count == 1 else f"{count} views",
            why=self.why,
            names=", ".join(judged.unsettled) or "nothing",
        )


def run_headless(
    session: Session, source: Source, tracker: Tracker, keep: Callable[[Snapshot], None]
) -> End:
    """Guide without a viewer until convergence, enough views, or the recording's end; `keep` is
    called after every view.

    Breaks off where the source fails after captured views, or the simulated hand gets stuck or has
    nowhere to go; the views are kept. Raises `SourceError` if the source failed before.
    """
    waited, views, refused, remarks = 0, 0, "", Remarks()
    try:
        if session.pending is not None:  # a session that is gone on with
            keep(session.run_pending())
        while session.phase not in ("converged", "finished"):
            if isinstance(source, Simulation) and waited > _PATIENCE_FRAMES:
                return End(refused or terminal_texts.HAND_TOO_FAR, broke_off=True)
            frame = source.read()
            if not isinstance(source, Simulation):  # its own are told at the end
                remarks.look(source)
            if frame is None:
                return End(terminal_texts.SOURCE_ENDED)
            session.observe(tracker.track(frame))
            session.count_kept(wait=True)
            if session.pending is not None:
                keep(session.run_pending())
            if isinstance(source, Simulation):
                snapshot = session.snapshot()
                source.follow(snapshot.target, snapshot.pose, begins=not snapshot.captured)
                if session.phase == "guiding" and snapshot.target is None:
                    return End(terminal_texts.NO_TARGET, broke_off=True)
                if len(snapshot.views) == views:
                    waited, refused = waited + 1, snapshot.refusal or refused
                else:
                    waited, refused, views = 0, "", len(snapshot.views)
    except KeyboardInterrupt:
        # The views captured until then are a result too.
        session.run_pending(stop=lambda: True)
        return End(terminal_texts.STOPPED)
    except SourceError as error:
        if session.snapshot().calibration is None:
            raise
        return End(terminal_texts.SOURCE_BROKE.format(error=error), broke_off=True)
    return End("" if session.phase == "converged" else terminal_texts.MAX_VIEWS)
