"""`venus3d board`: the board as an image to print."""

from __future__ import annotations

from venus3d.cli.options import BoardCommand
from venus3d.engine.errors import StorageError
from venus3d.storage.board_image import write_board


def board_command(options: BoardCommand) -> None:
    """Write the board and print instructions. Raises `VenusError` for a user's mistake."""
    board = options.board.board()
    path = options.output
    if path.suffix.lower() not in ("", ".png"):
        raise StorageError(f"The board is written as a PNG, not as {path.suffix}; name it .png.")
    if not path.suffix:
        path = path / "board.png"
    width, height, dpi = write_board(path, board, dpi=options.dpi, margin_mm=options.margin_mm)
    print(
        f"{path}: {width} x {height} px at {dpi:.1f} dpi, {board.columns} x {board.rows} squares "
        f"of {options.board.square_mm:g} mm."
    )
    print(
        "Print it at 100 %, glue it onto something flat and stiff, measure a square and give its "
        "size with --board.square-mm (and the marker's with --board.marker-mm)."
    )
