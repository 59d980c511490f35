"""A lesson's text as HTML that can neither run nor load anything, for the live page and exports.

Lessons go from teacher to teacher, so what one says is not trusted: HTML in it is shown as text, a
picture is a link to it, and a link leads to a web page or an address for mail, in a tab of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.token import Token

_LINKED = ("http://", "https://", "mailto:")


def lesson_text_html(text: str) -> str:
    """Markdown (CommonMark, tables and strikethrough) as HTML."""
    # Made anew each time: pages are drawn by several threads, and a parser is for one.
    parser = MarkdownIt("commonmark", {"html": False})
    parser.enable(["table", "strikethrough"]).disable("image")
    parser.validateLink = _may_be_linked
    parser.add_render_rule("link_open", _link)
    return f"<div class='v-text'>{parser.render(text)}</div>"


def _may_be_linked(url: str) -> bool:
    return url.lower().startswith(_LINKED)


def _link(renderer: Any, tokens: Sequence[Token], index: int, options: Any, env: Any) -> str:
    # The page that opens can neither reach back into this one (that is in "noreferrer" too) nor
    # learn its address.
    tokens[index].attrs.update(target="_blank", rel="noreferrer")
    return str(renderer.renderToken(tokens, index, options, env))
