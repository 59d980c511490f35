"""Mistakes in a lesson file, explained to a teacher who knows no Python.
msgspec and the TOML reader find the mistake; cause and cure are worded here."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any, get_args

from msgspec import ValidationError

from venus3d.engine.errors import VenusError
from venus3d.lessons import lesson
from venus3d.lessons.line_numbers import KeyPath

_KEYS = {
    "lesson": lesson.LessonFile.__struct_fields__,
    "page": lesson.LessonPage.__struct_fields__,
    "question": lesson.Question.__struct_fields__,
}
_CHOICES: dict[str, tuple[str, ...]] = {
    "viewpoint": lesson.VIEWPOINTS,
    "arrangement": get_args(lesson.Arrangement),
    "order": get_args(lesson.OtherOrder),
    "show": lesson.EXTRAS,
}
_KINDS = {
    "page": "a table of its own; begin it with [[page]]",
    "question": "a table of its own; begin it with [page.question]",
    "pose": "a list of six numbers: pose = [xr, yr, zr, xt, yt, zt]",
    "show": f"a list of words out of {', '.join(lesson.EXTRAS)}: show = [...]",
    "answers": "a list of at least 2 texts: answers = [...]",
    "right": "a whole number",
}
_NO_PAGE = "a lesson needs a page; begin one with [[page]]"
# (part of the TOML reader's message, remedy)
_SYNTAX_CURES = (
    ("unclosed array", "the list never ends, or a comma is missing; close it with ]"),
    ("end of document", 'a text or list begins here and never ends; close it with """ or ]'),
    ("overwrite", "this key stands here twice; keep one of them"),
    ("twice", "this key stands here twice; keep one of them"),
    ("after a key", "write: key = value, and put text between quotation marks"),
    ("invalid value", "put text between quotation marks, write numbers with a point (12.5)"),
    ("illegal character", 'close the text with a quotation mark; longer text stands between """'),
    ("escape", "write \\\\ for a backslash"),
    ("after a statement", "one key on each line; are quotation marks or commas missing?"),
    ("statement", "lines are: key = value, [[page]], [page.question], or a # remark"),
)


_LONGEST = 400
"""Characters of a sentence; a value that is quoted in it may be of any length."""


class LessonError(VenusError):
    """A mistake in a lesson file: "lesson.toml, line 12: ..."."""

    def __init__(self, file: str, line: int, sentence: str) -> None:
        """The mistake in `sentence` on this line, counted from 1."""
        if len(sentence) > _LONGEST:
            sentence = f"{sentence[:_LONGEST]}..."
        super().__init__(f"{file}, line {line}: {sentence}{'' if sentence[-1] in '.?' else '.'}")


def syntax_mistake(message: str, line: str) -> str:
    """The sentence for a line of invalid TOML, from the TOML reader's message."""
    cause = re.sub(r"\s*\(at .*\)$", "", message)
    cure = next((f": {cure}" for part, cure in _SYNTAX_CURES if part in message.lower()), "")
    return f"{cause[0].lower()}{cause[1:]} in {line.strip()[:60]!r}{cure}"


def value_mistake(error: ValidationError, raw: Any) -> tuple[KeyPath, str]:
    """The place of the mistake that msgspec found in `raw`, and the sentence for it."""
    cause, _, where = str(error).partition(" - at `$")
    path: KeyPath = tuple(
        name or int(index) for name, index in re.findall(r"\.(\w+)|\[(\d+)\]", where)
    )
    if error.__cause__ is not None:
        key, sentence = error.__cause__.args
        return (*path, key), sentence
    key = next((part for part in reversed(path) if isinstance(part, str)), "lesson")
    if match := re.match(r"Object (contains|missing).* field `(.*)`", cause, re.DOTALL):
        name = match.group(2)
        if match.group(1) == "contains":
            cure = _did_you_mean(name, _KEYS[key], "it has")
            return (*path, name), f"a {key} has no {name!r}; {cure}"
        missing = f"a {key} needs {name} = ...; it is missing"
        return (*path, name), _NO_PAGE if name == "page" else missing
    value = raw
    for part in path:
        value = value[part]
    return path, _sentence(key, value, path)


def _sentence(key: str, value: Any, path: KeyPath) -> str:
    if key in _CHOICES and (key != "show" or isinstance(path[-1], int)):
        cure = _did_you_mean(str(value), _CHOICES[key], "it is one of")
        return f"{key} cannot be {value!r}; {cure}"
    if key == "pose" and isinstance(path[-1], int):
        return f"{lesson.POSE_RANGES[path[-1]][0]} of the pose is a number, not {value!r}"
    if key == "page" and value == []:
        return _NO_PAGE
    if value == "":
        return f"{key} is empty; write something, or take it out"
    kind = _KINDS.get(key, "text between quotation marks")
    if isinstance(value, list):
        here = f"is {len(value)}" if len(value) == 1 else f"are {len(value)}"
        return f"{key} is {kind}; here {here}"
    return f"{key} is {kind}" + ("" if isinstance(value, dict) else f", not {value!r}")


def _did_you_mean(word: str, known: Sequence[str], otherwise: str) -> str:
    near = get_close_matches(word.lower(), known, n=1, cutoff=0.5)
    return f"did you mean {near[0]!r}?" if near else f"{otherwise} {', '.join(known)}"
