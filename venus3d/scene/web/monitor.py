"""The second monitor as the operator's page knows it, and its address."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from venus3d.engine.errors import VenusError

if TYPE_CHECKING:  # the command line asks for an address only
    from venus3d.engine.calibration.observation import Observation
    from venus3d.engine.guidance.snapshot import Snapshot
    from venus3d.render.annotated_picture import LivePicture


class SecondMonitor(Protocol):
    """Shows a run's snapshots and pictures. Any thread may call it; no call returns anything or
    blocks."""

    def show(self, snapshot: Snapshot) -> None:
        """Show this moment; the newest wins."""
        ...

    def show_picture(self, image: LivePicture, observation: Observation | None = None) -> None:
        """Show this live picture (BGR or grey); the newest wins."""
        ...

    def pause(self, on: bool) -> None:
        """Say that pictures are paused, or are no longer."""
        ...

    def no_pictures(self, since: str) -> None:
        """Say that no pictures come, since this time of day; empty: they come again."""
        ...


def audience_address(text: str, port: int) -> tuple[str, int]:
    """Host and port of "[HOST:]PORT"; without a host, this machine only. Raises `VenusError` for
    anything else and for `port`, the operator's."""
    host, colon, number = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")  # IPv6 addresses are bracketed
    if not number.isdecimal() or (colon and not host):
        raise VenusError(
            f"--audience wants a port, or an address and a port such as 0.0.0.0:8090, not {text!r}."
        )
    if int(number) == port:
        raise VenusError(
            f"--audience and --port are both {port}; the second monitor needs a port of its own."
        )
    return host or "127.0.0.1", int(number)
