"""A document of pages with a 3D scene each: one HTML file that is opened without a network.

It contains viser's player once, and a recording per page, and loads nothing. Without JavaScript the
first page's words and pictures still show. The document's policy allows only the player's and our
scripts and no external resources.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from venus3d.engine.geometry.decomposition import Step
from venus3d.languages import current_language
from venus3d.render.palette import hex_of, step_style, text_on
from venus3d.render.projections import Picture
from venus3d.scene.web import offline_texts as texts
from venus3d.scene.web.projections_panel import encoded
from venus3d.scene.web.scene_recording import ASPECT, player_scripts
from venus3d.scene.web.theme import Theme, style_sheet

_PLAYER_BAR_PX = 32
"""Minimum height of the player's bar below the scene."""


@dataclass(frozen=True)
class OfflinePage:
    """One page of the document."""

    html: str
    """What stands beside the scene, safe to show."""
    recording: str
    """The scene, base64 (`scene_recording`)."""


def offline_document(
    title: str, summary: str, pages: Sequence[OfflinePage], player: str, *, dark: bool = False
) -> str:
    """The whole file; `title` and `summary` are plain text, `player` is viser's."""
    articles = "".join(_article(page, n, len(pages)) for n, page in enumerate(pages))
    recordings = [page.recording for page in pages]
    places = f":root{{--aspect:{ASPECT};--player-bar:{_PLAYER_BAR_PX}px}}"
    given = _GIVEN.replace("DARK", json.dumps(dark))
    script = (Path(__file__).parent / "document.js").read_text(encoding="utf-8")
    script = script.replace("GIVEN", json.dumps(given))
    script = script.replace("STYLE", json.dumps(style_sheet("player")))
    players = player_scripts(player)
    policy = _policy((script, given, *players) if players else None)
    look = f"{Theme(dark).variables}{style_sheet('style')}{style_sheet('document')}{places}"
    return (
        f"<!doctype html><html lang='{current_language()}'><head><meta charset='utf-8'>"
        f"<meta http-equiv='Content-Security-Policy' content=\"{policy}\">"
        "<meta name='viewport' content='width=device-width,initial-scale=1'>"
        f"<title>{escape(title)}</title><style>{look}</style></head><body>"
        f"<header><h1>{escape(title)}</h1><p>{escape(summary)}</p></header>"
        f"<main><div>{articles}</div><section class='scene'>"
        f"<h3>{texts.SCENE_TITLE}</h3><iframe id='scene' title='{texts.SCENE_TITLE}'></iframe>"
        f"<p class='hint'>{texts.SCENE_HINT}</p><noscript>{texts.NO_SCRIPT}</noscript></section>"
        f"</main><footer>{texts.MADE_WITH}</footer>"
        f"<script type='application/json' id='player'>{_inside(player)}</script>"
        f"<script type='application/json' id='recordings'>{_inside(recordings)}</script>"
        f"<script>{script}</script></body></html>"
    )


def step_figure(
    step: Step, picture: Picture, alt: str, words: str, held: str, *, dark: bool
) -> str:
    """A step's picture under its words; `held`: the same for the board's holder, or nothing."""
    style = step_style(step.number)
    colour = style.colour(dark)
    look = f"--step:{hex_of(colour)};--on:{hex_of(text_on(colour))}"
    return (
        f"<figure style='{look}'><figcaption><b>{step.number}</b><span>"
        f"<strong>{style.title}</strong><br>{escape(words)}"
        f"<br><small>{escape(held)}</small></span></figcaption>"
        f"<img alt=\"{escape(alt, quote=True)}\" src='{encoded(picture)}'></figure>"
    )


def _article(page: OfflinePage, number: int, count: int) -> str:
    where = texts.PAGE_OF.format(page=number + 1, pages=count)
    turn = (
        f"<nav><button data-go='-1'>{texts.BACK}</button><span>{where}</span>"
        f"<button data-go='1'>{texts.ON}</button></nav>"
        if count > 1
        else ""
    )
    return (
        f"<article data-page='{number}'{'' if number == 0 else ' hidden'}>{turn}{page.html}"
        "</article>"
    )


def _policy(scripts: Sequence[str] | None) -> str:
    """The content security policy: allows these scripts and loads nothing; the scene's frame
    inherits it.

    Args:
        scripts: None if not all are known; then all inline scripts are allowed.
    """
    allowed = "'unsafe-inline'"
    if scripts is not None:
        digests = (hashlib.sha256(script.encode()).digest() for script in scripts)
        allowed = " ".join(f"'sha256-{base64.b64encode(each).decode()}'" for each in digests)
    return (
        f"default-src 'none'; script-src {allowed} 'wasm-unsafe-eval'; style-src 'unsafe-inline'; "
        "img-src data: blob:; connect-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def _inside(value: object) -> str:
    """JSON that cannot close its script element."""
    return json.dumps(value).replace("</", "<\\/").replace("<!--", "<\\u0021--")


# The player reads its recording from a global at its start, so each page gets a new frame.
_GIVEN = (
    "window.__VISER_EMBED_DATA__=parent.recording;window.__VISER_EMBED_CONFIG__={darkMode:DARK};"
)
