"""The documentation as a site: the Markdown files as pages, the API from the docstrings.

    python scripts/docs.py [FOLDER]    # site/ unless a folder is named

A link to a file or a heading that does not exist ends it with an error. Pictures and other files
that a page links to are copied; the API's page is made by pdoc.
"""

from __future__ import annotations

import html
import re
import shutil
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pdoc
import pdoc.render
from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).resolve().parent.parent
FIRST = ("README.md", "docs/api.md", "docs/gallery.md", "docs/method.md", "docs/conventions.md")
"""What stands first in the menu; the other pages follow by name."""
MARKDOWN = MarkdownIt("commonmark").enable("table")
PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ display: flex; gap: 3em; margin: 2em auto; padding: 0 1.5em; max-width: 76em;
  font: 16px/1.55 system-ui, sans-serif; color: #222 }}
nav {{ flex: none; width: 12em }} nav a {{ display: block; margin: .35em 0 }}
main {{ min-width: 0; flex: 1 }} a {{ color: #06c; text-decoration: none }}
img {{ max-width: 100% }} table {{ border-collapse: collapse; display: block; overflow-x: auto }}
td, th {{ border: 1px solid #ccc; padding: .3em .6em; vertical-align: top }}
code, pre {{ font-family: ui-monospace, monospace; font-size: .92em; background: #f4f4f4 }}
pre {{ padding: .8em 1em; overflow-x: auto }}
@media (max-width: 50em) {{ body {{ display: block }} }}
</style>
<nav>{menu}</nav>
<main>
{text}</main>
</html>
"""


def main(folder: str = "site") -> None:
    site = Path(folder)
    sources = [ROOT / name for name in FIRST]
    sources += sorted({ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"} - {*sources})
    sources += sorted({*(ROOT / "docs").glob("*.md")} - {*sources})
    parsed = {source: MARKDOWN.parse(source.read_text()) for source in sources}
    headings = {source: headings_of(tokens) for source, tokens in parsed.items()}
    titles = {source: next(iter(headings[source].values())) for source in sources}
    menu = "".join(f'<a href="{page_of(s)}">{html.escape(t)}</a>' for s, t in titles.items())
    menu += '<a href="api/venus3d.html">API, complete</a>'

    shutil.rmtree(site, ignore_errors=True)
    site.mkdir(parents=True)
    for source, tokens in parsed.items():
        for token, key in links_in(tokens):
            token.attrs[key] = resolved(str(token.attrs[key]), source, headings, site)
        text = MARKDOWN.renderer.render(tokens, MARKDOWN.options, {})
        page = PAGE.format(title=html.escape(titles[source]), menu=menu, text=text)
        (site / page_of(source)).write_text(page)
    pdoc.render.configure(docformat="google", show_source=False)
    pdoc.pdoc("venus3d", "!venus3d.", output_directory=site / "api")
    print(f"{site / 'index.html'}")


def page_of(source: Path) -> str:
    """The page's file in the site."""
    return "index.html" if source.name == "README.md" else f"{source.stem.lower()}.html"


def headings_of(tokens: list[Token]) -> dict[str, str]:
    """anchor: text of each heading; the anchors, GitHub's, are written into the tokens."""
    found: dict[str, str] = {}
    for opening, inline in pairwise(tokens):
        if opening.type == "heading_open":
            text = re.sub(r"[`*_]", "", inline.content)
            anchor = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
            opening.attrs["id"] = anchor
            found[anchor] = text
    return found


def links_in(tokens: list[Token]) -> Iterator[tuple[Token, str]]:
    """Each link or picture with the attribute that holds its address."""
    for token in tokens:
        for child in token.children or ():
            if child.type in ("link_open", "image"):
                yield child, "href" if child.type == "link_open" else "src"


def resolved(link: str, source: Path, headings: dict[Path, dict[str, str]], site: Path) -> str:
    """The link as it is in the site; the file is copied if it is no page."""
    if re.match(r"[a-z]+:", link):
        return link
    name, _, anchor = link.partition("#")
    target = (source.parent / name).resolve() if name else source
    if not target.is_file() or (anchor and anchor not in headings.get(target, ())):
        raise SystemExit(f"{source.relative_to(ROOT)} links to {link}, which does not exist.")
    if target in headings:
        return page_of(target) + (f"#{anchor}" if anchor else "")
    copied = target.relative_to(ROOT)
    (site / copied).parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(target, site / copied)
    return copied.as_posix()


if __name__ == "__main__":
    main(*sys.argv[1:])
