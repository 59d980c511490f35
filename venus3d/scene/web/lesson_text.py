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

LESSON_TEXT_SHEET = """
.v-text{overflow-wrap:anywhere}
.v-text :is(p,ul,ol,pre,table,blockquote){margin:0 0 .5em}
div.v-text :is(h1,h2,h3,h4,h5,h6){margin:.7em 0 .25em;font-size:1.08em;line-height:1.2;
font-weight:700;color:var(--text)}
.v-text :is(ul,ol){padding-left:1.5em}.v-text li{margin:0 0 .2em}
.v-text li>:is(ul,ol){margin:.2em 0 0}
.v-text a{color:inherit;text-underline-offset:.15em}
.v-text code{font-family:ui-monospace,Consolas,monospace;font-size:.9em;background:var(--tile);
border:1px solid var(--line);border-radius:4px;padding:0 .25em}
.v-text pre{white-space:pre-wrap;background:var(--tile);border:1px solid var(--line);
border-radius:6px;padding:.4em .6em}
.v-text pre code{border:0;padding:0}
.v-text blockquote{border-left:4px solid var(--line);padding-left:.8em;color:var(--soft)}
.v-text table{border-collapse:collapse}
.v-text :is(th,td){border-bottom:1px solid var(--line);padding:.15em 1.4em .15em 0;text-align:left}
.v-text hr{border:0;border-top:1px solid var(--line);margin:.7em 0}
"""
"""How that HTML looks; takes --text, --soft, --line and --tile from the page around it."""


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
