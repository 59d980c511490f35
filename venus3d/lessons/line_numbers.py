"""Finds the line of a key in a lesson file: TOML readers give lines for syntax errors only."""

from __future__ import annotations

import re
from dataclasses import dataclass

import msgspec

_BRACKETS = {"[": 1, "{": 1, "]": -1, "}": -1}
_TOKEN = re.compile(r"""\"{3}|'{3}|"(?:\\.|[^"\\])*"|'[^']*'|\#|[][{}]""")
_END = {'"""': re.compile(r'(?:\\.|[^\\])*?"""'), "'''": re.compile(r".*?'{3}")}
"""What ends a text of several lines, by the quotes that begin it."""

KeyPath = tuple[str | int, ...]
"""Path of a value: ("page", 0, "pose"); tables of an array count from 0."""


@dataclass(frozen=True)
class Lines:
    """The line numbers of a lesson's keys, from 1."""

    of: dict[KeyPath, int]
    broken: int | None = None
    """Line of the first header or assignment that is invalid TOML or unterminated."""

    def line(self, path: KeyPath) -> int:
        """The line of a key, or of its table if it has none of its own."""
        return next((self.of[path[:n]] for n in range(len(path), 0, -1) if path[:n] in self.of), 1)


def lines_of(text: str) -> Lines:
    """Find the headers and keys of a TOML text, parsing each statement by itself."""
    found: dict[KeyPath, int] = {}
    counts: dict[KeyPath, int] = {}
    table: KeyPath = ()
    statement, begun = "", 1
    depth, quotes = 0, ""
    for number, line in enumerate(text.splitlines(), start=1):
        if not statement:
            if not line.strip() or line.lstrip().startswith("#"):
                continue
            begun, depth = number, 0
        statement += f"{line}\n"
        depth, quotes = _open_after(line, depth, quotes)
        if quotes or depth > 0:
            continue
        try:
            content = msgspec.toml.decode(statement)
        except msgspec.DecodeError:
            return Lines(found, begun)  # nothing is open that a further line could close
        if statement.lstrip().startswith("["):
            table = _table_of(content, counts)
            found.setdefault(table, begun)
            found.setdefault(table[:-1], begun)  # an array of tables starts with its first one
        else:
            found.setdefault((*table, next(iter(content))), begun)
        statement = ""
    return Lines(found, begun if statement else None)


def _open_after(line: str, depth: int, quotes: str) -> tuple[int, str]:
    """How many brackets are open after a line, and the quotes of a text that goes on, or none."""
    at = 0
    while True:
        found = _END[quotes].match(line, at) if quotes else _TOKEN.search(line, at)
        if found is None or found.group() == "#":
            return depth, quotes
        at = found.end()
        if quotes:
            quotes = ""
        elif found.group() in _END:
            quotes = found.group()
        else:
            depth += _BRACKETS.get(found.group(), 0)


def _table_of(content: object, counts: dict[KeyPath, int]) -> KeyPath:
    """The path of a header, parsed as TOML; counts the tables of each array."""
    path: KeyPath = ()
    while isinstance(content, dict) and content:
        ((name, content),) = content.items()
        path = (*path, name)
        if isinstance(content, list):
            counts[path] = counts.get(path, -1) + 1
        if path in counts:
            path = (*path, counts[path])
    return path
