"""All that a page says stands in its module of texts, so that it can be translated there.

The rule: elsewhere no string literal of `scene` and `render` reads like a label or a sentence.
A literal reads like one if, once HTML tags, entities and style sheets are taken out of it (an
f-string counts as one literal with holes), two words of letters are left, or one with a capital
letter; units are no words. Not meant are docstrings, the texts of exceptions, annotations, names of
shapes and threads, and the names that code gives to actions.
"""

from __future__ import annotations

import ast
import importlib
import re
from collections.abc import Iterator
from pathlib import Path
from string import Formatter

import pytest

import venus3d

PACKAGE = Path(venus3d.__file__).parent
SEEN = sorted([*(PACKAGE / "scene").rglob("*.py"), *(PACKAGE / "render").rglob("*.py")])
TEXTS = [path for path in SEEN if path.stem == "texts" or path.stem.endswith("_texts")]
FILES = [path for path in SEEN if path not in TEXTS]
# Names of actions, whose buttons have texts of their own, and of a thread.
NAMES = {"other order", "theme dark", "audience picture"}
_CSS = re.compile(r"[{}]|--|[a-z-]+:\S|[a-z]-[a-z-]+\(")
_NAMED_BY = {"name", "thread_name_prefix"}


def is_text(literal: str) -> bool:
    """Whether a literal, its holes as NUL characters, reads like a label or a sentence."""
    plain = re.sub(r"<style>.*?(</style>|$)", " ", literal, flags=re.S)
    plain = re.sub(r"<[^>]*(>|$)|&\w+;", " ", plain).strip()
    if _CSS.search(plain):
        return False
    words = [word for word in re.findall(r"[^\W\d_]{2,}", plain) if word not in ("px", "mm", "cm")]
    return (len(words) > 1 and " " in plain) or bool(re.fullmatch(r"[A-Z][a-z]+\W*", plain))


def literals(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and text of every string literal that the rule is about."""
    skipped: set[int] = set()

    def skip(node: ast.AST | None) -> None:
        skipped.update(id(inner) for inner in ast.walk(node) if node is not None)

    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            skip(node.value)
        elif isinstance(node, ast.Raise):
            skip(node)
        elif isinstance(node, ast.Call):
            called = node.func
            if isinstance(called, ast.Name) and (
                called.id.endswith("Error") or called.id == "TypeVar"
            ):
                skip(node)
            for keyword in node.keywords:
                if keyword.arg in _NAMED_BY:
                    skip(keyword.value)
        elif isinstance(node, ast.AnnAssign | ast.arg) and node.annotation is not None:
            skip(node.annotation)
        elif isinstance(node, ast.Subscript) and ast.unparse(node.value) == "Literal":
            skip(node)
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.JoinedStr):
            parts = node.values
            whole = "".join(str(p.value) if isinstance(p, ast.Constant) else "\0" for p in parts)
            skipped.update(id(part) for part in parts if isinstance(part, ast.Constant))
            yield node.lineno, whole
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value


@pytest.mark.parametrize(
    "literal, said",
    [
        ("Capture this view", True),
        ("views captured", True),
        ("Target", True),
        ("<div class='v-x' title='\0'>The last view</div>", True),
        ("<div class='v-bar v-done' style='--step:\0'>\0</div>", False),
        ("<style>.v-card b{font-size:1em} some words</style>", False),
        ("/steps/1/arrow", False),
        ("v-on", False),
        (" &nbsp; ", False),
        ("\0 px", False),
    ],
)
def test_the_rule_tells_texts_from_what_is_none(literal: str, said: bool) -> None:
    assert is_text(literal) == said


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_text_stands_outside_the_texts(path: Path) -> None:
    found = [
        f"line {line}: {text!r}"
        for line, text in literals(ast.parse(path.read_text(encoding="utf-8")))
        if is_text(text) and text not in NAMES
    ]
    assert not found, f"texts of {path.name} belong into a module of texts: {found}"


def _strings(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for inner in value.values():
            yield from _strings(inner)
    elif isinstance(value, tuple | list):
        for inner in value:
            yield from _strings(inner)


def test_every_text_says_something_and_its_holes_have_names() -> None:
    """A translator sees what goes into a hole by its name: no "{}", no "{0}"."""
    assert len(TEXTS) > 5
    for path in TEXTS:
        name = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        module = importlib.import_module(f"venus3d.{name}")
        for constant, value in vars(module).items():
            if not constant.isupper():
                continue
            for text in _strings(value):
                holes = [hole for _, hole, _, _ in Formatter().parse(text) if hole is not None]
                assert all(hole.isidentifier() for hole in holes), (name, constant, text)


def test_no_text_is_capitalised_by_a_method_that_lowers_its_nouns() -> None:
    """`str.capitalize` made "das linke brett" of a German sentence."""
    for path in SEEN:
        assert not re.search(r"\.(capitalize|title)\(\)", path.read_text("utf-8")), path
