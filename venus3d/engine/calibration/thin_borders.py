"""Markers whose border is thin: reads them in the squares of their board where detection fails.

A marker is found by its black border on a white one. Where the corners of the squares are known
nevertheless (`plain_patterns`), its bits can be looked up without either.
"""

from __future__ import annotations

from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array
from venus3d.engine.sentences import Sentence

Border = Literal["black", "white"]
"""The black border of a marker, or the white one around it."""

Grey = NDArray[np.uint8]

WIDE_ENOUGH = 0.7
"""Cells of a marker that the white border around it must be wide; OpenCV asks for as much. With 0.1
to 0.4 cells, renders of 0.05 px rms have 0.3 to 0.6 px."""
_PATCH_PX = 96
_SHARES = np.arange(0.5, 1.0, 0.03)
"""Sides of a marker that are tried, as shares of a square's."""
_FEWEST, _MOST_MISSED = 4, 0.5
"""Different markers that rule out chance, and the share of squares that may be unread."""
_LEAST_CONTRAST = 25
_OUTER = 0.8
"""Where the black border is looked at, cells from the bits: the outer part of its one cell."""


def thin_border(grey: Grey, corners: Array, board: Board) -> Border | None:
    """Which border of the markers of `board` in an image is too thin: their own black one, or the
    white one around them. None if they are not its markers.

    Args:
        grey: (H, W).
        corners: (R, C, 2) the board's inner corners, pixels.
    """
    patches = [patch for patch in _squares(grey, corners) if np.ptp(patch) > _LEAST_CONTRAST]
    read = [_read(patches, board, float(share)) for share in _SHARES]
    most = max(len(ids) for ids, _ in read)
    # Half of the squares are plain.
    if most < max(_FEWEST, (1 - _MOST_MISSED) * len(patches) / 2):
        return None
    good = [light for ids, light in read if len(ids) == most]
    return "black" if good[len(good) // 2] > 0.5 else "white"


def thin_border_diagnosis(board: Board) -> Diagnosis | None:
    """That the white border around a board's markers is thin; None if it is wide enough."""
    cell = board.marker / (int(board.cv_dictionary.markerSize) + 2)
    border = (board.square - board.marker) / 2
    if border >= WIDE_ENOUGH * cell:
        return None
    return Diagnosis(
        "thin-border",
        Sentence(
            "The white border around the markers is only {border:.2g} mm wide, where a marker's "
            "cell is {cell:.2g} mm: the corners of the squares are found less exactly, or not at "
            "all."
        ).format(border=1000 * border, cell=1000 * cell),
        Sentence("Print a board whose markers are three quarters as wide as its squares."),
    )


def _squares(grey: Grey, corners: Array) -> list[Array]:
    """Each square between four corners, upright."""
    edge = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32) * _PATCH_PX - 0.5
    found: list[Array] = []
    for row in range(corners.shape[0] - 1):
        for column in range(corners.shape[1] - 1):
            quad = corners[[row, row, row + 1, row + 1], [column, column + 1, column + 1, column]]
            H = cv2.getPerspectiveTransform(quad.astype(np.float32), edge)
            patch: Any = cv2.warpPerspective(grey, H, (_PATCH_PX, _PATCH_PX))
            found.append(np.asarray(patch, dtype=np.float64))
    return found


def _read(patches: list[Array], board: Board, share: float) -> tuple[set[int], float]:
    """The ids read with markers of a size, and how light their black border is, 0 ... 1."""
    dictionary: Any = board.cv_dictionary
    n = int(dictionary.markerSize)
    cell = share * _PATCH_PX / (n + 2)
    at = (_PATCH_PX - 1) / 2 + (np.arange(n) - (n - 1) / 2) * cell
    out = (_PATCH_PX - 1) / 2 + np.array([-1, 1]) * (n / 2 + _OUTER) * cell
    ids: set[int] = set()
    light: list[float] = []
    for patch in patches:
        middle = (patch.min() + patch.max()) / 2
        seen = patch if not board.inverted else 2 * middle - patch
        white = seen[np.ix_(np.rint(at).astype(int), np.rint(at).astype(int))] > middle
        found, number, _ = dictionary.identify(white.astype(np.uint8), 0.0)
        if found:
            ids.add(int(number))
            edge = np.clip(np.rint(out), 0, _PATCH_PX - 1).astype(int)
            light.append(float((seen[np.ix_(edge, np.rint(at).astype(int))] > middle).mean()))
    return ids, float(np.mean(light)) if light else 0.0
