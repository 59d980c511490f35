"""Guided calibrations of cameras that are no webcams, from the first picture to the result."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.cli.conftest import Ran

GUIDED = ("guide", "sim", "--headless", "--autopilot", "--no-record", "--json")


@pytest.mark.slow
@pytest.mark.parametrize("camera", ["action", "fisheye"])
def test_a_wide_lens_is_found_out_and_calibrated(run: Callable[..., Ran], camera: str) -> None:
    # Simulated time costs nothing, but each picture on the way does.
    ran = run(*GUIDED, "--sim.camera", camera, "--speed", 4)
    assert ran.code == 0, ran.err
    assert "bends like a fisheye" in ran.out
    result = ran.json
    assert result["converged"] and result["views"] <= 12 and result["model"] == "fisheye"
    assert result["rms_px"] < 0.2
    for name, true in result["truth"].items():
        assert abs(result["intrinsics"][name] - true) < 4 * result["std"][name], name


def test_a_telephoto_stays_with_five_coefficients(run: Callable[..., Ran]) -> None:
    ran = run(*GUIDED, "--sim.camera", "telephoto", "--max-views", 4)
    assert ran.code == 0, ran.err
    result = ran.json
    assert result["views"] == 4 and "bends like" not in ran.out
    fx, sigma = result["intrinsics"]["fx"], result["std"]["fx"]
    assert abs(fx - result["truth"]["fx"]) < 4 * sigma and sigma < 60
