"""Lines found statement by statement, against what a person counts."""

from __future__ import annotations

import msgspec
import pytest

from venus3d.lessons.line_numbers import lines_of

TEXT = '''# a remark
title = "A # in text"
summary = "one"

[[page]]
title = "first"
text = """
key = "this is text, not a key"
[[page]]
"""
pose = [
  0, 0, 0,  # a remark with ] in it
  0, 0, 500,
]
[page.question]
right = 1
answers = ["a = b", 'c']

[[ page ]]
"title" = 'second "quoted"'
question = { text = "inline", right = 1 }
[page.question2]
x = 1
'''


def test_keys_are_found_behind_strings_lists_and_remarks() -> None:
    lines = lines_of(TEXT)
    assert lines.broken is None
    assert lines.line(("title",)) == 2
    assert lines.line(("page", 0)) == 5
    assert lines.line(("page", 0, "text")) == 7
    assert lines.line(("page", 0, "pose")) == 11
    assert lines.line(("page", 0, "question", "right")) == 16
    assert lines.line(("page", 0, "question", "answers")) == 17
    assert lines.line(("page", 1, "title")) == 20
    assert lines.line(("page", 1, "question2", "x")) == 23


def test_a_key_without_a_line_of_its_own_has_that_of_what_is_around_it() -> None:
    lines = lines_of(TEXT)
    assert lines.line(("page", 1, "question", "right")) == 21
    assert lines.line(("page", 0, "viewpoint")) == 5
    assert lines.line(("nothing",)) == 1


def test_what_never_ends_or_is_no_toml_is_found_where_it_begins() -> None:
    assert lines_of('a = 1\ntext = """\nmore\nb = 2\n').broken == 2
    assert lines_of("a = 1\n\npose = [0, 0\nb = 2\n").broken == 3
    assert lines_of("a = 1\nb = two\nc = 3\n").broken == 2
    assert lines_of('a = """one\ntwo\\""" not yet\n"""\nb = 2\n').broken is None


def test_quotes_and_remarks_in_texts_of_several_lines_are_text() -> None:
    text = 'a = \'\'\'\nit\'s """ here # [\n\'\'\'\nb = """# [one\\\\"""\nc = [ # ]\n1]\nd = 4\n'
    assert list(lines_of(text).of.values()) == [1, 4, 5, 7]


def test_a_list_without_an_end_is_parsed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """It was parsed anew at each line: minutes for a file of a hundred kilobytes."""
    parsed: list[str] = []
    decode = msgspec.toml.decode
    monkeypatch.setattr(msgspec.toml, "decode", lambda text: [parsed.append(text), decode(text)][1])
    assert lines_of("title = 1\npose = [\n" + "[1],\n" * 500).broken == 2
    assert parsed == ["title = 1\n"]
