"""The steps' colours: readable on their ground, apart for every kind of colour vision."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from venus3d.render.palette import (
    STEP_STYLES,
    contrast,
    ground,
    linear,
    picture_background,
    step_colour,
    text_on,
)

# Machado, Oliveira, Fernandes 2009, severity 1, on linear sRGB.
VISION = {
    "normal": np.eye(3),
    "protan": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deutan": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritan": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
XYZ_FROM_RGB = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)


def lab(rgb_linear: np.ndarray) -> np.ndarray:
    xyz = XYZ_FROM_RGB @ np.clip(rgb_linear, 0, 1) / [0.9505, 1.0, 1.089]
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_contrast_of_known_pairs() -> None:
    assert contrast((0, 0, 0), (255, 255, 255)) == pytest.approx(21)
    # The grey that WCAG's own texts name as just passing on white.
    assert contrast((118, 118, 118), (255, 255, 255)) == pytest.approx(4.54, abs=0.01)


@pytest.mark.parametrize("dark", [True, False])
def test_everything_written_reads_on_its_ground(dark: bool) -> None:
    colours = ground(dark)
    for n in (1, 2, 3, 4):
        assert contrast(step_colour(n, dark), colours.background) >= 4.5
        assert contrast(text_on(step_colour(n, dark)), step_colour(n, dark)) >= 4.5
        picture_ground = picture_background(dark)
        assert contrast(step_colour(n, dark), picture_ground) >= 3
    for text in (colours.text, colours.quiet_text, colours.warning, colours.target):
        assert contrast(text, colours.background) >= 4.5
    for line in (colours.ghost, colours.camera):
        assert contrast(line, colours.background) >= 3


@pytest.mark.parametrize("dark", [True, False])
@pytest.mark.parametrize("vision", VISION)
def test_steps_differ_for_every_colour_vision(vision: str, dark: bool) -> None:
    seen = [lab(np.array(VISION[vision]) @ linear(s.colour(dark))) for s in STEP_STYLES]
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 30


@pytest.mark.parametrize("dark", [True, False])
def test_each_step_shows_on_the_boards_black_squares(dark: bool) -> None:
    """An arrow lies over the board more often than beside it; on light ground step 4's dark blue
    had a contrast of 1.3 there. No four tones that are text on light ground reach 3."""
    for n in (1, 2, 3, 4):
        assert contrast(step_colour(n, dark), (0, 0, 0)) > 2.2


def test_each_step_has_a_number_and_its_own_words() -> None:
    assert [s.number for s in STEP_STYLES] == [1, 2, 3, 4]
    assert len({s.title for s in STEP_STYLES}) == 4


@pytest.mark.parametrize("dark", [True, False])
def test_no_step_looks_done_or_like_a_warning(dark: bool) -> None:
    """Green means done and nothing else, yellow a warning and nothing else."""
    for taken in (ground(dark).reached, ground(dark).warning):
        for style in STEP_STYLES:
            apart = np.linalg.norm(lab(linear(style.colour(dark))) - lab(linear(taken)))
            assert apart > 40, style.title
