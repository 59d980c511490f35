"""A page that shows the board on a screen or tablet in true size, for one without a printer."""

from __future__ import annotations

import json
from pathlib import Path

from venus3d.engine.geometry.board import Board
from venus3d.storage.board_sheet.files import svg_of
from venus3d.storage.board_sheet.sheet import lay_out

_WHAT = {
    "squares": "The side of a square",
    "tags": "The way from one tag to the next",
    "circles": "The way from one row of circles to the next",
}
"""What is measured, by what the board's columns count."""


def screen_page(board: Board) -> str:
    """An HTML document without links. Its person matches a bank card's width once; a square is then
    a whole number of the screen's pixels, and the page says how wide that is."""
    page = (Path(__file__).parent / "screen.html").read_text(encoding="utf-8")
    sizes = [1000 * board.width, 1000 * board.height, 1000 * board.square]
    lengths = {"square-mm": 1000 * board.square}
    if board.has("marker"):
        lengths["marker-mm"] = 1000 * board.marker
    filled = {
        "__BOARD__": svg_of(lay_out(board, None, margin=0.0), "board"),
        "__SIZES__": json.dumps([round(size, 6) for size in sizes]),
        "__LENGTHS__": json.dumps(lengths),
        "__WHAT__": _WHAT[board.of_kind.unit],
        "__GROUND__": "#000" if board.inverted else "#fff",
    }
    for name, value in filled.items():
        page = page.replace(name, value)
    return page
