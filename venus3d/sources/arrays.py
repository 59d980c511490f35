"""A source of images already in memory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.sources.frame import Frame


class Arrays:
    """Arrays (H, W) grey or (H, W, 3) BGR in order; `Frame.time_s` counts them.
    Raises `SourceError` for an empty list."""

    is_live = False
    flip = False
    """Whether left and right are exchanged: for mirrored images."""
    notes: tuple[str, ...] = ()

    def __init__(self, images: Sequence[NDArray[np.uint8]]) -> None:
        if not len(images):
            raise SourceError("There are no images to read; give at least one.")
        self._images = images
        self._next = 0

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the first image."""
        return (self._images[0].shape[1], self._images[0].shape[0])

    def __len__(self) -> int:
        return len(self._images)

    def read(self) -> Frame | None:
        """The next image; None after the last."""
        if self._next >= len(self._images):
            return None
        self._next += 1
        frame = Frame(self._images[self._next - 1], self._next - 1.0, f"image {self._next}")
        return frame.flipped(self.flip)

    def close(self) -> None:
        """Ends reading; nothing is held open."""
        self._next = len(self._images)
