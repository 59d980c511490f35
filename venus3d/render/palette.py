"""Colours on dark and on light ground: one per step, safe for colour-blind people.

The steps' hues are Okabe and Ito's reddish purple, vermillion, sky blue and blue, with tones that
keep any two apart under normal sight and all three kinds of colour blindness. Green and yellow are
left for "done" and for warnings. An axis has the colour of the step that turns about it. A colour
never stands alone: each step has a number and a word too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.pose import Array
from venus3d.render import texts
from venus3d.render.shapes import Colour


@dataclass(frozen=True)
class StepStyle:
    """Name and colour of one step."""

    number: int
    on_dark: Colour
    on_light: Colour

    @property
    def title(self) -> str:
        """What to do, in a few words: "Tilt about X"."""
        return texts.STEP_TITLES[self.number - 1]

    @property
    def short_title(self) -> str:
        """In one: "Tilt"."""
        return texts.STEP_SHORT_TITLES[self.number - 1]

    def colour(self, dark: bool) -> Colour:
        """The step's colour on dark or light ground."""
        return self.on_dark if dark else self.on_light


STEP_STYLES: tuple[StepStyle, StepStyle, StepStyle, StepStyle] = (
    StepStyle(1, (210, 110, 150), (173, 30, 208)),
    StepStyle(2, (244, 93, 21), (191, 76, 0)),
    StepStyle(3, (81, 223, 255), (0, 122, 140)),
    StepStyle(4, (125, 135, 248), (48, 0, 250)),
)
"""Steps 1 ... 4."""


@dataclass(frozen=True)
class Ground:
    """The neutral colours of a dark or a light picture."""

    background: Colour
    text: Colour
    quiet_text: Colour
    ghost: Colour
    """Faint outlines: where the board was."""
    target: Colour
    """The goal's outline; stronger than anything but the active step."""
    camera: Colour
    """The frustum's lines."""
    warning: Colour
    """First accent, amber: something is going on or needs attention."""
    reached: Colour
    """Second accent, green: correct. Always with a tick and a word."""


DARK = Ground(
    background=(24, 27, 33),
    text=(240, 242, 245),
    quiet_text=(165, 172, 182),
    ghost=(150, 157, 168),
    target=(255, 255, 255),
    camera=(140, 148, 160),
    warning=(255, 215, 70),
    reached=(150, 232, 60),
)
LIGHT = Ground(
    background=(246, 247, 249),
    text=(22, 25, 30),
    quiet_text=(84, 92, 103),
    ghost=(112, 120, 132),
    target=(20, 22, 26),
    camera=(96, 104, 116),
    warning=(115, 92, 0),
    reached=(40, 115, 0),
)


def ground(dark: bool) -> Ground:
    """The neutral colours on this ground."""
    return DARK if dark else LIGHT


def picture_background(dark: bool) -> Colour:
    """Background of offscreen pictures: a shade off the page's background."""
    colours = ground(dark)
    return mixed(colours.background, colours.text, 0.06)


def step_style(number: int) -> StepStyle:
    """Style of a step, 1 ... 4."""
    return STEP_STYLES[number - 1]


def step_colour(number: int, dark: bool = True) -> Colour:
    """Colour of a step, 1 ... 4, on dark or light ground."""
    return step_style(number).colour(dark)


def mixed(colour: Colour, other: Colour, share: float) -> Colour:
    """`colour` blended with a `share` (0 ... 1) of the other."""
    r, g, b = (round(a * (1 - share) + o * share) for a, o in zip(colour, other, strict=True))
    return (r, g, b)


def hex_of(colour: Colour) -> str:
    """The colour as an HTML hex string."""
    return "#{:02x}{:02x}{:02x}".format(*colour)


def linear(colour: ArrayLike) -> Array:
    """Linear light 0 ... 1 of an sRGB colour 0 ... 255 (IEC 61966-2-1)."""
    c = np.asarray(colour, dtype=np.float64) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def luminance(colour: Colour) -> float:
    """Relative luminance of WCAG 2: 0 black, 1 white."""
    return float(linear(colour) @ [0.2126, 0.7152, 0.0722])


def contrast(a: Colour, b: Colour) -> float:
    """Contrast ratio of WCAG 2: 1 ... 21. Large text and graphics need 3, text needs 4.5."""
    low, high = sorted((luminance(a), luminance(b)))
    return (high + 0.05) / (low + 0.05)


def text_on(colour: Colour) -> Colour:
    """Near black or white, whichever contrasts more with `colour`."""
    dark, light = (18, 20, 24), (255, 255, 255)
    return dark if contrast(colour, dark) >= contrast(colour, light) else light
