"""A board as a TOML file: what is printed as a QR code beside it."""

from __future__ import annotations

from venus3d.engine.geometry.board import Board


def board_text(board: Board) -> str:
    """The board's options, lengths in millimetres."""
    lines = [
        f'kind = "{board.kind}"',
        f"columns = {board.columns}",
        f"rows = {board.rows}",
        f"square_mm = {1000 * board.square:.10g}",
    ]
    lines += [f"marker_mm = {1000 * board.marker:.10g}"] * board.has("marker")
    lines += [f'dictionary = "{board.dictionary}"'] * board.has("dictionary")
    lines += ["legacy = true"] * board.legacy + ["inverted = true"] * board.inverted
    lines += [f"first_id = {board.first_id}"] * (board.first_id > 0)
    return "\n".join(lines) + "\n"
