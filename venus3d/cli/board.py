"""`venus3d board`: the board to print, or to show on a screen."""

from __future__ import annotations

import shlex
import webbrowser
from pathlib import Path

from venus3d.cli.options import BoardCommand
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.storage.board_file import board_text, is_board_file, save_board
from venus3d.storage.board_sheet.files import pdf_of, picture_of_sheet, png_of, svg_of
from venus3d.storage.board_sheet.screen import screen_page
from venus3d.storage.board_sheet.sheet import Sheet, lay_out, paper_size, tiles
from venus3d.storage.places import free_place
from venus3d.storage.products import write_product

_KINDS = (".pdf", ".svg", ".png")
_MADE = "a board"
_TO_MEASURE = {
    "squares": "measure a square and give its size with --board.square-mm (and the marker's with "
    "--board.marker-mm)",
    "tags": "measure the distance from one tag to the next and a tag, and give them with "
    "--board.square-mm and --board.marker-mm",
    "circles": "measure the distance from one row to the next over many rows and give it with "
    "--board.square-mm (and a circle's diameter with --board.marker-mm)",
}
"""By what the board's columns count."""


def board_command(options: BoardCommand) -> None:
    """Write the board and print instructions. Raises `VenusError` for a user's mistake."""
    if options.find is not None:
        from venus3d.cli.find_board import find_board  # other uses need no source

        find_board(options.find)
        return
    board = options.board.board()
    if options.save is not None:
        again = is_board_file(options.save)
        path = save_board(board, free_place(options.save, replaces=again, option="--save"))
        print(f"{path}: give it to the other commands as --board {shlex.quote(str(path))}")
        return
    if options.show:
        _show(board, options.output)
        return
    path = _place(options.output, "board.pdf")
    kind = path.suffix.lower()
    if kind not in _KINDS:
        raise StorageError(
            f"The board is written as PDF, SVG or PNG, not as {path.suffix}; name it .pdf, .svg or "
            ".png."
        )
    # A picture is as large as the board unless paper is asked for.
    paper = paper_size(options.paper or ("a4" if kind == ".pdf" else "fit"))
    sheet = _sheet(board, paper, options)
    pages = tiles(sheet, paper)
    if kind != ".pdf" and len(pages) > 1:
        raise StorageError(
            f"The board does not fit on this paper: with its border it is {sheet.width:.0f} x "
            f"{sheet.height:.0f} mm. Write a .pdf, which has several pages, or use --paper fit."
        )
    size = f"{board.columns} x {board.rows} {board.of_kind.unit}, {_lengths(board)}"
    if kind == ".pdf":
        write_product(path, pdf_of(sheet, pages, f"venus3d board: {size}"), _MADE)
        made = f"{len(pages)} pages to be put together" if len(pages) > 1 else "one page"
        width, height = pages[0].page
        print(f"{path}: {made} of {width:g} x {height:g} mm, {size}.")
    elif kind == ".svg":
        write_product(path, svg_of(sheet, f"venus3d board: {size}").encode(), _MADE)
        print(f"{path}: {sheet.width:g} x {sheet.height:g} mm, {size}.")
    else:
        picture, dpi = picture_of_sheet(sheet, options.dpi, options.board.square_mm)
        write_product(path, png_of(picture, dpi), _MADE)
        print(f"{path}: {picture.shape[1]} x {picture.shape[0]} px at {dpi:.1f} dpi, {size}.")
    unit = board.of_kind.unit
    ruler = "" if options.plain else "check that the ruler is 100 mm long, "
    print(f"Print it at 100 %, {ruler}glue it onto something flat and stiff, {_TO_MEASURE[unit]}.")


def _place(output: Path, name: str) -> Path:
    return output / name if output.is_dir() or not output.suffix else output


def _lengths(board: Board) -> str:
    lengths = f"{1000 * board.square:g} mm"
    return f"{lengths} / {1000 * board.marker:g} mm" if board.has("marker") else lengths


def _sheet(board: Board, paper: tuple[float, float] | None, options: BoardCommand) -> Sheet:
    marked = f", {board.dictionary}" if board.has("dictionary") else ""
    words = (
        f"{board.of_kind.name}, {board.columns} x {board.rows}, {_lengths(board)}{marked}",
        "Print at 100 %: the ruler is 100 mm long. If not, measure: --board.square-mm",
    )
    if not 0 <= options.margin_mm < 1000:
        raise StorageError("--margin-mm must be a number from 0 to 1000.")
    code = "" if options.plain else board_text(board)
    return lay_out(board, paper, margin=options.margin_mm, words=words, code=code)


def _show(board: Board, output: Path) -> None:
    path = _place(output, "board.html").with_suffix(".html")
    write_product(path, screen_page(board).encode(), _MADE)
    opened = webbrowser.open(path.absolute().as_uri())
    print(f"{path}: " + ("opened in the browser." if opened else "open it in a browser."))
