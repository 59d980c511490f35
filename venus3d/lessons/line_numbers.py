"""Finds the line of a key in a lesson file: TOML readers give lines for syntax errors only."""

from __future__ import annotations

from dataclasses import dataclass

import msgspec

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
    """Find the headers and keys of a TOML text, parsing each statement by itself, line by line."""
    found: dict[KeyPath, int] = {}
    counts: dict[KeyPath, int] = {}
    table: KeyPath = ()
    statement, begun = "", 1
    for number, line in enumerate(text.splitlines(), start=1):
        if not statement:
            if not line.strip() or line.lstrip().startswith("#"):
                continue
            begun = number
        statement += f"{line}\n"
        if number > begun and not any(end in line for end in ('"""', "'''", "]")):
            continue  # reparsing a long statement at every line would take minutes
        try:
            content = msgspec.toml.decode(statement)
        except msgspec.DecodeError:
            continue
        if statement.lstrip().startswith("["):
            table = _table_of(content, counts)
            found.setdefault(table, begun)
            found.setdefault(table[:-1], begun)  # an array of tables starts with its first one
        else:
            found.setdefault((*table, next(iter(content))), begun)
        statement = ""
    return Lines(found, begun if statement else None)


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
