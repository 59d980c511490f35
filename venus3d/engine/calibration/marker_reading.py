"""Reads the square markers of all dictionaries in one pass, mirrored ones too.

OpenCV compares each candidate with each marker of one dictionary. To find out which markers a
picture shows at all, the bits of a candidate are looked up in a table of all of them instead.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.geometry.board import DICTIONARIES
from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]

_CELL_PX = 4
_LEAST_CONTRAST = 25
"""Grey levels between a marker's white and black."""
_OWN = 1.12
"""Outlines this many times as large as a marker's smallest are of something around it."""
_TWICE = 4
"""Different markers seen twice in one image: two boards."""
_DOUBLE_BORDER = "DICT_APRILTAG"
"""Kalibr prints these with a border of two cells."""


@dataclass(frozen=True, eq=False)
class Markers:
    """The markers of one dictionary in one image."""

    dictionary: str
    """The largest of its family: all of a family begin with the same markers."""
    ids: NDArray[np.intp]
    """(N,)"""
    quads: Array
    """(N, 4, 2) corners in pixels, clockwise from the marker's own top left."""

    @property
    def distinct(self) -> int:
        """Number of different markers."""
        return int(np.unique(self.ids).size)

    @property
    def flipped(self) -> Markers:
        """The markers of the mirror image, with x negative, of those found only in it."""
        return Markers(self.dictionary, self.ids, self.quads[:, [1, 0, 3, 2]] * np.array([-1, 1]))


def family_of(dictionary: str) -> str:
    """The name without its size: DICT_5X5_100 and DICT_5X5_1000 begin with the same markers."""
    stem, _, size = dictionary.rpartition("_")
    return stem if size.isdigit() else dictionary.upper()


def shows_twice(ids: ArrayLike) -> bool:
    """Whether the ids (N,) of one image's markers are those of two equal boards."""
    return int((np.unique(ids, return_counts=True)[1] > 1).sum()) >= _TWICE


def size_key(dictionary: str) -> tuple[bool, str, int]:
    """Sort key of the dictionaries: ArUco's families with sizes first, each by size."""
    size = dictionary.rpartition("_")[2]
    return (not size.isdigit(), family_of(dictionary), int(size) if size.isdigit() else 0)


def read_markers(grey: Grey) -> tuple[list[Markers], list[Markers]]:
    """All markers in an image (H, W) by dictionary, the most first; likewise those that are
    markers only in the mirror image, where `quads` are those of this image."""
    negative = np.asarray(255 - grey, dtype=np.uint8)
    black_on_white, white_on_black = _all_of(grey), _all_of(negative)
    best = max((black_on_white, white_on_black), key=lambda both: max(map(_count, both)))
    return _sorted(best[0]), _sorted(best[1])


_Found = dict[str, list[tuple[int, Array]]]


def _count(found: _Found) -> int:
    """The number of markers of the dictionary that has the most."""
    return max(map(len, found.values()), default=0)


def _all_of(grey: Grey) -> tuple[_Found, _Found]:
    """By dictionary the ids and quads of black markers on white: upright, and mirrored."""
    upright: _Found = defaultdict(list)
    mirrored: _Found = defaultdict(list)
    for quad in _candidates(grey):
        for name, number, turns, flipped in _read(grey, quad):
            found = mirrored if flipped else upright
            found[name].append((number, np.roll(quad, turns, axis=0)))
    return upright, mirrored


def _sorted(found: _Found) -> list[Markers]:
    merged = {name: _merged(seen) for name, seen in found.items()}
    all_of = [
        Markers(name, np.array([n for n, _ in seen], np.intp), np.array([q for _, q in seen]))
        for name, seen in merged.items()
    ]
    return sorted(all_of, key=lambda markers: -markers.distinct)


def _merged(seen: list[tuple[int, Array]]) -> list[tuple[int, Array]]:
    """Each marker once: it is found with several thresholds, and in outlines around its own. Its
    own are the smallest, and their mean is taken."""
    groups: list[tuple[int, list[Array]]] = []
    for number, quad in sorted(seen, key=lambda one: _diagonal(one[1])):
        for other, quads in groups:
            apart = float(np.linalg.norm((quad - quads[0]).mean(axis=0)))
            if other == number and apart < _diagonal(quads[0]) / 2:
                if _diagonal(quad) < _OWN * _diagonal(quads[0]):
                    quads.append(quad)
                break
        else:
            groups.append((number, [quad]))
    return [(number, np.mean(quads, axis=0)) for number, quads in groups]


def _diagonal(quad: Array) -> float:
    return float(np.linalg.norm(quad[2] - quad[0]))


def _candidates(grey: Grey) -> Array:
    """(N, 4, 2) quadrangles that may be markers, clockwise."""
    # Compared with a single marker, nearly all come back as rejected.
    whole: Any = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    one = cv2.aruco.Dictionary(whole.bytesList[:1], whole.markerSize, 0)
    parameters = cv2.aruco.DetectorParameters()
    parameters.errorCorrectionRate = 0.0
    parameters.minGroupDistance = 0.0  # a square around a marker does not hide it
    parameters.minMarkerDistanceRate = 0.0
    accepted, _, rejected = cv2.aruco.ArucoDetector(one, parameters).detectMarkers(grey)
    return np.asarray([*accepted, *rejected], dtype=np.float64).reshape(-1, 4, 2)


def _read(grey: Grey, quad: Array) -> list[tuple[str, int, int, bool]]:
    """(dictionary, id, turns, mirrored) of every marker that a candidate can be."""
    found: list[tuple[str, int, int, bool]] = []
    for cells in _tables():
        bits = _bits(grey, quad, cells)
        if bits is not None:
            for border, table in _tables()[cells]:
                ring = bits.copy()
                inner = slice(border, cells - border)
                ring[inner, inner] = False
                if not ring.any():
                    found += table.get(np.packbits(bits[inner, inner]).tobytes(), ())
    return found


def _bits(grey: Grey, quad: Array, cells: int) -> NDArray[np.bool_] | None:
    """(cells, cells) which are white on black; None if there are no two greys, or no border."""
    side = cells * _CELL_PX
    square = np.array([[0, 0], [side, 0], [side, side], [0, side]], dtype=np.float32) - 0.5
    H = cv2.getPerspectiveTransform(quad.astype(np.float32), square)
    patch = np.asarray(cv2.warpPerspective(grey, H, (side, side)), dtype=np.float64)
    inner = patch.reshape(cells, _CELL_PX, cells, _CELL_PX)[:, 1:-1, :, 1:-1].mean(axis=(1, 3))
    low, high = float(inner.min()), float(inner.max())
    if high - low < _LEAST_CONTRAST:
        return None
    white = inner > (low + high) / 2
    edge = np.concatenate([white[0], white[-1], white[:, 0], white[:, -1]])
    return None if edge.any() else white


@lru_cache(maxsize=1)
def _tables() -> dict[int, list[tuple[int, dict[bytes, list[tuple[str, int, int, bool]]]]]]:
    """By cells along a side: width of the border, and the markers by their bits."""
    largest = {family_of(name): name for name in sorted(DICTIONARIES, key=size_key)}
    tables: dict[tuple[int, int], dict[bytes, list[tuple[str, int, int, bool]]]] = {}
    for name in sorted(set(largest.values()), key=size_key):
        dictionary: Any = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))
        size = int(dictionary.markerSize)
        bits = np.array([_bits_of(entry, size) for entry in dictionary.bytesList])
        borders = (1, 2) if name.startswith(_DOUBLE_BORDER) else (1,)
        for border in borders:
            table = tables.setdefault((size + 2 * border, border), {})
            for flipped in (False, True):
                for turns in range(4):
                    shown = np.rot90(np.flip(bits, 2) if flipped else bits, turns, axes=(1, 2))
                    keys = np.packbits(shown.reshape(len(bits), -1), axis=1)
                    for number, key in enumerate(keys):
                        table.setdefault(key.tobytes(), []).append((name, number, turns, flipped))
    by_cells: dict[int, list[tuple[int, dict[bytes, list[tuple[str, int, int, bool]]]]]] = {}
    for (cells, border), table in tables.items():
        by_cells.setdefault(cells, []).append((border, table))
    return by_cells


def _bits_of(entry: Any, size: int) -> NDArray[np.uint8]:
    """(size, size) the bits of a marker's row in a dictionary's `bytesList`."""
    bits: Any = cv2.aruco.Dictionary.getBitsFromByteList(entry[None], size)
    return np.asarray(bits, dtype=np.uint8).reshape(size, size)
