"""`venus3d board --find SOURCE`: which board pictures show, and the options to copy."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import closing
from itertools import count

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.cli.progress import print_note
from venus3d.engine.calibration.board_finding import FoundBoard, find_boards
from venus3d.engine.calibration.board_recognition import recognise_board
from venus3d.engine.errors import SourceError
from venus3d.engine.geometry.board import KINDS, Board
from venus3d.engine.sentences import listed
from venus3d.sources.folder import Folder
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.video import Video

_LOOKED_AT = 12
"""Pictures: a board that is not told by so many is told by no more."""
_KEPT = 3
"""Pictures kept to see whether they are mirror images, if no board is found."""
_EVERY = 15
"""Frames from one look at a camera to the next."""


def find_board(source: str) -> None:
    """Print what the pictures of a source show. Raises `SourceError` if that is no board, or a
    mirror image."""
    looked = 0
    first: list[NDArray[np.uint8]] = []

    def counted() -> Iterator[NDArray[np.uint8]]:
        nonlocal looked
        for grey in _pictures(source):
            looked += 1
            if len(first) < _KEPT:
                first.append(grey)
            yield grey

    found = find_boards(counted())
    said = None if found else recognise_board(Board(), first)
    if said is not None and said.kind == "mirrored":
        raise SourceError(str(said))
    if not found:
        raise SourceError(
            f"No board is seen in {looked} pictures of {source}: neither markers of OpenCV's "
            "dictionaries in rows, nor a chessboard, nor a grid of circles. Show the whole board, "
            "nearer, sharp and evenly lit."
        )
    if len(found) > 1:
        print(f"{len(found)} boards are seen: calibrate with one of them, and cover the others.")
    for board in found:
        print(f"{_described(board)}; in {board.pictures} of {looked} pictures")
        print(f"    {_to_copy(board)}")


def _described(board: FoundBoard) -> str:
    unit = KINDS[board.kind].unit if board.kind in KINDS else "markers"
    parts = [f"{board.columns} x {board.rows} {unit}"]
    if board.dictionary:
        ids = f"ids from {board.first_id}" if board.first_id else "ids from 0"
        parts += [board.dictionary, ids]
    if board.legacy:
        parts.append("the layout used before OpenCV 4.6")
    if board.inverted:
        parts.append("white on a dark ground")
    if math.isfinite(board.share):
        wide = "the distance from one to the next" if unit == "tags" else "a square"
        parts.append(f"markers {board.share:.2f} of {wide}")
    if not board.whole:
        parts.append("only a part is seen")
    name = KINDS[board.kind].name if board.kind in KINDS else board.kind.replace("-", " ")
    return f"{name}: {', '.join(parts)}"


def _to_copy(board: FoundBoard) -> str:
    if board.kind not in KINDS:
        return f"This kind is not read; one of {listed(list(KINDS))} is (venus3d board --help)."
    lengths = " --board.square-mm SQUARE"
    if KINDS[board.kind].unit == "circles":
        lengths += " --board.marker-mm DIAMETER   (measure both; SQUARE from one row to the next)"
    if math.isfinite(board.share):
        lengths += f" --board.marker-mm MARKER   (measure both; about {board.share:.2f} SQUARE)"
    return board.options + lengths


def _pictures(source: str) -> Iterator[NDArray[np.uint8]]:
    """Grey pictures from all over the source."""
    with closing(open_frame_source(source)) as opened:
        if isinstance(opened, Folder):
            step = math.ceil(len(opened) / _LOOKED_AT)
        elif isinstance(opened, Video):
            step = max(1, (opened.announced or _EVERY * _LOOKED_AT) // _LOOKED_AT)
        else:
            step = _EVERY
        left = _LOOKED_AT
        for number in count():
            frame = opened.read() if left else None
            if frame is None:
                # Only now it is known what could not be read.
                for note in opened.notes:
                    print_note(note)
                return
            if number % step == 0:
                left -= 1
                image = frame.image
                grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.ndim == 3 else image
                if grey.dtype == np.uint16:
                    grey = (grey / max(1, int(grey.max())) * 255).astype(np.uint8)
                yield np.asarray(grey, dtype=np.uint8)
