"""The pages' look by computation: WCAG AA for every pair that the style sheet can put together.

Text needs a contrast of 4.5, large text (24 px, or 18.7 px bold) and graphics need 3. The browser's
test reads the colours that really come out; this one holds the palette and the sheet down.
"""

from __future__ import annotations

import re

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from venus3d.scene.pages.exercise import trial_panel
from venus3d.scene.render.palette import Ground, contrast, ground, mixed, step_colour, text_on
from venus3d.scene.render.shapes import Colour
from venus3d.scene.web.theme import SIZES, Theme

# Mantine's own, which show through between our panels.
CANVAS: dict[bool, Colour] = {True: (20, 20, 20), False: (255, 255, 255)}


def lab(colour: Colour) -> NDArray[np.float64]:
    """CIE L*a*b*, in which distances are about as the eye sees them; by OpenCV."""
    picture = np.array([[colour]], np.float32) / 255
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_RGB2Lab), np.float64).reshape(3)


def rgb(colour: str) -> Colour:
    """From "#rrggbb"."""
    assert re.fullmatch(r"#[0-9a-f]{6}", colour), colour
    return (int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16))


@pytest.mark.parametrize("dark", [True, False], ids=["dark", "light"])
def test_every_text_reads_on_every_ground(dark: bool) -> None:
    theme = Theme(dark)
    grounds = {"panel": theme.panel, "tile": theme.tile}
    texts = {
        "text": theme.good,
        "soft": theme.quiet,
        "attention": theme.info,
        "reached": theme.reached,
        **{f"step {n}": colour for n, colour in enumerate(theme.steps, start=1)},
    }
    for on, ground_colour in grounds.items():
        for name, colour in texts.items():
            ratio = contrast(rgb(colour), rgb(ground_colour))
            assert ratio >= 4.5, f"{name} on the {on}: {ratio:.2f}"
    # A badge: the panel's colour on the step's, the accents'.
    for name in ("attention", "reached", "soft", "step 1", "step 2", "step 3", "step 4"):
        assert contrast(rgb(theme.panel), rgb(texts[name])) >= 4.5, name
    # viser's filled buttons.
    assert contrast(text_on(theme.brand), theme.brand) >= 4.5
    assert contrast(theme.brand, rgb(theme.panel)) >= 3, "a button's frame"


@pytest.mark.parametrize("dark", [True, False], ids=["dark", "light"])
def test_lines_and_marks_are_seen(dark: bool) -> None:
    """What is drawn in the scene and in the pictures, on any ground that it can have."""
    colours: Ground = ground(dark)
    for step in (1, 2, 3, 4):
        for on in (colours.background, CANVAS[dark], mixed(colours.background, colours.text, 0.06)):
            assert contrast(step_colour(step, dark), on) >= 3
    for name in ("target", "camera", "warning", "reached", "ghost"):
        assert contrast(getattr(colours, name), CANVAS[dark]) >= 3, name


@pytest.mark.parametrize("dark", [True, False], ids=["dark", "light"])
def test_the_two_accents_are_no_step_s_colour(dark: bool) -> None:
    """Amber and green mean attention and reached, whatever step is on."""
    colours = ground(dark)
    for accent in (colours.warning, colours.reached):
        for step in (1, 2, 3, 4):
            apart = np.linalg.norm(lab(accent) - lab(step_colour(step, dark)))
            assert apart > 40, (accent, step, apart)


def test_sizes_are_few_and_come_from_the_scale() -> None:
    """A size that is written somewhere else cannot be changed for all pages at once."""
    assert re.findall(r"--size-(\w+):", SIZES) == [
        "note",
        "text",
        "lead",
        "figure",
        "say",
        "head",
        "amount",
    ]
    assert min(int(px) for px in re.findall(r":(\d+)px", SIZES.split("--u")[0])) >= 13
    for sheet in (Theme(True).sheet, trial_panel.SHEET):
        for size in re.findall(r"font-size:([^;}]+)", sheet):
            assert "var(--size-" in size or size == "inherit", size


@pytest.mark.parametrize("dark", [True, False], ids=["dark", "light"])
def test_the_sheet_names_no_colour_of_its_own(dark: bool) -> None:
    """Colours are variables, so that dark and light cannot miss one; only the dimming is none."""
    rules = Theme(dark).sheet.split("}", 2)[2]
    assert not re.findall(r"#[0-9a-f]{3,6}\b", rules)
    assert set(re.findall(r"rgba?\([^)]*\)", rules)) <= {"rgba(0,0,0,.35)"}
    used = set(re.findall(r"var\(--(\w[\w-]*)\)", rules)) - {"step"}
    defined = set(re.findall(r"--([\w-]+):", Theme(dark).sheet))
    assert used <= defined, used - defined
