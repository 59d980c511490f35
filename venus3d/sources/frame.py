"""A frame, and the protocol of every source of frames. To add a source, see CONTRIBUTING.md."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Frame:
    """One image from a source."""

    image: NDArray[np.uint8]
    """(H, W, 3) BGR or (H, W) grey, 8 bit (16 bit is allowed for grey images)."""
    time_s: float
    """When it was taken, by the source's clock (video time, not wall time)."""
    name: str
    """A file name or a frame number."""
    came_s: float = field(default_factory=time.monotonic)
    """When this program had it, by `time.monotonic`."""

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height)."""
        return (int(self.image.shape[1]), int(self.image.shape[0]))

    def flipped(self, flip: bool = True) -> Frame:
        """With left and right exchanged; as it is without `flip`."""
        return replace(self, image=np.ascontiguousarray(self.image[:, ::-1])) if flip else self


class Source(Protocol):
    """A source of frames. Used by one thread."""

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the frames."""
        ...

    @property
    def is_live(self) -> bool:
        """Whether frames are lost if they are not read."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on how the frames come, for a person: a fallback, an unreadable part."""
        ...

    def read(self) -> Frame | None:
        """The next frame of a recording, the newest of a live source; None at the end.
        Raises `SourceError` if reading fails."""
        ...

    def close(self) -> None:
        """Release all resources. May be called twice."""
        ...


class RealSource:
    """What all sources but the simulation share."""

    is_live = False
    flip = False
    """Whether left and right are exchanged: for pictures that come mirrored."""
    _size: tuple[int, int]

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the frames."""
        return self._size
