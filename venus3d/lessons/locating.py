"""On which line of a lesson file a key stands.

TOML readers tell lines of syntax errors only; what is wrong with a value that was read is found
again here. Knows no more of TOML than a lesson needs: headers, keys, strings and brackets. Whether
the text is TOML at all is said by `reading`.
"""

from __future__ import annotations

from dataclasses import dataclass

Path = tuple[str | int, ...]
"""Where a value stands: ("page", 0, "pose"); tables of an array are counted from 0."""


@dataclass(frozen=True)
class Lines:
    """The lines of a lesson's keys, counted from 1."""

    of: dict[Path, int]
    unclosed: int | None = None
    """Where the string or list begins that never ends."""

    def line(self, path: Path) -> int:
        """The line of a key; of what is around it if it has none of its own."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.of:
                return self.of[path[:length]]
        return 1


def lines_of(text: str) -> Lines:
    """Find every key and header of a TOML text."""
    statements, unclosed = _statements(text)
    found: dict[Path, int] = {}
    counts: dict[Path, int] = {}
    table: Path = ()
    for number, statement in statements:
        if statement.startswith("[["):
            table = _entered(counts, _names(statement[2:].split("]")[0]), new=True)
            found.setdefault(table, number)
            found.setdefault(table[:-1], number)
        elif statement.startswith("["):
            table = _entered(counts, _names(statement[1:].split("]")[0]), new=False)
            found.setdefault(table, number)
        elif "=" in statement:
            found.setdefault((*table, *_names(statement.split("=")[0])), number)
    return Lines(found, unclosed)


def _entered(counts: dict[Path, int], names: Path, *, new: bool) -> Path:
    """The header's path; a name that is an array of tables stands for its last one."""
    path: Path = ()
    for i, name in enumerate(names):
        path = (*path, name)
        if new and i == len(names) - 1:
            counts[path] = counts.get(path, -1) + 1
        if path in counts:
            path = (*path, counts[path])
    return path


def _names(dotted: str) -> Path:
    return tuple(part.strip().strip("\"'") for part in dotted.split("."))


def _statements(text: str) -> tuple[list[tuple[int, str]], int | None]:
    """The first lines of all headers and assignments, and the line of what is never closed."""
    statements: list[tuple[int, str]] = []
    quote, depth, begun = "", 0, 1
    for number, line in enumerate(text.splitlines(), start=1):
        inside = bool(quote) or depth > 0
        stripped = line.strip()
        if not inside:
            begun = number
            if stripped and not stripped.startswith("#"):
                statements.append((number, stripped))
        header = not inside and stripped.startswith("[")
        quote, depth = _after(line, quote, depth)
        if header:
            depth = 0
    return statements, begun if quote or depth > 0 else None


def _after(line: str, quote: str, depth: int) -> tuple[str, int]:
    """The open multi-line string ("" if none) and the depth of brackets at the end of a line."""
    i = 0
    while i < len(line):
        if quote:
            if line[i] == "\\" and quote[0] == '"':
                i += 2
                continue
            if line.startswith(quote, i):
                i += len(quote)
                quote = ""
                continue
        elif line[i] in "\"'":
            quote = line[i] * 3 if line.startswith(line[i] * 3, i) else line[i]
            i += len(quote)
            continue
        elif line[i] == "#":
            break
        else:
            depth = max(0, depth + (line[i] in "[{") - (line[i] in "]}"))
        i += 1
    # A string in single marks ends with its line, rightly or not.
    return (quote if len(quote) == 3 else ""), depth
