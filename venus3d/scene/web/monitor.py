"""Interface of a second monitor: shows a run's snapshots and pictures beside the operator's
page."""

from __future__ import annotations

from typing import Protocol

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import LivePicture


class SecondMonitor(Protocol):
    """Any thread may call it; no call returns anything or blocks."""

    def show(self, snapshot: Snapshot) -> None:
        """Show this moment; the newest wins."""
        ...

    def show_picture(self, image: LivePicture, observation: Observation | None = None) -> None:
        """Show this live picture (BGR or grey); the newest wins."""
        ...

    def pause(self, on: bool) -> None:
        """Say that pictures are paused, or are no longer."""
        ...
