"""Lesson files, right ones and the mistakes of a teacher who knows no Python."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from venus3d.engine.errors import VenusError
from venus3d.lessons.lesson import Question
from venus3d.lessons.reading import lesson_of, read_lesson, shipped_lessons

GOOD = '''title = "A lesson"
summary = "What it is for"

[[page]]
title = "The first page"
text = """
Two lines
of text."""
pose = [10, -20.5, 30, 40, -50, 600]
viewpoint = "holder"
show = ["sigma"]

[[page]]
title = "The second page"
text = "Short"
pose = [0, 0, 0, 0, 0, 500]
arrangement = "order"
order = "zyx"

[page.question]
text = "Which?"
answers = ["this", "that"]
right = 2
why = "Because."
'''


@pytest.fixture
def written(tmp_path: Path):
    """Writes a lesson file and gives its path."""

    def write(text: str | bytes) -> Path:
        path = tmp_path / "lesson.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def test_a_lesson_is_read_whole(written) -> None:
    lesson = read_lesson(written(GOOD))
    assert (lesson.name, lesson.title, lesson.summary) == ("lesson", "A lesson", "What it is for")
    first, second = lesson.pages
    assert first.text == "Two lines\nof text."
    assert (first.viewpoint, first.arrangement, first.show) == ("holder", "place", ("sigma",))
    assert first.question is None
    np.testing.assert_allclose(first.target.t, [0.04, -0.05, 0.6])
    np.testing.assert_allclose(first.target.vector()[:3], [10, -20.5, 30])
    assert (second.arrangement, second.order) == ("order", "zyx")
    assert second.question == Question("Which?", ("this", "that"), 2, "Because.")


def test_files_of_other_editors_are_read_too(written) -> None:
    windows = b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode()
    assert read_lesson(written(windows)).pages[1].title == "The second page"


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        (
            "600]",
            "600, 7]",
            9,
            "a list of six numbers: pose = [xr, yr, zr, xt, yt, zt]; here are 7.",
        ),
        ("-50, 600]", "-50]", 9, "here are 5."),
        ("-20.5", "-20,5", 9, "here are 7."),
        ("pose = [10,", "pose = [200,", 9, "xr of the pose is 200°; it must be from -180 to 180°"),
        ("500]", "-500]", 16, "zt of the pose is -500 mm; it must be from 50"),
        ("pose = [10,", "pose = [nan,", 9, "xr of the pose is a number"),
        ("pose = [10,", 'pose = ["10",', 9, "xr of the pose is a number, not '10'."),
        ('"holder"', '"holders"', 10, "viewpoint cannot be 'holders'; did you mean 'holder'?"),
        ('"holder"', '"moon"', 10, "it is one of outside, camera, holder, above."),
        ('["sigma"]', '"sigma"', 11, "show is a list of words out of sigma, distortion"),
        ("viewpoint", "viewpiont", 10, "a page has no 'viewpiont'; did you mean 'viewpoint'?"),
        ('text = "Short"', 'text = " "', 15, "text is empty"),
        ('text = "Short"', "text = 5", 15, "text is text between quotation marks, not 5."),
        ('text = "Short"\n', "", 13, "a page needs text"),
        ('order = "zyx"\n', "", 17, "belong together"),
        ('arrangement = "order"\n', "", 17, "belong together"),
        ('"zyx"', '"xyz"', 18, "order cannot be 'xyz'"),
        ("right = 2", "right = 3", 23, "from 1 to 2; here it is 3."),
        ("right = 2", "right = 0", 23, "from 1 to 2"),
        ("right = 2", 'right = "that"', 23, "right is a whole number, not 'that'."),
        ("right = 2\n", "", 20, "a question needs right"),
        ('["this", "that"]', '["this"]', 22, "answers is a list of at least 2 texts"),
        ('title = "A lesson"\n', "", 1, "a lesson needs title"),
        ('"A lesson"', "A lesson", 1, "put text between quotation marks"),
        ('"A lesson"', '"A lesson', 1, "quotation mark"),
        ('of text."""', "of text.", 6, "never ends"),
        ("600]", "600", 9, "never ends"),
        ("40, -50", "40 -50", 9, "list"),
        ('text = "Short"', 'text = "a\\b\\c"', 15, "backslash"),
        ('text = "Short"', 'text = """\nlong\nan \\alpha\n"""', 17, "\\alpha"),
        ('text = "Short"', 'text = "a"\ntext = "b"', 16, "twice"),
        ("[10, -20.5, 30, 40, -50, 600]", "5", 9, "pose is a list of six numbers"),
        ('"holder"', "5", 10, "viewpoint cannot be 5; it is one of outside"),
        ('["sigma"]', '["sigmas"]', 11, "show cannot be 'sigmas'; did you mean 'sigma'?"),
        ("right = 2", "right = true", 23, "right is a whole number, not True"),
        ('["this", "that"]', '["this", ""]', 22, "answers is empty"),
        ("[page.question]", "[page.questoin]", 20, "did you mean 'question'?"),
        ("[[page]]", "[[pages]]", 4, "a lesson has no 'pages'; did you mean 'page'?"),
    ],
)
def test_a_mistake_is_told_with_its_line_and_its_cure(
    written, old: str, new: str, line: int, said: str
) -> None:
    assert old in GOOD
    with pytest.raises(VenusError) as caught:
        read_lesson(written(GOOD.replace(old, new)))
    assert str(caught.value).startswith(f"lesson.toml, line {line}: ")
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_lesson_without_pages_and_pages_that_are_none_are_refused(written) -> None:
    for text in ('title = "a"\nsummary = "b"\n', 'title = "a"\nsummary = "b"\npage = []\n'):
        with pytest.raises(VenusError, match=r"a lesson needs a page; begin one with \[\[page\]\]"):
            read_lesson(written(text))
    with pytest.raises(VenusError, match=r"line 3: page is a table of its own"):
        read_lesson(written('title = "a"\nsummary = "b"\npage = "c"\n'))


def test_what_is_no_text_or_no_file_is_refused(written, tmp_path: Path) -> None:
    with pytest.raises(VenusError, match=r"lesson\.toml, line 2: this is not UTF-8"):
        read_lesson(written('title = "a"\nsummary = "größer"\n'.encode("latin-1")))
    with pytest.raises(VenusError, match="There is no lesson file"):
        read_lesson(tmp_path / "other.toml")
    with pytest.raises(VenusError, match="cannot be read"):
        read_lesson(tmp_path)


def test_a_lesson_is_chosen_by_name_number_or_file(written) -> None:
    lessons = shipped_lessons()
    assert lesson_of("") == lessons[0]
    assert lesson_of("2") == lessons[1]
    assert lesson_of(lessons[1].name) == lesson_of(lessons[1].name[2:]) == lessons[1]
    assert lesson_of(str(written(GOOD))).title == "A lesson"
    with pytest.raises(VenusError, match="did you mean 'what-a-pose-is'"):
        lesson_of("what-a-pose")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = " + "[" * 90_000 + "]" * 90_000, "nested too deeply"),
        ("a = " + "{a=" * 5000 + "1" + "}" * 5000, "nested too deeply"),
        ("a" + ".a" * 50_000 + " = 1", "nested too deeply"),
        ('"a"' + ' . "a"' * 10_000 + " = 1", "nested too deeply"),
        ("".join(f"[a{'.b' * depth}]\n" for depth in range(400)), "nested too deeply"),
        ("title = " + "9" * 100_000, "too many digits"),
        ("a" * 190_000, "lesson.toml, line 1"),
        (GOOD.replace("600]", "9" * 400 + "]"), "line 9"),
        (GOOD + "# " + "x" * 200_000, "has 200"),
        ("title = '\0'", "line 1"),
    ],
    ids=lambda text: text[:12],
)
def test_a_file_of_any_depth_or_number_ends_in_one_sentence(written, text: str, said: str) -> None:
    """Some ended in a traceback, others were read for minutes."""
    with pytest.raises(VenusError, match=said) as raised:
        read_lesson(written(text))
    assert "\n" not in str(raised.value) and len(str(raised.value)) < 600
