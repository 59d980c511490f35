"""A board as a file: our TOML, which is also printed as a QR code beside the board, Kalibr's target
YAML, and the names of calib.io's files."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import msgspec
import yaml

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import DICTIONARIES, Board
from venus3d.engine.sentences import listed
from venus3d.regular_file import read_regular
from venus3d.storage.folder import reason, write_bytes

_OPTIONS: Mapping[str, type] = {
    "kind": str,
    "columns": int,
    "rows": int,
    "square_mm": float,
    "square_x_mm": float,
    "square_y_mm": float,
    "marker_mm": float,
    "dictionary": str,
    "legacy": bool,
    "inverted": bool,
    "first_id": int,
}
"""The options of a board, as `--board.*` has them, and their types."""
_NUMBER = r"(?:0|[1-9]\d*)(?:\.\d+)?"
_CALIB_IO = re.compile(
    r"calib\.io_(?P<kind>checker|charuco|circles)_[^_]+_(?P<rows>\d+)x(?P<columns>\d+)"
    rf"_(?P<square>{_NUMBER})(?:_(?P<marker>{_NUMBER}))?(?:_(?P<family>DICT_\w+?))?"
    r"(?P<number>[_-]\d+)?(?: ?\(\d+\))?$",
    re.IGNORECASE,
)
"""calib.io_charuco_200x150_8x11_15_11_DICT_4X4: the page, rows x columns, square and marker in mm;
those of checkers end after the square. Older files have no marker.
calib.io_circles_200x150_7x10_12_5: likewise, the distance of the circles and their diameter. What
asymmetric grids are called is not known here. A number at the end counts copies or pictures, if it
is not that of a dictionary's markers."""
_CALIB_IO_KINDS: Mapping[str, str] = {
    "checker": "chessboard",
    "charuco": "charuco",
    "circles": "circles",
}
_KALIBR: Mapping[str, str] = {
    "aprilgrid": "aprilgrid",
    "checkerboard": "chessboard",
    "circlegrid": "circles",
}


def board_text(board: Board) -> str:
    """The board's options, lengths in millimetres."""
    lines = [
        f'kind = "{board.kind}"',
        f"columns = {board.columns}",
        f"rows = {board.rows}",
        f"square_mm = {1000 * board.square:.10g}",
    ]
    if board.stretch:
        for name, sign in (("square_x_mm", 1), ("square_y_mm", -1)):
            side = 1000 * board.square * (1 + sign * board.stretch / 2)
            lines.append(f"{name} = {side:.10g}")
    lines += [f"marker_mm = {1000 * board.marker:.10g}"] * board.has("marker")
    lines += [f'dictionary = "{board.dictionary}"'] * board.has("dictionary")
    lines += ["legacy = true"] * board.legacy + ["inverted = true"] * board.inverted
    lines += [f"first_id = {board.first_id}"] * (board.first_id > 0)
    return "\n".join(lines) + "\n"


def save_board(board: Board, path: Path) -> Path:
    """Write a board's file. Raises `StorageError` if it cannot be written."""
    return write_bytes(path, board_text(board).encode())


def is_board_file(path: Path) -> bool:
    """Whether a file is one that `save_board` wrote."""
    with suppress(OSError, ValueError, StorageError):
        _of_toml(path, read_regular(path).decode())
        return True
    return False


def read_board(path: Path) -> dict[str, Any]:
    """The options that a board's file gives, by their names; lengths in millimetres.

    Of calib.io's files the name suffices; the file need not be there. Raises `StorageError`, with
    cause and cure, if the file cannot be read or describes no board.
    """
    named = _CALIB_IO.match(path.name.removesuffix(path.suffix)) if path.suffix else None
    named = named or _CALIB_IO.match(path.name)
    if named is not None:
        return _of_calib_io(named, path)
    try:
        text = read_regular(path).decode()
    except OSError as error:
        if not path.exists() and path.name.lower().startswith("calib.io_"):
            raise _no_board(
                path,
                "it is no name of a checkerboard, a ChArUco board or a grid of circles by calib.io",
            ) from error
        raise StorageError(
            f"The board {path} cannot be read ({reason(error)}); give a file that venus3d board "
            "--save wrote, Kalibr's YAML, or the name of a calib.io file."
        ) from error
    except ValueError as error:
        raise _no_board(path, "it is no text") from error
    read: Callable[[Path, str], dict[str, Any]] = (
        _of_kalibr if path.suffix.lower() in (".yaml", ".yml") else _of_toml
    )
    return read(path, text)


def _no_board(path: Path, why: str) -> StorageError:
    return StorageError(
        f"{path} describes no board: {why}. venus3d board --save FILE writes one to compare with."
    )


def _of_toml(path: Path, text: str) -> dict[str, Any]:
    try:
        content: dict[str, Any] = msgspec.toml.decode(text, type=dict[str, Any])
    except (msgspec.DecodeError, msgspec.ValidationError) as error:
        raise _no_board(path, str(error)) from error
    for name, value in content.items():
        if name not in _OPTIONS:
            raise _no_board(path, f"there is no option {name!r}, only {', '.join(_OPTIONS)}")
        try:
            content[name] = msgspec.convert(value, _OPTIONS[name])
        except msgspec.ValidationError as error:
            raise _no_board(path, f"{name}: {error}") from error
    missing = [name for name in ("kind", "columns", "rows", "square_mm") if name not in content]
    if missing:
        raise _no_board(path, f"{', '.join(missing)} is missing")
    return content


def _of_kalibr(path: Path, text: str) -> dict[str, Any]:
    """https://github.com/ethz-asl/kalibr/wiki/calibration-targets. Lengths there are metres; a
    checkerboard's rows and columns count inner corners."""
    try:
        content: Any = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise _no_board(path, "it is no YAML") from error
    if not isinstance(content, dict) or "target_type" not in content:
        raise _no_board(path, "a YAML of Kalibr has target_type")
    kind = str(content["target_type"])
    if kind not in _KALIBR:
        raise StorageError(
            f"{path} is a {kind[:30]} of Kalibr, of which {listed(list(_KALIBR))} are read; give "
            "the board with --board.*."
        )
    try:
        if kind == "aprilgrid":
            tag, spacing = _length(content["tagSize"]), float(content["tagSpacing"])
            found: dict[str, Any] = {
                "columns": int(content["tagCols"]),
                "rows": int(content["tagRows"]),
                "square_mm": tag * (1 + spacing),
                "marker_mm": tag,
                "dictionary": "DICT_APRILTAG_36H11",
            }
            if content.get("startId"):
                found["first_id"] = int(content["startId"])
        elif kind == "circlegrid":
            found = {
                "columns": int(content["targetCols"]),
                "rows": int(content["targetRows"]),
                "square_mm": _length(content["spacingMeters"]),
            }
            if content.get("asymmetricGrid"):
                found["kind"] = "asymmetric-circles"
        else:
            across = _length(content["colSpacingMeters"])
            down = _length(content["rowSpacingMeters"])
            found = {
                "columns": int(content["targetCols"]) + 1,
                "rows": int(content["targetRows"]) + 1,
                "square_mm": down,
            }
            if across != down:
                found["square_x_mm"] = across
    except (KeyError, TypeError, ValueError) as error:
        raise _no_board(path, f"a value is missing or wrong ({error})") from error
    return {"kind": _KALIBR[kind], **found}


def _length(metres: Any) -> float:
    """Millimetres, to a nanometre."""
    length = round(1000 * float(metres), 6)
    if not 0 < length < math.inf:
        raise ValueError(f"a length of {metres} m")
    return length


def _of_calib_io(named: re.Match[str], path: Path) -> dict[str, Any]:
    found: dict[str, Any] = {
        "kind": _CALIB_IO_KINDS[named["kind"].lower()],
        "columns": int(named["columns"]),
        "rows": int(named["rows"]),
        "square_mm": float(named["square"]),
    }
    if found["kind"] == "chessboard":
        return found
    if found["kind"] == "circles":
        if named["marker"] is None:
            raise _no_board(path, "the name does not end in the circles' distance and diameter")
        return {**found, "marker_mm": float(named["marker"])}
    if named["family"] is None:
        raise _no_board(path, "the name does not end in a dictionary such as DICT_4X4")
    if named["marker"] is not None:
        found["marker_mm"] = float(named["marker"])
    whole = f"{named['family']}{named['number'] or ''}"
    family = whole if whole.upper() in DICTIONARIES else named["family"]
    found["dictionary"] = _with_enough(family, found["columns"] * found["rows"] // 2, path)
    return found


def _with_enough(family: str, markers: int, path: Path) -> str:
    """The smallest dictionary of a family with so many markers: the larger begin with the same."""
    if family.upper() in DICTIONARIES:
        return family.upper()
    sizes = sorted(
        int(name.rpartition("_")[2])
        for name in DICTIONARIES
        if name.rpartition("_")[0] == family.upper()
    )
    enough = [size for size in sizes if size >= markers]
    if not enough:
        raise _no_board(path, f"no dictionary {family} has the {markers} markers that it needs")
    return f"{family.upper()}_{enough[0]}"
