"""The board as an image that prints at its true size: the PNG holds its resolution."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.storage.folder import write_bytes

MM_PER_INCH = 25.4


def board_picture(
    board: Board, *, dpi: float = 300.0, margin_mm: float = 10.0
) -> tuple[NDArray[np.uint8], float]:
    """Grey image of the board with a margin, and its resolution in dots per inch.

    A square must be a whole number of pixels, or its edges blur, so the resolution is the nearest
    one to `dpi` for which it is. Raises `StorageError` for one that gives no usable image.
    """
    square_mm = board.square * 1000
    if not (0 < dpi < 1e6 and 0 <= margin_mm < 1e6):
        raise StorageError("The resolution must be positive and the margin not negative.")
    square_px = round(square_mm * dpi / MM_PER_INCH)
    # A marker of 8 cells in two thirds of a square still has two pixels a cell.
    if square_px < 24:
        raise StorageError(
            f"At {dpi:g} dpi a square of {square_mm:g} mm is {square_px} px wide, too coarse for "
            "the markers; use a higher --dpi."
        )
    margin_px = round(margin_mm / square_mm * square_px)
    height, width = board.rows * square_px, board.columns * square_px
    if (height + 2 * margin_px) * (width + 2 * margin_px) > 400_000_000:
        raise StorageError("This picture would have over 400 million pixels; use a lower --dpi.")
    # An inverted board has a black margin, so that its outer squares keep their contrast.
    ground = 0 if board.inverted else 255
    picture = np.pad(board.texture(square_px), margin_px, constant_values=ground)
    return picture, square_px / square_mm * MM_PER_INCH


def write_board(
    path: Path, board: Board, *, dpi: float = 300.0, margin_mm: float = 10.0
) -> tuple[int, int, float]:
    """Write the board as a PNG. Returns its width and height in pixels and its dots per inch.
    PNG stores the resolution (pHYs) in whole dots per metre, within 0.003 % of 300 dpi."""
    picture, resolution = board_picture(board, dpi=dpi, margin_mm=margin_mm)
    buffer = io.BytesIO()
    Image.fromarray(picture).convert("1", dither=Image.Dither.NONE).save(
        buffer, "PNG", dpi=(resolution, resolution)
    )
    write_bytes(path, buffer.getvalue())
    return picture.shape[1], picture.shape[0], resolution
