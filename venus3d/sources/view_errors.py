"""Errors that all corners of a simulated view share, as the views of a real recording bring them.

They are drawn anew for each target: a board held otherwise flexes otherwise, and other light draws
the corners to another side. The blur comes and goes while the board is held, as a focus that hunts;
one that stayed would keep guidance, which waits for a sharp picture, from ever capturing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.render.print_offset import PrintOffset

_WAVES = 3


@dataclass(frozen=True)
class ViewErrors:
    """How large the errors are; each a standard deviation over the views."""

    bow: float = 0.0
    """Of the board's bow, along its width and along its height, metres."""
    bias_px: float = 0.0
    """Of the corners, drawn to one side by a smooth field over the board, per axis, pixels."""
    blur_px: float = 0.0
    """Of a blur that comes on top of the camera's own, pixels; anew every second."""

    def __bool__(self) -> bool:
        return self.bow > 0 or self.bias_px > 0 or self.blur_px > 0

    def drawn_blur(self, rng: np.random.Generator) -> float:
        """Standard deviation of the additional blur, pixels."""
        return abs(float(rng.normal(0.0, self.blur_px)))

    def drawn(self, board: Board, pixel: float, rng: np.random.Generator) -> ViewError:
        """The errors of one view.

        Args:
            board: as it is without them.
            pixel: metres on the board, where it will be held, that one pixel shows.
        """
        across, down = (float(bow) for bow in rng.normal(0.0, self.bow, 2))
        bowed = replace(board, bow=(board.bow[0] + across, board.bow[1] + down))
        # Up to one period over the board, in any direction: what neighbouring corners share. Not
        # the polynomials that the calibration looks for.
        periods = rng.uniform(-1.0, 1.0, (_WAVES, 2)) / max(board.width, board.height)
        phases = rng.uniform(0.0, 2 * math.pi, _WAVES)
        heights = rng.normal(0.0, self.bias_px * pixel * math.sqrt(2 / _WAVES), (_WAVES, 2))
        waves = np.column_stack([heights, periods, phases])
        offset = PrintOffset(tuple(map(tuple, waves.tolist()))) if self.bias_px > 0 else None
        return ViewError(bowed, offset)


@dataclass(frozen=True)
class ViewError:
    """The errors of one view."""

    board: Board
    """As it is bent."""
    offset: PrintOffset | None = None
    """Of its print; None for none."""
