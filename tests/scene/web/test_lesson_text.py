"""What a lesson says is text, in the page and in the export: no tag and no address of its own.

Lessons come from strangers. Once `<iframe srcdoc="<script>...">` in one ran in the page's origin.
"""

from __future__ import annotations

import hashlib
import re
from base64 import b64encode
from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.lesson import Lesson, LessonPage, Question
from venus3d.scene.pages.teach.export.animation import exported_pages
from venus3d.scene.pages.teach.export.html_document import PageContent, html_document
from venus3d.scene.pages.teach.lesson_html import lesson_html, question_html
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.lesson_text import lesson_text_html
from venus3d.scene.web.scene_recording import player, player_scripts
from venus3d.scene.web.theme import Theme

_POSE = (25.0, -30.0, 20.0, 40.0, -20.0, 520.0)
_NASTY = (
    '"',
    "' onmouseover='x()' a='",
    "</script><script>x()</script>",
    "</style></title></textarea><img src=x onerror=x()>",
    "<!-- <script>",
    "]]>",
    '<iframe srcdoc="<script>x()</script>"></iframe>',
    "<svg/onload=x()>",
    "{x()} ${x()} {{x}}",
    "&lt;script&gt;x()&lt;/script&gt; &#60;b>",
    "\u2028\u202e\ufeff\U0001f600 \u0000 <\u017fcript>",
)
_MARKS = (
    *("[a](", "javascript:x()", "data:text/html,x", "//x.org", "https://x.org", ")", "](", "[a]: "),
    *("<https://x.org>", "![a](https://x.org/a.png)", "`", "```", "\n", "\n\n", "    ", "# ", "- "),
    *("1. ", "> ", "|", "|-|\n", "**", "~~", "\\", " ", "a", '"', "&", "<", ">"),
)
_TAGS = {
    *("a", "blockquote", "br", "code", "div", "em", "h1", "h2", "h3", "h4", "h5", "h6", "hr", "li"),
    *("ol", "p", "pre", "s", "strong", "table", "tbody", "td", "th", "thead", "tr", "ul"),
}


class _Read(HTMLParser):
    """Tags with their attributes, and the text between them."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data

    def handle_comment(self, data: str) -> None:
        raise AssertionError(f"a comment: {data}")


@given(st.lists(st.sampled_from(_NASTY + _MARKS), max_size=25).map("".join))
def test_no_text_makes_a_tag_that_runs_or_loads(text: str) -> None:
    for tag, attributes in _Read(lesson_text_html(text)).tags:
        assert tag in _TAGS
        for name, value in attributes.items():
            assert value is not None
            if name == "href":
                # Empty: [a]() leads to the page itself.
                assert tag == "a" and re.match(r"https?://|mailto:|$", value, re.IGNORECASE)
            elif name == "style":
                assert re.fullmatch(r"text-align:(left|right|center)", value)
            else:
                assert name in ("class", "target", "rel", "start", "title")


def test_markdown_is_understood() -> None:
    html = lesson_text_html("**a** *b* `c` ~~d~~\n\n- e\n  1. f\n\n## g\n\n|h|i|\n|-|-:|\n|j|k|\n")
    for part in ("<strong>a", "<em>b", "<code>c", "<s>d", "<ul>", "<ol>", "<h2>g", "<td>j"):
        assert part in html


def test_html_is_seen_as_it_was_written() -> None:
    text = '<iframe srcdoc="<script>x()</script>"></iframe>'
    assert _Read(lesson_text_html(f"See {text}")).text.strip() == f"See {text}"


@pytest.mark.parametrize("url", ["https://x.org/a?b=1&c=2", "HTTP://x.org", "mailto:a@x.org"])
def test_a_link_opens_a_tab_of_its_own_that_knows_nothing_of_the_page(url: str) -> None:
    tags = dict(_Read(lesson_text_html(f"[a]({url})")).tags)
    assert tags["a"] == {"href": url, "target": "_blank", "rel": "noreferrer"}


@pytest.mark.parametrize(
    "url",
    [
        *(
            "javascript:x()",
            "JaVaScRiPt:x()",
            "&#106;avascript:x()",
            "\\x01javascript:x()",
            "blob:x",
        ),
        *("vbscript:x()", "data:image/png,x", "file:///etc/passwd", "//x.org", "a.html", "#a"),
    ],
)
def test_another_link_is_shown_as_text(url: str) -> None:
    read = _Read(lesson_text_html(f"[a]({url}) and <{url}>"))
    assert "a" not in dict(read.tags) and "[a](" in read.text


def test_a_picture_is_not_loaded() -> None:
    tags = [tag for tag, _ in _Read(lesson_text_html("![a](https://x.org/a.png)")).tags]
    assert "img" not in tags


@pytest.mark.parametrize("nasty", _NASTY)
def test_every_field_of_a_lesson_is_text_in_the_live_page(nasty: str) -> None:
    def told(words: str) -> _Read:
        lesson = _lesson(words)
        state = TeachState(lessons=(lesson,)).opened(0).answered(1)
        page = lesson.pages[0]
        return _Read(lesson_html(page.title, "", page.text) + question_html(state))

    assert told(nasty).tags == told("harmless").tags
    assert told(nasty).text.count(nasty) >= 3  # title, question, why


def test_a_right_answer_is_green_with_a_tick_and_a_wrong_one_red_with_a_cross(
    paper_camera: Camera, default_board: Board
) -> None:
    state = TeachState(lessons=(_lesson("a"),)).opened(0)
    right, wrong = (question_html(state.answered(number)) for number in (2, 1))
    assert "v-done" in right and "✓" in right and "v-wrong" not in right
    assert "v-wrong" in wrong and "✕" in wrong and "v-done" not in wrong
    page = _document(_lesson("a"), PoseAnalysis(paper_camera, default_board))
    assert re.search(r"class='v-right' data-verdict='1'><b>✓", page)
    assert re.search(r"class='v-wrong' data-verdict='0'><b>✕", page)
    for dark in (False, True):
        red, green, _ = Theme(dark).wrong
        assert red > 1.8 * green, "red"
        assert f"--wrong:#{red:02x}" in Theme(dark).variables


@pytest.mark.parametrize("nasty", _NASTY)
def test_every_field_of_a_lesson_is_text_in_the_export(
    nasty: str, paper_camera: Camera, default_board: Board
) -> None:
    def told(words: str) -> _Read:
        lesson = _lesson(words)
        return _Read(_document(lesson, PoseAnalysis(paper_camera, default_board)))

    assert told(nasty).tags == told("harmless").tags
    # The title twice, the summary, the page's title, question, answer and twice why.
    assert told(nasty).text.count(nasty) >= 8


def test_only_known_scripts_run_in_the_export(paper_camera: Camera, default_board: Board) -> None:
    study, viser = PoseAnalysis(paper_camera, default_board), player()
    page = _document(_lesson("a"), study, viser)
    policy = _policy(page)
    (script,) = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    loader, unpacked = player_scripts(viser)
    assert len(unpacked.encode()) > 1_000_000 and loader in viser
    for known in (script, loader, unpacked):
        assert f"'sha256-{b64encode(hashlib.sha256(known.encode()).digest()).decode()}'" in policy
    scripts = next(part for part in policy.split("; ") if part.startswith("script-src"))
    assert "'unsafe-inline'" not in scripts and "'unsafe-eval'" not in scripts
    assert "http" not in policy and "*" not in policy
    assert page.index("Content-Security-Policy") < page.index("<title>")  # binds what comes later


@pytest.mark.parametrize("packed", ["", "!!!!!", "~~~~~", "\u20ac"])
def test_a_player_of_another_make_still_plays(
    packed: str, paper_camera: Camera, default_board: Board
) -> None:
    loader = f'<script data-p="{packed}" data-ss="1" data-cs="2">const A="!#~";x()</script>'
    for viser in ("<head><script>x()</script></head>", f"<head>{loader}</head>"):
        assert player_scripts(viser) == ()
        policy = _policy(_document(_lesson("a"), PoseAnalysis(paper_camera, default_board), viser))
        assert "script-src 'unsafe-inline'" in policy and "http" not in policy


def _lesson(words: str) -> Lesson:
    question = Question(words, (words, "b"), 2, words)
    return Lesson("a", words, words, (LessonPage(words, words, _POSE, question=question),))


def _document(lesson: Lesson, study: PoseAnalysis, viser: str = "<head></head>") -> str:
    blank = np.zeros((9, 16, 3), np.uint8)
    (page,) = exported_pages(lesson, study, dark=False)
    content = PageContent(page, (blank, blank, blank, blank), "")
    return html_document(lesson, (content,), viser)


def _policy(page: str) -> str:
    attributes = (attributes for tag, attributes in _Read(page).tags if tag == "meta")
    return next(a["content"] or "" for a in attributes if "http-equiv" in a)
