"""A frame, and the protocol of every source of frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Frame:
    """One image as it came from a source."""

    image: NDArray[np.uint8]
    """(H, W, 3) BGR or (H, W) grey, 8 bit (16 bit is allowed for grey images)."""
    time_s: float
    """When it was taken, by the source's own clock (a video's time, not the wall's)."""
    name: str
    """A file name or a frame number."""

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height)."""
        return (int(self.image.shape[1]), int(self.image.shape[0]))


class Source(Protocol):
    """Something that gives frames. Used by one thread."""

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the frames."""
        ...

    @property
    def is_live(self) -> bool:
        """Whether frames pass by whether they are read or not."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What a person should know of how the frames come: a fallback, a part not readable."""
        ...

    def read(self) -> Frame | None:
        """The next frame of a recording, the newest of a live source; None at the end.

        Raises `SourceError` when the source breaks.
        """
        ...

    def close(self) -> None:
        """Release what is held. May be called twice."""
        ...
