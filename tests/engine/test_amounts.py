"""Amounts as people read them: one rounding rule, held on every page."""

from __future__ import annotations

import re
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path

import numpy as np
import pytest

import venus3d
from venus3d.engine.amounts import degrees, figure, signed, signed_tenth, size_deg, size_mm, whole


@pytest.mark.parametrize(
    ("angle", "said"), [(25.4, "+25°"), (-30.6, "−31°"), (0.4, "0°"), (-0.4, "0°"), (-90, "−90°")]
)
def test_an_angle_has_a_sign_that_is_no_hyphen_unless_it_is_nothing(angle: float, said: str):
    assert degrees(angle) == said


def test_whole_numbers_are_the_nearest_and_halves_go_away_from_zero() -> None:
    """As school and Decimal's ROUND_HALF_UP do; Python's round gives 612 for 612.5 and 611.5."""
    rng = np.random.default_rng(2)
    for value in (*np.arange(-800, 800) / 2, *rng.uniform(-900, 900, 500).round(3)):
        exact = Decimal(f"{value:.6f}").to_integral_value(ROUND_HALF_UP)
        assert whole(float(value)) == int(exact), value


def test_the_last_bits_of_a_float_make_no_other_amount() -> None:
    """611 beside 612 mm: one length computed in metres and in millimetres."""
    for half in np.arange(1, 2000, 2) / 2:
        metres = half / 1000
        ways = (1000 * metres, 1000 * (metres / 3 * 3), (metres + 0.1 - 0.1) * 1000, half)
        assert len({size_mm(way) for way in ways}) == 1
        assert len({signed(-way) for way in ways}) == 1


def test_nothing_has_no_sign_and_no_size_is_negative() -> None:
    assert {signed(v) for v in (0.0, -0.0, -0.49, 0.49)} == {"0"}
    assert [signed_tenth(v) for v in (-0.04, -1.25, 3)] == ["0.0", "−1.2", "+3.0"]
    assert (size_mm(-3.2), size_deg(-12.5), size_mm(-0.2)) == ("3 mm", "13°", "0 mm")
    assert (figure(0.0), figure(float("nan")), figure(0.0344), figure(9.96)) == (
        *("0", "–"),
        *("0.034", "10"),
    )


def test_no_page_rounds_millimetres_or_degrees_in_its_own_way() -> None:
    """Python's own formatting rounds halves to even, and has hyphens and -0."""
    own = re.compile(r":[+,]*\.0f\}( mm|°| cm)|:\+[\d.]*[fgd]\}( mm|°| cm)")
    folder = Path(venus3d.__file__).parent
    found = [
        f"{path.relative_to(folder)}:{number}"
        for part in ("scene", "render", "engine/guidance", "engine/planning")
        for path in sorted((folder / part).rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if own.search(line)
    ]
    assert found == []
