"""What a bent board costs."""

from __future__ import annotations

import pytest

from venus3d.study.flatness import BOWS_MM, flatness, flatness_text


@pytest.mark.slow
def test_a_bow_spoils_a_flat_model_in_proportion_and_is_found() -> None:
    rows = flatness(2, seed=1, views=10)
    assert [row["bow_mm"] for row in rows] == [bow for bow in BOWS_MM for _ in range(2)]
    fx = {float(row["bow_mm"]): float(row["flat_fx_px"]) for row in rows if row["repeat"] == 0}
    # Small bows move the camera in proportion: 1 mm twice as far as 0.5 mm.
    assert (fx[1.0] - fx[0.0]) / (fx[0.5] - fx[0.0]) == pytest.approx(2, abs=0.1)
    assert abs(fx[1.0]) > 2
    for row in rows:
        if float(row["bow_mm"]) >= 0.5:
            assert float(row["found_mm"]) == pytest.approx(float(row["bow_mm"]), abs=0.05)
            assert abs(float(row["bow_fx_px"])) < 1
    text = flatness_text(rows)
    assert text.count("\n") == 1 + len(BOWS_MM) and "| 0.2 mm" in text
