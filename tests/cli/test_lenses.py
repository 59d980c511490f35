"""Guided calibrations of cameras that are no webcams, from the first picture to the result."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.cli.conftest import Ran
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.target import Target
from venus3d.scene.pages.guide import headless
from venus3d.sources.sim import Simulation

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


def test_an_end_without_convergence_is_told(run: Callable[..., Ran]) -> None:
    """`--max-views` is an end that was asked for; a hand that is stuck is none."""
    ran = run(*GUIDED, "--camera-size", "640x360", "--max-views", 3)
    assert ran.code == 0, ran.err
    assert ran.json["converged"] is False
    told = [one for one in ran.json["warnings"] if one.startswith("Not converged after 3 views:")]
    assert len(told) == 1 and "--max-views" in told[0] and "fx" in told[0]
    assert f"Mind: {told[0]}" in ran.out


def test_guidance_that_breaks_off_says_why_and_ends_with_code_3(
    run: Callable[..., Ran], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The simulated hand got stuck after four views, and the command ended as if all was well."""
    follow = Simulation.follow

    def stuck(self: Simulation, target: Target | None, seen: Pose | None, *, begins: bool) -> None:
        follow(self, None if target and target.number > 3 else target, seen, begins=begins)

    monkeypatch.setattr(Simulation, "follow", stuck)
    monkeypatch.setattr(headless, "_PATIENCE_FRAMES", 40)
    ran = run(*GUIDED, "--camera-size", "640x360", "--speed", 4)
    assert ran.code == 3, ran.err
    assert ran.json["views"] == 3 and ran.json["converged"] is False
    assert any("simulated hand did not come near" in one for one in ran.json["warnings"])


def test_without_a_pose_that_fits_the_cause_is_named(run: Callable[..., Ran]) -> None:
    """It said that there is only one view."""
    sentence = run(*GUIDED, "--limits.min-square-px", 300, "--camera-size", "640x360").sentence
    assert "No pose of this board fits the limits" in sentence
