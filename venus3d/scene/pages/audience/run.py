"""Announces the address of the second monitor."""

from __future__ import annotations

from venus3d.scene.pages.audience import terminal_texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.web.page import outside_lines


def announcement(audience: Audience) -> str:
    """Its address, and who can see it."""
    here = terminal_texts.ANNOUNCED.format(url=audience.url)
    return "\n".join(filter(None, (here, *outside_lines(audience.server))))
