"""The shipped lessons in other languages teach the same: poses, right answers, figures."""

from __future__ import annotations

import re

import pytest

from venus3d.languages import LANGUAGES, Language
from venus3d.lessons.lesson import Lesson, LessonPage
from venus3d.lessons.reading import lesson_of, shipped_lessons

OTHERS = [language for language in LANGUAGES if language != "en"]


def figures(page: LessonPage) -> set[str]:
    """The numbers in a page's texts; a decimal comma is a point."""
    texts = [page.title, page.text]
    if page.question is not None:
        texts += [page.question.text, *page.question.answers, page.question.why]
    found = re.findall(r"[−+]?\d+(?:[.,]\d+)?", " ".join(texts))
    return {number.replace(",", ".") for number in found}


@pytest.mark.parametrize("language", OTHERS)
@pytest.mark.parametrize("english", shipped_lessons(), ids=lambda lesson: lesson.name)
def test_a_translated_lesson_teaches_the_same(english: Lesson, language: Language) -> None:
    (lesson,) = (one for one in shipped_lessons(language) if one.name == english.name)
    assert lesson.language == language and lesson.title != english.title
    assert lesson_of(english.name, language) == lesson
    for page, theirs in zip(lesson.pages, english.pages, strict=True):
        for field in ("pose", "viewpoint", "arrangement", "order", "show"):
            assert getattr(page, field) == getattr(theirs, field), (page.title, field)
        assert figures(page) == figures(theirs), page.title
        assert (page.question is None) == (theirs.question is None)
        if page.question is not None and theirs.question is not None:
            assert page.question.right == theirs.question.right
            assert len(page.question.answers) == len(theirs.question.answers)
