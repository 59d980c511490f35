"""The numeric arrays of a .mat file of version 5, which scipy reads too; but of a damaged file its
compiled reader ends the process.

https://www.mathworks.com/help/pdf_doc/matlab/matfile_format.pdf: a header of 128 bytes, then
elements of a tag (type, bytes) and content; an array is an element of elements (flags, dimensions,
name, real part, imaginary part).
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Collection, Iterator

import numpy as np
from numpy.typing import NDArray

_HEADER, _TAG = 128, 8
_ARRAY, _COMPRESSED = 14, 15
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8"}
_NUMBERS[13] = "u8"
_NUMERIC_CLASSES = range(6, 16)
_COMPLEX = 0x800
_MOST_BYTES = 1 << 20
"""Of one array unpacked: a larger one is no camera's."""


def numeric_arrays(
    content: bytes, names: Collection[str], most: int
) -> dict[str, NDArray[np.float64]]:
    """The arrays of these names with `most` numbers at most. Raises `ValueError` for a damaged
    file, a larger array, one of these names that is not numeric or complex numbers."""
    order = {b"IM": "<", b"MI": ">"}.get(content[_HEADER - 2 : _HEADER])
    if order is None:
        raise ValueError("no byte order")
    found: dict[str, NDArray[np.float64]] = {}
    for kind, body in _elements(content[_HEADER:], order):
        if kind == _COMPRESSED:
            unpacked = zlib.decompressobj().decompress(body, _MOST_BYTES)
            kind, body = next(_elements(unpacked, order, is_cut=True), (0, b""))
        if kind != _ARRAY:
            continue
        parts = [*_elements(body, order, is_cut=True)]
        if len(parts) < 3 or parts[0][0] != 6 or parts[1][0] != 5 or parts[2][0] != 1:
            continue  # MATLAB's own objects
        name = parts[2][1].decode("latin-1")
        if name in names:
            found[name] = _array(parts, order, most)
    return found


def _array(parts: list[tuple[int, bytes]], order: str, most: int) -> NDArray[np.float64]:
    flags = int(np.frombuffer(parts[0][1], f"{order}u4")[0])
    shape = [int(side) for side in np.frombuffer(parts[1][1], f"{order}i4")]
    if flags & 0xFF not in _NUMERIC_CLASSES or flags & _COMPLEX:
        raise ValueError("no real numbers")
    if min(shape) < 0 or math.prod(shape) > most:
        raise ValueError("too large")
    if len(parts) < 4 or parts[3][0] not in _NUMBERS:
        raise ValueError("no numbers")
    numbers = np.frombuffer(parts[3][1], f"{order}{_NUMBERS[parts[3][0]]}")
    return numbers.astype(np.float64).reshape(shape, order="F")


def _elements(content: bytes, order: str, *, is_cut: bool = False) -> Iterator[tuple[int, bytes]]:
    """Type and content of each element; `is_cut`: the last one may break off, as only the beginning
    of a large array was unpacked."""
    at = 0
    while at + _TAG <= len(content):
        first, size = (int(word) for word in np.frombuffer(content, f"{order}u4", 2, at))
        if first >> 16:  # four bytes at most, in the tag itself
            yield first & 0xFFFF, content[at + 4 : at + 4 + min(first >> 16, 4)]
            at += _TAG
            continue
        body = content[at + _TAG : at + _TAG + size]
        if len(body) < size and not is_cut:
            raise ValueError("breaks off")
        yield first, body
        at += _TAG + size
        at += 0 if first == _COMPRESSED else -size % 8
