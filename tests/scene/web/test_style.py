"""The pages' look by computation, in every style sheet that ships.

WCAG AA holds for every pair that the style sheets can put together: text needs a contrast of 4.5,
large text (24 px, or 18.7 px bold) and graphics need 3. The browser's test reads the colours that
really come out; this one holds the palette and the sheets down.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

import venus3d
from venus3d.render.palette import Ground, contrast, ground, mixed, step_colour, text_on
from venus3d.render.shapes import Colour
from venus3d.scene.web.theme import Theme, style_sheet

PACKAGE = Path(venus3d.__file__).parent
# Each page's style sheets, as they stand one after the other.
PAGES = {
    "worked with": ("style",),
    "audience": ("audience",),
    "exported lesson": ("style", "document"),
    "its frame": ("player",),
    "report": ("style", "report"),
}
# What a page sets where it uses a style sheet, besides the theme's colours.
SET_BY_PAGES = {
    "worked with": {"step"},
    "audience": {"step", "longest", "wide-screen", "tall-screen", "aspect"},
    "exported lesson": {"step", "on", "aspect", "player-bar"},
    "its frame": set[str](),
    "report": {"step"},
}
# Mantine's own, which show through between our panels.
CANVAS: dict[bool, Colour] = {True: (20, 20, 20), False: (255, 255, 255)}


def sheet_of(page: str) -> str:
    return "".join(style_sheet(name) for name in PAGES[page])


def rules(sheet: str) -> Iterator[tuple[str, str]]:
    """Selectors and declarations of each rule, of those inside @media and @container as well."""
    yield from re.findall(r"([^{}]+)\{([^{}]*)\}", sheet)


def classes_of(sheet: str) -> set[str]:
    """The classes in the selectors, but viser's own."""
    selectors = "".join(selector for selector, _ in rules(sheet))
    return set(re.findall(r"\.([a-z][\w-]*)", re.sub(r"\[[^]]*\]|\.mantine-[\w-]+", "", selectors)))


def classes_in_pages() -> tuple[set[str], set[str]]:
    """The classes in the HTML that the pages make, and the beginnings of those that are computed.

    A class stands in a `class` attribute, or, where it is put in only sometimes, is a word "v-…".
    """
    texts: list[str] = []
    for path in (*(PACKAGE / "scene").rglob("*.py"), *(PACKAGE / "report").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                texts.append(node.value)
            elif isinstance(node, ast.JoinedStr):
                parts = (p.value if isinstance(p, ast.Constant) else "\0" for p in node.values)
                texts.append("".join(map(str, parts)))
    words: set[str] = set()
    for text in texts:
        for attribute in re.findall(r"class='([^']*)", text):
            words.update(attribute.split())
        words.update(re.findall(r"(?<![\w-])v-[a-z][\w-]*", text))
    stems = {word.rstrip("\0") for word in words} - {""}
    computed = {stem for stem in stems if stem.endswith("-")}
    return stems - computed, computed


def lab(colour: Colour) -> NDArray[np.float64]:
    """CIE L*a*b*, in which distances are about as the eye sees them; by OpenCV."""
    picture = np.array([[colour]], np.float32) / 255
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_RGB2Lab), np.float64).reshape(3)


def rgb(colour: str) -> Colour:
    """From "#rrggbb"."""
    assert re.fullmatch(r"#[0-9a-f]{6}", colour), colour
    return (int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16))


def variables(dark: bool, page: str = "worked with") -> dict[str, str]:
    """Every variable of a page, the last definition of each."""
    return dict(re.findall(r"--([\w-]+):\s*([^;}]+)", Theme(dark).variables + sheet_of(page)))


def colours_of(dark: bool, page: str) -> dict[str, Colour]:
    """The colours that a page has by name; mixtures computed as CSS does."""
    found: dict[str, Colour] = {}
    for name, value in variables(dark, page).items():
        mixture = re.fullmatch(
            r"color-mix\(in srgb, var\(--([\w-]+)\), var\(--([\w-]+)\) (\d+)%\)", value
        )
        if mixture:
            one, other, share = mixture.groups()
            found[name] = mixed(found[one], found[other], int(share) / 100)
        elif value.startswith("#") and len(value) == 7:
            found[name] = rgb(value)
    return found


def test_these_are_all_the_style_sheets_that_ship() -> None:
    shipped = {path.stem for path in PACKAGE.rglob("*.css")}
    assert shipped == {name for names in PAGES.values() for name in names}
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        rule = re.search(r"[.\w\])-]\{+[a-z-]+:[^{}'\"]*;[a-z-]+:", text)
        assert rule is None, f"{path} has a rule of its own: {rule and rule.group()}"


@pytest.mark.parametrize("page", ["worked with", "audience", "exported lesson"])
@pytest.mark.parametrize("dark", [True, False], ids=["dark", "light"])
def test_every_text_reads_on_every_ground(dark: bool, page: str) -> None:
    colours = colours_of(dark, page)
    steps = {f"step {n}": step_colour(n, dark) for n in (1, 2, 3, 4)}
    texts = {name: colours[name] for name in ("text", "soft", "warning", "done")} | steps
    for on in ("ground", "tile"):
        for name, colour in texts.items():
            ratio = contrast(colour, colours[on])
            # The exported lesson has frames in the steps' colours, but no words.
            least = 3 if page == "exported lesson" and name in steps else 4.5
            assert ratio >= least, f"{name} on the {on}: {ratio:.2f}"
    # A badge: the panel's colour on the step's, the accents'.
    for name in ("warning", "done", "soft", *steps):
        assert contrast(colours["ground"], texts[name]) >= 4.5, name
    for step in steps.values():
        assert contrast(text_on(step), step) >= 4.5, "a number in the exported lesson"


@pytest.mark.parametrize("dark", [True, False], ids=["dark", "light"])
def test_viser_s_buttons_read(dark: bool) -> None:
    theme = Theme(dark)
    assert contrast(text_on(theme.brand), theme.brand) >= 4.5
    assert contrast(theme.brand, colours_of(dark, "worked with")["ground"]) >= 3, "a frame"


def test_labels_in_pictures_read_on_any_picture() -> None:
    """They have a ground of their own, through which a white picture shines most."""
    named = variables(True)
    red, green, blue, share = map(float, re.findall(r"[\d.]+", named["label-ground"]))
    shone = mixed((255, 255, 255), (int(red), int(green), int(blue)), share)
    assert named["label-text"] == "#fff" and contrast((255, 255, 255), shone) >= 4.5


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


@pytest.mark.parametrize("page", PAGES)
def test_sizes_of_letters_come_from_the_scale(page: str) -> None:
    """A size that is written somewhere else cannot be changed for all pages at once."""
    for selector, declarations in rules(sheet_of(page)):
        assert not re.search(r"(?<![\w-])font:(?! inherit)", declarations), selector
        for size in re.findall(r"font-size:([^;}]+)", declarations):
            assert re.fullmatch(r" (var\(--size-[\w-]+\)|inherit)", size), (selector, size)


def test_the_scale_begins_at_13_pixels_and_has_no_two_of_a_size() -> None:
    named = variables(True)
    pixels = [int(v[:-2]) for n, v in named.items() if n.startswith("size-") and v.endswith("px")]
    assert pixels == sorted(set(pixels)) and pixels[0] == 13
    smallest = re.findall(r"--size-[\w-]+: clamp\((\d+)px", sheet_of("worked with"))
    assert min(map(int, smallest)) >= 13


@pytest.mark.parametrize("page", PAGES)
def test_colours_are_variables(page: str) -> None:
    """So that dark and light cannot miss one."""
    for selector, declarations in rules(sheet_of(page)):
        for declaration in declarations.split(";"):
            name, _, value = declaration.partition(":")
            if not name.strip().startswith("--"):
                found = re.search(r"#[0-9a-f]{3,6}\b|\b(rgb|hsl)a?\(|\b(white|black)\b", value)
                assert not found, (selector, declaration)


@pytest.mark.parametrize("page", PAGES)
def test_every_variable_is_defined_and_used(page: str) -> None:
    sheet = Theme(True).variables + sheet_of(page)
    used = set(re.findall(r"var\(--([\w-]+)\)", sheet))
    defined = set(re.findall(r"--([\w-]+):", sheet))
    assert used <= defined | SET_BY_PAGES[page], used - defined
    own = set(re.findall(r"--([\w-]+):", sheet_of(page)))
    for path in (PACKAGE / "scene").rglob("*.py"):  # the dial is drawn in Python
        used.update(re.findall(r"var\(--([\w-]+)\)", path.read_text(encoding="utf-8")))
    viser_s = {name for name in own if name.startswith(("mantine", "button"))}
    assert own - viser_s <= used, own - used


def test_every_class_is_styled_and_every_style_has_a_class() -> None:
    styled = set[str]().union(*(classes_of(sheet_of(page)) for page in PAGES))
    named, computed = classes_in_pages()
    assert named <= styled, f"without a style: {sorted(named - styled)}"
    idle = {c for c in styled - named if not any(c.startswith(start) for start in computed)}
    assert not idle, f"not in any page: {sorted(idle)}"
    assert computed == {"v-is-"}, "classes that are computed cannot be checked"
