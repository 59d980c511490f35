"""Lessons out of the TOML files that teachers write, and those that come with the program.

A teacher knows no Python: whatever is wrong with a file ends in one sentence with the file, the
line, the cause and the cure. What a lesson is, is said by `lesson`; what each key may hold, for
people, by docs/lessons.md.
"""

from __future__ import annotations

import re
import sys
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

from venus3d.engine.errors import VenusError
from venus3d.lessons.checking import LessonError, Table
from venus3d.lessons.lesson import (
    ARRANGEMENTS,
    EXTRAS,
    VIEWPOINTS,
    Arrangement,
    Lesson,
    LessonPage,
    Question,
)
from venus3d.lessons.locating import lines_of

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # pyright: ignore[reportMissingImports]

ORDERS: tuple[str, ...] = ("xzy", "yxz", "yzx", "zxy", "zyx")
"""The orders of turns that can be shown beside "xyz"."""
POSE_RANGES: tuple[tuple[str, float, float, str], ...] = (
    ("xr", -180, 180, "°"),
    ("yr", -180, 180, "°"),
    ("zr", -180, 180, "°"),
    ("xt", -2000, 2000, " mm"),
    ("yt", -2000, 2000, " mm"),
    ("zt", 50, 3000, " mm"),
)
"""Name, lowest, highest and unit of a pose's six numbers. Wide: whether a person can hold the
board so is said by the engine's limits, and a lesson may well show a pose that they refuse."""
# (part of the reader's message, what a teacher does about it)
_CURES = (
    ("unclosed array", "close the list with ]"),
    ("overwrite", "this key stands here twice; keep one of them"),
    ("twice", "this key stands here twice; keep one of them"),
    ("after a key", "write: key = value, and put text between quotation marks"),
    ("invalid value", "put text between quotation marks, write numbers with a point (12.5)"),
    ("illegal character", 'close the text with a quotation mark; longer text stands between """'),
    ("unescaped", "write \\\\ for a backslash"),
    ("escape", "write \\\\ for a backslash"),
    ("after a statement", "one key on each line; are quotation marks or commas missing?"),
    ("statement", "lines are: key = value, [[page]], [page.question], or a # remark"),
)


def read_lesson(path: str | Path) -> Lesson:
    """The lesson of a file.

    Raises `LessonError`, which names file and line, for whatever is wrong with it.
    """
    file = Path(path)
    text = _text_of(file)
    lines = lines_of(text)
    try:
        raw: dict[str, Any] = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise LessonError(file.name, *_syntax_mistake(str(error), text, lines.unclosed)) from None
    root = Table(file.name, lines, raw, (), "a lesson")
    root.expect("title", "summary", "page")
    pages = tuple(_page(table) for table in root.tables("page", least=1))
    return Lesson(file.stem, root.text("title"), root.text("summary"), pages)


def shipped_lessons() -> tuple[Lesson, ...]:
    """The lessons that come with the program, in the order of their file names."""
    return _read_folder(_shipped_folder())


def lesson_of(choice: str) -> Lesson:
    """The lesson that a person named: "" the first, a file (.toml), or a shipped one's name.

    A name goes without its number too: "gimbal-lock". Raises `VenusError` for one unknown.
    """
    if choice.lower().endswith(".toml") or "/" in choice or "\\" in choice:
        return read_lesson(choice)
    names = {lesson.name: lesson for lesson in shipped_lessons()}
    for name, lesson in names.items():
        if choice.lower() in ("", name, name.split("-", 1)[1], name.split("-", 1)[0]):
            return lesson
    short = [name.split("-", 1)[1] for name in names]
    near = get_close_matches(choice.lower(), short, n=1)
    cure = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(short)}."
    raise VenusError(f"There is no lesson {choice!r}; {cure} A file of your own ends in .toml.")


@lru_cache(maxsize=1)
def _read_folder(folder: Path) -> tuple[Lesson, ...]:
    return tuple(read_lesson(path) for path in sorted(folder.glob("*.toml")))


def _shipped_folder() -> Path:
    """Where the lessons are: in the installed package, or beside it in a source tree."""
    inside = Path(__file__).parent / "shipped"
    return inside if inside.is_dir() else Path(__file__).parents[2] / "assets" / "lessons"


def _text_of(file: Path) -> str:
    try:
        content = file.read_bytes()
    except FileNotFoundError:
        raise VenusError(f"There is no lesson file {file}; check the name.") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise VenusError(f"The lesson {file} cannot be read ({reason}).") from None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise LessonError(
            file.name,
            line,
            "this is not UTF-8 text; save the file once more with the encoding UTF-8",
        ) from None


def _syntax_mistake(message: str, text: str, unclosed: int | None) -> tuple[int, str]:
    """The line and the sentence of a text that is no TOML, from the reader's message."""
    if unclosed is not None:
        return unclosed, 'a text or list begins here and never ends; close it with """ or ]'
    at = re.search(r"\(at line (\d+), column \d+\)", message)
    rows = text.splitlines()
    line = int(at.group(1)) if at else max(1, len(rows))
    cause = re.sub(r"\s*\(at .*\)$", "", message)
    shown = rows[line - 1].strip() if line <= len(rows) else ""
    cure = next((cure for part, cure in _CURES if part in message.lower()), "")
    where = f" in {shown[:60]!r}" if shown else ""
    return line, f"{cause[0].lower()}{cause[1:]}{where}" + (f": {cure}" if cure else "")


def _page(table: Table) -> LessonPage:
    table.expect("title", "text", "pose", "viewpoint", "arrangement", "order", "show", "question")
    arrangement: Arrangement = table.choice("arrangement", ARRANGEMENTS, "place")
    if (arrangement == "order") != ("order" in table.raw):
        key = "order" if "order" in table.raw else "arrangement"
        raise table.mistake(
            key,
            'arrangement = "order" and order belong together: say which order of turns is shown '
            'beside xyz, such as order = "zyx"',
        )
    questions = table.tables("question", single=True)
    pose = table.numbers("pose", POSE_RANGES)
    return LessonPage(
        title=table.text("title"),
        text=table.text("text"),
        pose=(pose[0], pose[1], pose[2], pose[3], pose[4], pose[5]),
        viewpoint=table.choice("viewpoint", VIEWPOINTS, "outside"),
        arrangement=arrangement,
        order=table.choice("order", ORDERS, "xyz"),
        show=table.choices("show", EXTRAS),
        question=_question(questions[0]) if questions else None,
    )


def _question(table: Table) -> Question:
    table.expect("text", "answers", "right", "why")
    answers = table.texts("answers", least=2)
    right = table.whole_number("right")
    if not 1 <= right <= len(answers):
        raise table.mistake(
            "right",
            f"right says which of the answers is right, from 1 to {len(answers)}; here it is "
            f"{right}",
        )
    return Question(table.text("text"), answers, right, table.text("why"))
