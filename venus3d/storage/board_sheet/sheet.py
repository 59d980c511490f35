"""A board laid out on paper: with a ruler, its parameters and a QR code of its file.

Lengths are millimetres from the sheet's top left corner, y down.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import segno

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

PAPERS: dict[str, tuple[float, float]] = {
    "a4": (210.0, 297.0),
    "a3": (297.0, 420.0),
    "letter": (215.9, 279.4),
}
"""Width and height, upright."""
RULER_MM = 100.0
TEXT_MM = 2.3
"""Height of the letters, as that of a font: 6.5 points."""

_EDGE = 5.0
"""What hardly any printer prints on."""
_TOP, _GAP, _FOOT = 6.0, 4.0, 17.0
"""Height of the mark above the board, of the gaps, and of what stands below it."""
_QR_AT = RULER_MM + 4.0
_TILE_EDGE = 10.0
"""Room around a tile for the marks to cut by."""


@dataclass(frozen=True)
class Text:
    """A line of text."""

    x: float
    baseline: float
    words: str


@dataclass(frozen=True, eq=False)
class Sheet:
    """Black shapes and text on white. Where two shapes lie over each other it is white again."""

    width: float
    height: float
    rectangles: Array
    """(N, 4) left, top, width, height."""
    discs: Array
    """(N, 3) centre x, y and radius."""
    polygons: tuple[Array, ...] = ()
    """(N, 2) each."""
    texts: tuple[Text, ...] = ()


@dataclass(frozen=True)
class Tile:
    """The part of a sheet that is printed on one page."""

    column: int
    row: int
    left: float
    top: float
    width: float
    height: float
    """On the sheet."""
    page: tuple[float, float]
    """The paper's width and height; the part is in its middle."""


def paper_size(name: str) -> tuple[float, float] | None:
    """Width and height of "a4", "a3", "letter" or "WIDTHxHEIGHT"; None for "fit".
    Raises `StorageError` for another name."""
    if name.lower() == "fit":
        return None
    if name.lower() in PAPERS:
        return PAPERS[name.lower()]
    try:
        width, height = (float(side) for side in name.lower().split("x"))
    except ValueError:
        width = height = float("nan")
    if not (30 <= width <= 5000 and 30 <= height <= 5000):
        raise StorageError(
            f"There is no paper {name!r}; use a4, a3, letter, fit (as large as the board), or a "
            "size such as 500x700 (millimetres, 30 to 5000)."
        )
    return width, height


def lay_out(
    board: Board,
    paper: tuple[float, float] | None,
    *,
    margin: float = 10.0,
    words: tuple[str, ...] = (),
    code: str = "",
) -> Sheet:
    """The board in the middle of paper of this size or turned by 90°, or if neither is large enough
    (or `paper` is None) of a sheet as large as the board with `margin` on all sides.

    Args:
        words: lines below the board.
        code: what the QR code says. Without it nothing but the board is on the sheet.
    """
    below = _FOOT + _GAP if code else 0.0
    above = _TOP + _GAP if code else 0.0
    board_size = np.array([board.width, board.height]) * 1000
    content = np.array([max(board_size[0], _QR_AT + _FOOT if code else 0.0), board_size[1]])
    content[1] += above + below
    size = content + 2 * max(margin, 0.0)
    # Upright or turned as the board is, if both would do.
    across = bool(size[0] > size[1])
    for page in (
        () if paper is None else sorted(_turns(paper), key=lambda p: (p[0] > p[1]) != across)
    ):
        if (content + 2 * _EDGE <= np.array(page) + 1e-6).all():
            size = np.array(page)
            break
    width, height = float(size[0]), float(size[1])
    left, top = (size - content) / 2
    centre = np.array([width / 2, top + above + board_size[1] / 2])
    drawing = board.of_kind.drawing(board)
    rectangles = drawing.rectangles * 1000 + [*centre, 0, 0]
    discs = drawing.discs * 1000 + [*centre, 0]
    if board.inverted:
        # A black border, so that the outer squares keep their contrast.
        border = min(margin, _GAP - 1.0) if code else margin
        frame = [*(centre - board_size / 2 - border), *(board_size + 2 * border)]
        rectangles = np.vstack([rectangles, frame])
    if not code:
        return Sheet(width, height, rectangles, discs)
    foot = centre[1] + board_size[1] / 2 + _GAP
    rectangles = np.vstack([rectangles, _ruler(left, foot), _qr_code(code, left + _QR_AT, foot)])
    tip = np.array([width / 2 - 9, top + _TOP - 4.5])
    mark = np.array([[-2.5, 4.0], [0.0, 0.0], [2.5, 4.0]]) + tip
    texts = [Text(width / 2 - 4, top + _TOP - 1, "TOP")]
    texts += [Text(left, foot + 9 + 4 * i, line) for i, line in enumerate(words)]
    return Sheet(width, height, rectangles, discs, (mark,), tuple(texts))


def _ruler(left: float, top: float) -> Array:
    """Ten centimetres from the outer edge of the first field to that of the last."""
    step = RULER_MM / 10
    fields = [[left + i * step, top + 2.0 * (i % 2), step, 2.0] for i in range(10)]
    return np.array(fields)


def _qr_code(content: str, left: float, top: float) -> Array:
    code = segno.make(content, error="l", micro=False, boost_error=False)
    rows = np.array([[bool(dark) for dark in row] for row in code.matrix])
    size = _FOOT / len(rows)
    found: list[list[float]] = []
    for number, row in enumerate(rows):
        edges = np.flatnonzero(np.diff(np.pad(row.astype(np.int8), 1))).reshape(-1, 2)
        found += [[left + a * size, top + number * size, (b - a) * size, size] for a, b in edges]
    return np.array(found)


def _turns(paper: tuple[float, float]) -> tuple[tuple[float, float], tuple[float, float]]:
    return paper, (paper[1], paper[0])


def tiles(sheet: Sheet, paper: tuple[float, float] | None) -> list[Tile]:
    """The pages that make up a sheet, row by row: one if the paper holds it."""
    whole = Tile(0, 0, 0.0, 0.0, sheet.width, sheet.height, (sheet.width, sheet.height))
    if paper is None or (sheet.width, sheet.height) in _turns(paper):
        return [whole]
    size = np.array([sheet.width, sheet.height])

    def count(page: tuple[float, float]) -> float:
        return float(np.ceil(size / (np.array(page) - 2 * _TILE_EDGE)).prod())

    page = min(_turns(paper), key=count)
    width, height = np.array(page) - 2 * _TILE_EDGE
    columns, rows = (int(n) for n in np.ceil(size / [width, height]))
    # From the bottom left, where the ruler and the code are.
    return [
        Tile(
            column,
            row,
            column * width,
            max(sheet.height - (rows - row) * height, 0.0),
            min(width, sheet.width - column * width),
            height if row else sheet.height - (rows - 1) * height,
            page,
        )
        for row in range(rows)
        for column in range(columns)
    ]
