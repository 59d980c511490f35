"""Every text that a page can say is in every language's table, under its file, with the same holes.

Texts are the constants of the modules of texts, and the literals given to `Sentence` anywhere. What
is missing is printed as the lines to add, with the section of the table that they belong into.
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
from venus3d.engine.sentences import Sentence
from venus3d.languages import (
    LANGUAGES,
    Language,
    PageLanguage,
    catalogue_of,
    language_from,
    number,
)
from venus3d.scene.pages.exercise import texts as say

PACKAGE = Path(venus3d.__file__).parent
OTHERS = [language for language in LANGUAGES if language != "en"]


def texts_of(value: object) -> Iterator[str]:
    """All texts in a constant; those without a letter outside their holes are the same in every
    language."""
    if isinstance(value, str):
        if re.search(r"[^\W\d_]", "".join(said for said, *_ in Formatter().parse(value))):
            yield str(value)
    elif isinstance(value, dict):
        for inner in value.values():
            yield from texts_of(inner)
    elif isinstance(value, tuple | list):
        for inner in value:
            yield from texts_of(inner)


def is_texts(path: Path) -> bool:
    return path.stem == "texts" or (path.stem.endswith("_texts") and path.stem != "terminal_texts")


def constants(path: Path) -> Iterator[str]:
    """The texts of a module of texts."""
    name = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
    module = importlib.import_module(f"venus3d.{name}")
    for constant, value in vars(module).items():
        if constant.isupper():
            yield from texts_of(value)


def sentences(path: Path) -> Iterator[str]:
    """The templates of a file's sentences. Anything but a literal cannot be translated."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id == "Sentence"
        ):
            given = node.args[0]
            assert isinstance(given, ast.Constant) and isinstance(given.value, str), (
                f"{path.name}, line {node.lineno}: Sentence(...) takes a literal; put what varies "
                "into named holes and use .format"
            )
            yield from texts_of(given.value)


def files() -> dict[str, list[str]]:
    """The texts of each file that has any."""
    found: dict[str, list[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        texts = dict.fromkeys((*(constants(path) if is_texts(path) else ()), *sentences(path)))
        if texts:
            found[path.relative_to(PACKAGE).as_posix()] = list(texts)
    return found


def quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def holes(text: str) -> set[str | None]:
    return {hole for _, hole, _, _ in Formatter().parse(text) if hole is not None}


@pytest.mark.parametrize("language", OTHERS)
def test_every_text_has_an_entry_under_its_file(language: Language) -> None:
    table, missing = catalogue_of(language), ""
    for file, texts in files().items():
        lines = [f'{quoted(t)} = "…"' for t in texts if t not in table.get(file, {})]
        if lines:
            missing += f'\n["{file}"]\n' + "\n".join(lines) + "\n"
    assert not missing, (
        f"add to venus3d/languages/{language}.toml, in these sections, with a translation each:\n"
        f"{missing}"
    )


@pytest.mark.parametrize("language", OTHERS)
def test_no_entry_is_left_from_a_text_that_has_changed(language: Language) -> None:
    said = files()
    unused = [
        f"[{file}] {english}"
        for file, section in catalogue_of(language).items()
        for english in section
        if english not in said.get(file, [])
    ]
    assert not unused, f"take out of venus3d/languages/{language}.toml, or mend: {unused}"


@pytest.mark.parametrize("language", OTHERS)
def test_a_translation_has_the_holes_of_its_text(language: Language) -> None:
    for file, section in catalogue_of(language).items():
        for english, words in section.items():
            assert words.strip(), (file, english)
            assert holes(words) == holes(english), (file, english, words)


@pytest.mark.parametrize("language", OTHERS)
def test_one_sentence_of_the_engine_has_one_translation(language: Language) -> None:
    """A sentence does not know its file, so equal templates must be translated alike."""
    found: dict[str, str] = {}
    for file, section in catalogue_of(language).items():
        if not file.endswith("texts.py"):
            for english, words in section.items():
                assert found.setdefault(english, words) == words, (file, english)


def test_texts_are_read_when_a_page_is_drawn_not_when_a_module_is_loaded() -> None:
    """`from texts import X`, a constant made of texts, or a default argument would stay English."""
    found: list[str] = []
    for path in sorted(PACKAGE.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names: set[str] = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                if is_texts(Path(node.module.rpartition(".")[2] + ".py")):
                    found += [
                        f"{path.name}: from {node.module} import {alias.name}"
                        for alias in node.names
                        if alias.name.isupper()
                    ]
                names |= {a.asname or a.name for a in node.names if is_texts(Path(a.name + ".py"))}
        found += [f"{path.name}: line {line}" for line in _loaded(tree, names)]
    assert not found, found


def _loaded(node: ast.AST, names: set[str]) -> Iterator[int]:
    """Lines outside functions, or in their defaults, that read a text."""
    reads = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
    if reads and node.value.id in names and node.attr.isupper():
        yield node.lineno
    if isinstance(node, ast.FunctionDef | ast.Lambda):
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                yield from _loaded(default, names)
        return
    for child in ast.iter_child_nodes(node):
        yield from _loaded(child, names)


def test_every_module_of_texts_speaks() -> None:
    for path in PACKAGE.rglob("*.py"):
        if is_texts(path):
            assert path.read_text(encoding="utf-8").endswith("\nspeak(__name__)\n"), path


def test_a_sentence_keeps_how_it_was_made() -> None:
    edge = Sentence("the top edge")
    sentence = Sentence("{what} is {mm:.0f} mm away").format(what=edge, mm=3.4)
    assert sentence == "the top edge is 3 mm away"
    assert sentence.template == "{what} is {mm:.0f} mm away"
    assert sentence.arguments["what"].template == "the top edge"


def test_diagnoses_are_made_of_sentences() -> None:
    """A literal or an f-string given to one could not be translated."""
    found: list[str] = []
    for path in sorted((PACKAGE / "engine").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "Diagnosis":
                plain = [a for a in node.args[1:3] if isinstance(a, ast.Constant | ast.JoinedStr)]
                found += [f"{path.name}, line {a.lineno}: wrap it in Sentence(...)" for a in plain]
    assert not found, found


@pytest.mark.parametrize(
    "accepted, language",
    [
        ("de", "de"),
        ("de-AT,de;q=0.9,en;q=0.8", "de"),
        ("en-GB,en;q=0.9,de;q=0.8", "en"),
        ("fr-FR,fr;q=0.9,de;q=0.5,en;q=0.3", "de"),
        ("en;q=0.1, DE;q=0.2", "de"),
        ("de;q=0", "en"),
        ("fr, *;q=0.1", "en"),
        ("", "en"),
        (";;q=x,,-", "en"),
    ],
)
def test_the_browsers_language(accepted: str, language: str) -> None:
    assert language_from(accepted) == language


def test_numbers_have_a_decimal_comma_in_german_only_where_they_are_numbers() -> None:
    assert number("0.42") == "0.42"
    with PageLanguage("de").spoken():
        assert [number(text) for text in ("0.42", "−1.5", "1.41 ± 0.03", "12")] == [
            "0,42",
            "−1,5",
            "1,41 ± 0,03",
            "12",
        ]
        assert number("OpenCV 4.6") == "OpenCV 4.6"
        assert say.REACHED_HEADLINE.format(seconds=3.25) == "Erreicht in 3,2 s"
    assert say.REACHED_HEADLINE.format(seconds=3.25) == "Reached in 3.2 s"


@pytest.mark.parametrize("path", [p for p in PACKAGE.rglob("*.py") if is_texts(p)], ids=str)
def test_no_text_takes_the_name_of_another(path: Path) -> None:
    """The end without a view had a sentence for a title: "Ended" was written over further below."""
    given = [
        name.id
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        for name in ast.walk(node)
        if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)
    ]
    assert not {name for name in given if given.count(name) > 1}
