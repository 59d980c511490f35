"""A lesson's text as HTML that can neither run nor load anything, for the live page and exports.
Lessons are passed between teachers and not trusted: HTML is shown as text, a picture becomes a link
to it, and links lead only to web pages or mail addresses, in a new tab."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.token import Token

_LINKED = ("http://", "https://", "mailto:")


def lesson_text_html(text: str) -> str:
    """Markdown (CommonMark, tables and strikethrough) as HTML."""
    # A new parser each time: it is not thread-safe, and several threads draw pages.
    parser = MarkdownIt("commonmark", {"html": False})
    parser.enable(["table", "strikethrough"]).disable("image")
    parser.validateLink = _may_be_linked
    parser.add_render_rule("link_open", _link)
    return f"<div class='v-text'>{parser.render(text)}</div>"


def _may_be_linked(url: str) -> bool:
    return url.lower().startswith(_LINKED)


def _link(renderer: Any, tokens: Sequence[Token], index: int, options: Any, env: Any) -> str:
    # The opened page can neither access this one (also in "noreferrer") nor learn its address.
    tokens[index].attrs.update(target="_blank", rel="noreferrer")
    return str(renderer.renderToken(tokens, index, options, env))
