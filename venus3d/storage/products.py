"""The mark by which a command knows what it made before: that it may write anew, and nothing else.

It stands at the end of the file, where its format allows a remark that nobody shows.
"""

from __future__ import annotations

import os
import zlib
from contextlib import suppress
from pathlib import Path

from venus3d.storage.folder import write_bytes
from venus3d.storage.places import free_place

_TAIL = 1000
"""Bytes at the end of a file among which the mark is."""
_IEND = 12
"""Bytes of a PNG file's last chunk."""


def write_product(path: Path, content: bytes, kind: str, option: str = "--output") -> Path:
    """Write what a command makes, with its mark. Raises `StorageError` as `product_place` does."""
    return write_bytes(product_place(path, kind, option=option), _marked(path, content, kind))


def product_place(path: Path, kind: str, *sources: Path, option: str = "--output") -> Path:
    """`path`, if a command may write a product of this kind there (`free_place`): nothing is there,
    or an earlier one. Raises `StorageError`."""
    return free_place(path, *sources, replaces=is_made(path, kind), option=option)


def mark_of(kind: str) -> str:
    """The mark of a kind of product."""
    return f"made by venus3d: {kind}"


def is_made(path: Path, kind: str) -> bool:
    """Whether a file is a product of this kind."""
    if not path.is_file():
        return False
    with suppress(OSError), path.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - _TAIL))
        return mark_of(kind).encode() in file.read()
    return False


def _marked(path: Path, content: bytes, kind: str) -> bytes:
    mark = mark_of(kind).encode()
    match path.suffix.lower():
        case ".png":
            chunk = b"tEXtComment\0" + mark
            size, check = len(chunk) - 4, zlib.crc32(chunk)
            chunk = size.to_bytes(4, "big") + chunk + check.to_bytes(4, "big")
            return content[:-_IEND] + chunk + content[-_IEND:]
        case ".gif":
            return content[:-1] + b"!\xfe" + bytes([len(mark)]) + mark + b"\0" + content[-1:]
        case ".mp4":
            return content + (8 + len(mark)).to_bytes(4, "big") + b"free" + mark
        case ".pdf":
            return content + b"%" + mark + b"\n"
        case ".html" | ".svg" | ".md":
            return content + b"<!-- " + mark + b" -->\n"
        case _:
            raise ValueError(f"a file named {path.name} has no place for a mark")
