"""Values taken out of a table of a lesson file, each with the sentence for what is wrong with it.

What belongs into a lesson is said by `reading`; the lines come from `locating`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import isfinite
from typing import Any, TypeVar, cast

from venus3d.engine.errors import VenusError
from venus3d.lessons.locating import Lines, Path

Word = TypeVar("Word", bound=str)
_TYPE_NAMES = (
    (bool, "true or false"),
    (str, "a text"),
    (int, "a number"),
    (float, "a number"),
    (list, "a list"),
    (dict, "a table"),
)


class LessonError(VenusError):
    """Something wrong in a lesson file: "lesson.toml, line 12: ..."."""

    def __init__(self, file: str, line: int, sentence: str) -> None:
        """What is wrong on which line, counted from 1."""
        end = "" if sentence[-1] in ".?" else "."
        super().__init__(f"{file}, line {line}: {sentence}{end}")
        self.line = line


@dataclass(frozen=True)
class Table:
    """A table of a lesson file."""

    file: str
    lines: Lines
    raw: dict[str, Any]
    path: Path
    kind: str
    """What it is, for people: "a page"."""

    def mistake(self, key: str, sentence: str) -> LessonError:
        """The error of what stands at a key of this table."""
        return LessonError(self.file, self.lines.line((*self.path, key)), sentence)

    def expect(self, *known: str) -> None:
        """Raises `LessonError` for the first key that this table does not have."""
        for key in self.raw:
            if key not in known:
                near = get_close_matches(key.lower(), known, n=1, cutoff=0.5)
                cure = f"did you mean {near[0]!r}?" if near else f"it has {', '.join(known)}"
                raise self.mistake(key, f"{self.kind} has no {key!r}; {cure}")

    def text(self, key: str) -> str:
        """A text that is not empty."""
        return self._filled(key, self._needed(key))

    def texts(self, key: str, *, least: int) -> tuple[str, ...]:
        """A list of texts."""
        values = self._list(key, self._needed(key), "texts between quotation marks")
        if len(values) < least:
            raise self.mistake(key, f"{key} needs {least} texts at least; here are {len(values)}")
        return tuple(self._filled(key, value) for value in values)

    def whole_number(self, key: str) -> int:
        """A whole number."""
        value = self._needed(key)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.mistake(key, f"{key} is a whole number, not {_named(value)}")
        return value

    def numbers(
        self, key: str, ranges: Sequence[tuple[str, float, float, str]]
    ) -> tuple[float, ...]:
        """As many numbers as there are ranges (name, lowest, highest, unit)."""
        names = " ".join(name for name, *_ in ranges)
        values = self._list(key, self._needed(key), f"numbers ({names})")
        if len(values) != len(ranges):
            count = {6: "six"}.get(len(ranges), str(len(ranges)))
            here = f"is {len(values)}" if len(values) == 1 else f"are {len(values)}"
            raise self.mistake(key, f"a {key} has {count} numbers, {names}; here {here}")
        for value, (name, low, high, unit) in zip(values, ranges, strict=True):
            if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
                raise self.mistake(key, f"{name} of the {key} is a number, not {_named(value)}")
            if not low <= value <= high:
                raise self.mistake(
                    key,
                    f"{name} of the {key} is {value:g}{unit}; it must be from {low:g} to "
                    f"{high:g}{unit}",
                )
        return tuple(float(value) for value in values)

    def choice(self, key: str, known: tuple[Word, ...], usual: Word) -> Word:
        """One of some words; the usual one where the key is left out."""
        return self._word(key, self.raw[key], known) if key in self.raw else usual

    def choices(self, key: str, known: tuple[Word, ...]) -> tuple[Word, ...]:
        """A list of some words; none where the key is left out."""
        if key not in self.raw:
            return ()
        kind = f"words out of {', '.join(known)}"
        return tuple(self._word(key, v, known) for v in self._list(key, self.raw[key], kind))

    def tables(self, key: str, *, least: int = 0, single: bool = False) -> tuple[Table, ...]:
        """The tables under a key: of `[[key]]`, or the one of `[...key]` if `single`."""
        header = ".".join([*(str(p) for p in self.path if isinstance(p, str)), key])
        header = f"[{header}]" if single else f"[[{header}]]"
        if key not in self.raw:
            if least:
                raise self.mistake(key, f"{self.kind} needs a {key}; begin one with {header}")
            return ()
        value = self.raw[key]
        found = [value] if single else value
        if not isinstance(found, list) or not all(isinstance(t, dict) for t in found):
            raise self.mistake(key, f"{key} is a table of its own; begin it with {header}")
        if len(found) < least:
            raise self.mistake(key, f"{self.kind} needs a {key}; begin one with {header}")
        path = (*self.path, key)
        tables = cast("list[dict[str, Any]]", found)
        return tuple(
            Table(self.file, self.lines, table, path if single else (*path, i), f"a {key}")
            for i, table in enumerate(tables)
        )

    def _needed(self, key: str) -> Any:
        if key not in self.raw:
            # The line of the header, since the key has none.
            raise self.mistake(key, f"{self.kind} needs {key} = ...; it is missing")
        return self.raw[key]

    def _filled(self, key: str, value: Any) -> str:
        if not isinstance(value, str):
            raise self.mistake(key, f"{key} is text between quotation marks, not {_named(value)}")
        if not value.strip():
            raise self.mistake(key, f"{key} is empty; write something, or take {self.kind} out")
        return value.strip()

    def _list(self, key: str, value: Any, kind: str) -> list[Any]:
        if not isinstance(value, list):
            raise self.mistake(key, f"{key} is a list of {kind}: {key} = [...]")
        return cast("list[Any]", value)

    def _word(self, key: str, value: Any, known: tuple[Word, ...]) -> Word:
        if value in known:
            return cast("Word", value)
        near = get_close_matches(str(value).lower(), known, n=1, cutoff=0.5)
        cure = f"did you mean {near[0]!r}?" if near else f"it is one of {', '.join(known)}"
        raise self.mistake(key, f"{key} cannot be {value!r}; {cure}")


def _named(value: Any) -> str:
    for kind, name in _TYPE_NAMES:
        if isinstance(value, kind):
            return f"{value!r}" if isinstance(value, int | float | str) else name
    return f"{value}"
