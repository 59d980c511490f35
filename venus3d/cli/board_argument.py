"""`--board FILE`: a board's file in place of its options."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from venus3d.engine.errors import StorageError

_BOARD = "--board"


def with_board_file(given: Sequence[str]) -> list[str]:
    """The arguments with `--board FILE` replaced by the options in the file. Those that are given
    beside it stay, and win. Raises `StorageError` if the file describes no board."""
    place = next((i for i, one in enumerate(given) if _is_board(one)), None)
    if place is None:
        return list(given)
    name = given[place].partition("=")[2]
    rest = place + 1
    if "=" not in given[place]:
        if rest == len(given) or given[rest].startswith("--"):
            raise StorageError(
                "--board needs a file; single options are --board.columns and so on."
            )
        name, rest = given[rest], rest + 1
    if any(map(_is_board, given[rest:])):
        raise StorageError("--board is given twice; give one file.")
    # Only now: no other command waits for what reads it.
    from venus3d.storage.board_file import read_board

    beside = {_name(one) for one in given}
    options = read_board(Path(name))
    if options["kind"] == "charuco" and "marker_mm" not in options and "marker-mm" not in beside:
        raise StorageError(
            f"{name} does not tell the markers' size; measure it: --board.marker-mm."
        )
    return [
        *given[:place],
        *(token for key, value in options.items() for token in _tokens(key, value, beside)),
        *given[rest:],
    ]


def _is_board(argument: str) -> bool:
    return argument == _BOARD or argument.startswith(f"{_BOARD}=")


def _name(argument: str) -> str:
    """Of `--board.square_mm=28` "square-mm"; "" of another argument."""
    option = argument.partition("=")[0]
    return option.removeprefix(f"{_BOARD}.").replace("_", "-") if "." in option else ""


def _tokens(key: str, value: Any, beside: set[str]) -> list[str]:
    option = key.replace("_", "-")
    if option in beside or value is False:
        return []
    return [f"{_BOARD}.{option}"] if value is True else [f"{_BOARD}.{option}", str(value)]
