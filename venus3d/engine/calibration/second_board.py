"""Tells another board beside the one that was found, by markers and patterns outside its place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_diagnoses import second_board_diagnosis
from venus3d.engine.calibration.board_finding import FoundBoard, marked_boards, plain_boards
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.marker_lattice import Lattice
from venus3d.engine.calibration.marker_reading import family_of
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.refinement import local_scales
from venus3d.engine.geometry.board import KINDS, Board
from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]

_AROUND = 1.1
"""Squares around each point that are the board's own: half a square more than the outermost ones
have, of tags their joints."""
_NEAR = 0.3
"""Largest deviation of a marker from its place on the board, in squares."""
_PLAIN_LOOKS = 2
_OWN = 0.5
"""Share of a lattice's markers that make it the board itself, if they are its own or go on where it
ends: more rows than were asked for."""


def second_board(board: Board, seen: Observation, grey: Grey) -> FoundBoard | None:
    """Another board in an image (H, W) in which `board` was `seen`; None if there is none. What it
    costs: docs/diagnoses.md."""
    outside = _without(board, seen, grey)
    marked = [
        found
        for lattice, found in marked_boards(outside)
        if found.kind in KINDS and not _is_own(board, seen, lattice, found)
    ]
    plain = [] if marked else plain_boards([outside], quick=True)
    return max([*marked, *plain], key=lambda one: one.markers, default=None)


def told_by(looks: Sequence[FoundBoard | None]) -> Diagnosis | None:
    """What several images show beside the board, by `second_board` of each. A pattern without
    markers must be in two of them alike."""
    seen = [one for one in looks if one is not None]
    alike = [
        one
        for one in seen
        if one.markers or sum(_is_alike(one, other) for other in seen) >= _PLAIN_LOOKS
    ]
    best = max(alike, key=lambda one: (one.markers > 0, one.whole, one.markers), default=None)
    if best is None:
        return None
    size = (best.columns, best.rows) if best.whole else None
    return second_board_diagnosis(best.kind, size, best.dictionary, best.first_id, best.options)


def _is_alike(one: FoundBoard, other: FoundBoard) -> bool:
    return (one.kind, one.columns, one.rows) == (other.kind, other.columns, other.rows)


def _without(board: Board, seen: Observation, grey: Grey) -> Grey:
    """The image with the board's place in one grey."""
    scales = local_scales(board, seen.ids, seen.corners)
    side = _AROUND * board.square * board.of_kind.stride
    square = side * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    around = seen.corners[:, None] + np.einsum("nij,kj->nki", scales, square)
    H, _ = cv2.findHomography(board.points_of(seen.ids)[:, :2], seen.corners)
    whole = [] if H is None else [cv2.perspectiveTransform(board.outline[None, :, :2], H)[0]]
    picture = grey.copy()
    tone = float(np.median(grey))
    for polygon in [*around, *whole]:
        limit = 4 * max(grey.shape)  # what is farther is no place in the image
        if np.isfinite(polygon).all() and np.abs(polygon).max() < limit:
            cv2.fillConvexPoly(picture, np.rint(polygon).astype(np.int32), tone)
    return picture


def _is_own(board: Board, seen: Observation, lattice: Lattice, found: FoundBoard) -> bool:
    """Whether the markers are the board's, or would be if it had more rows."""
    if family_of(found.dictionary) != family_of(board.dictionary):
        return False
    number = lattice.ids - board.first_id
    if np.mean((number >= 0) & (number < board.marker_count)) > _OWN:
        return True
    H, _ = cv2.findHomography(seen.corners, board.points_of(seen.ids)[:, :2])
    if H is None:
        return False
    centres: Any = cv2.perspectiveTransform(lattice.quads.mean(axis=1)[None], H)
    at: Array = centres[0] / board.square + (np.array([board.columns, board.rows]) - 1) / 2
    column, row = np.rint(at).T
    if board.kind == "charuco":
        placed = (board.columns * row + column) // 2
    else:
        placed = (board.rows - 1 - row if board.kind == "aprilgrid" else row) * board.columns
        placed = placed + column
    fits = (placed == number) & (np.abs(at - np.rint(at)).max(axis=1) < _NEAR)
    return bool(np.mean(fits) > _OWN)
