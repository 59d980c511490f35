"""Amounts as people read them."""

from __future__ import annotations

import pytest

from venus3d.render.amounts import degrees


@pytest.mark.parametrize(
    ("angle", "said"), [(25.4, "+25°"), (-30.6, "−31°"), (0.4, "0°"), (-0.4, "0°"), (-90, "−90°")]
)
def test_an_angle_has_a_sign_that_is_no_hyphen_unless_it_is_nothing(angle: float, said: str):
    assert degrees(angle) == said
