"""The pages' dark and light colours, and the style sheets that use them. The .css files are beside
this module: style.css for operated pages, audience.css for the second monitor, document.css (after
style.css) and player.css for the exported lesson, report.css (after style.css) for documents on a
calibration. Panel positions are the pages' own."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from venus3d.render.palette import ground, hex_of, mixed, step_colour
from venus3d.render.shapes import Colour

_END: dict[bool, Colour] = {True: (0, 0, 0), False: (255, 255, 255)}
"""What the scene's ground fades to."""


@dataclass(frozen=True)
class Theme:
    """A page's colours, dark or light."""

    dark: bool

    @property
    def step_colours(self) -> tuple[Colour, Colour, Colour, Colour]:
        """The four steps' colours."""
        one, two, three, four = (step_colour(n, dark=self.dark) for n in (1, 2, 3, 4))
        return (one, two, three, four)

    @property
    def steps(self) -> tuple[str, ...]:
        """The steps' colours as CSS."""
        return tuple(hex_of(colour) for colour in self.step_colours)

    @property
    def info(self) -> str:
        """Colour of something that is going on or needed."""
        return hex_of(ground(self.dark).warning)

    @property
    def reached(self) -> str:
        """Colour of something correct; always with a tick and a word."""
        return hex_of(ground(self.dark).reached)

    @property
    def good(self) -> str:
        """Colour of plain text."""
        return hex_of(ground(self.dark).text)

    @property
    def quiet(self) -> str:
        """Colour of idle states."""
        return hex_of(ground(self.dark).quiet_text)

    @property
    def brand(self) -> Colour:
        """Colour of viser's own buttons and marks; neutral, since the steps have the colours."""
        return (150, 163, 184) if self.dark else (70, 82, 102)

    @property
    def wrong(self) -> Colour:
        """Colour of a wrong answer; always with a cross and a word."""
        return (255, 120, 110) if self.dark else (178, 24, 24)

    @property
    def variables(self) -> str:
        """The colours as CSS variables (style.css says what they mean)."""
        own = ground(self.dark)
        colours = {
            "text": self.good,
            "soft": self.quiet,
            "ground": hex_of(own.background),
            "tile": hex_of(mixed(own.background, own.text, 0.05)) if self.dark else "#ffffff",
            "line": hex_of(mixed(own.background, own.text, 0.17)),
            "sky": hex_of(mixed(own.background, own.text, 0.1)),
            "depth": hex_of(mixed(own.background, _END[self.dark], 0.6)),
            "done": self.reached,
            "warning": self.info,
            "wrong": hex_of(self.wrong),
        }
        return f":root{{{';'.join(f'--{name}:{value}' for name, value in colours.items())}}}"

    @property
    def sheet(self) -> str:
        """The style sheet of operated pages, once per panel."""
        return f"<style>{self.variables}{style_sheet('style')}</style>"


@cache
def style_sheet(name: str) -> str:
    """A style sheet of this folder, for example "style", without comments."""
    text = (Path(__file__).parent / f"{name}.css").read_text(encoding="utf-8")
    return " ".join(re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL).split())
