"""Reads lessons from TOML files: those of teachers and those shipped with the program.

Every mistake becomes one sentence with file, line, cause and cure (`mistakes`). docs/lessons.md
describes the keys.
"""

from __future__ import annotations

import re
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

import msgspec

from venus3d.engine.errors import VenusError
from venus3d.languages import Language
from venus3d.lessons.lesson import Lesson, LessonFile
from venus3d.lessons.line_numbers import lines_of
from venus3d.lessons.mistakes import LessonError, syntax_mistake, value_mistake
from venus3d.regular_file import read_regular

_LARGEST_BYTES = 200_000
"""A hundred times a lesson that ships; beyond that, reading and drawing take minutes."""
_MANY_KEYS = re.compile(r"""(?<!["'\w-])(?:["'\w-]+[ \t]*\.[ \t]*){20}""")
"""A key of twenty parts, which the TOML reader takes minutes for."""
_TOO_DEEP = "lists or tables are nested too deeply in it; a lesson needs no more than two levels"


def read_lesson(path: str | Path) -> Lesson:
    """The lesson of a file. Raises `LessonError`, with file and line, for any mistake."""
    file = Path(path)
    text = _text_of(file)
    if _MANY_KEYS.search(text):
        raise LessonError(file.name, 1, _TOO_DEEP)
    try:
        return _lesson(file, text)
    except RecursionError:
        raise LessonError(file.name, 1, _TOO_DEEP) from None
    except ValueError:  # Python's own limit of 4300 digits
        raise LessonError(file.name, 1, "a number in it has too many digits") from None


def _lesson(file: Path, text: str) -> Lesson:
    raw: Any = None
    try:
        raw = _stripped(msgspec.toml.decode(text))
        content = msgspec.convert(raw, LessonFile)
    except msgspec.ValidationError as error:
        where, sentence = value_mistake(error, raw)
        raise LessonError(file.name, lines_of(text).line(where), sentence) from None
    except msgspec.DecodeError as error:
        # The reader's line is where it gave up: right for a duplicate key and for a bad character
        # in a long text, but far below whatever was not closed.
        said = re.search(r"at line (\d+)", str(error))
        line = int(said.group(1)) if said else 1
        if "\\" not in str(error):
            line = lines_of(text).broken or line
        sentence = syntax_mistake(str(error), text.splitlines()[line - 1])
        raise LessonError(file.name, line, sentence) from None
    return Lesson(file.stem, content.title, content.summary, content.page, content.language)


def shipped_lessons(language: Language = "en") -> tuple[Lesson, ...]:
    """The lessons shipped with the program, in the order of their files' numbers; in English where
    they are not translated."""
    folder = _shipped_folder()
    english = _read_folder(folder)
    if language == "en":
        return english
    others = {lesson.name: lesson for lesson in _read_folder(folder / language)}
    return tuple(others.get(lesson.name, lesson) for lesson in english)


def lesson_of(choice: str, language: Language = "en") -> Lesson:
    """The lesson with this name: "" the first, a file (.toml), or a shipped one.
    The number may be omitted: "gimbal-lock". Raises `VenusError` for an unknown one."""
    if choice.lower().endswith(".toml") or "/" in choice or "\\" in choice:
        return read_lesson(choice)
    names = {lesson.name: lesson for lesson in shipped_lessons(language)}
    for name, lesson in names.items():
        if choice.lower() in ("", name, name.split("-", 1)[1], name.split("-", 1)[0]):
            return lesson
    short = [name.split("-", 1)[1] for name in names]
    near = get_close_matches(choice.lower(), short, n=1)
    cure = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(short)}."
    raise VenusError(f"There is no lesson {choice!r}; {cure} A file of your own ends in .toml.")


@lru_cache
def _read_folder(folder: Path) -> tuple[Lesson, ...]:
    files = sorted(folder.glob("*.toml"), key=lambda path: int(path.name.partition("-")[0]))
    return tuple(read_lesson(path) for path in files)


def _shipped_folder() -> Path:
    """The lessons' folder: in the installed package, or beside it in a source tree."""
    inside = Path(__file__).parent / "shipped"
    return inside if inside.is_dir() else Path(__file__).parents[2] / "assets" / "lessons"


def _text_of(file: Path) -> str:
    try:
        content = read_regular(file)
    except FileNotFoundError:
        raise VenusError(f"There is no lesson file {file}; check the name.") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise VenusError(
            f"The lesson {file} cannot be read ({reason}); give another file."
        ) from None
    if len(content) > _LARGEST_BYTES:
        raise VenusError(
            f"The lesson {file} has {len(content)} bytes; one has at most {_LARGEST_BYTES}, so "
            "make several of it."
        )
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise LessonError(
            file.name,
            line,
            "this is not UTF-8 text; save the file once more with the encoding UTF-8",
        ) from None


def _stripped(raw: Any) -> Any:
    """Strips the space around texts, so that blank ones are empty."""
    if isinstance(raw, dict):
        return {key: _stripped(value) for key, value in raw.items()}
    if isinstance(raw, list):
        return [_stripped(value) for value in raw]
    return raw.strip() if isinstance(raw, str) else raw
