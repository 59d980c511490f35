"""The examples run as they stand, and stay short."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from venus3d.engine.geometry.pose import Pose

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def ran(name: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / name), *arguments],
        capture_output=True,
        text=True,
        timeout=300,
        cwd=EXAMPLES.parent,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_example_is_short(path: Path) -> None:
    assert len(path.read_text().splitlines()) < 60


def test_calibrate_folder(tilted_pictures: Path) -> None:
    out = ran("calibrate_folder.py", str(tilted_pictures))
    fx = next(line for line in out.splitlines() if line.startswith("fx = "))
    assert float(fx.split()[2]) == pytest.approx(1068, abs=3)


def test_decompose_pose() -> None:
    out = ran("decompose_pose.py")
    assert "2. Tilt the top edge towards the camera by 25°." in out
    target = Pose.from_vector([25, -30, 20, 0, 0, 1])
    own = Pose.from_vector([25, -30, 20, 0, 0, 1], axes="own")
    assert f"{target.angle_to_deg(own):.1f}° away" in out


def test_suggest_next_pose() -> None:
    out = ran("suggest_next_pose.py")
    errors = [float(line.split()[-2]) for line in out.splitlines() if "projected point" in line]
    assert len(errors) == 3 and errors[2] < errors[1] < errors[0]


@pytest.mark.slow
def test_simulated_session() -> None:
    assert "finished after 2 views" in ran("simulated_session.py", "2")


@pytest.mark.slow
def test_feed_the_viewer() -> None:
    """Another program shows its own snapshots; no browser need be open."""
    assert "http://" in ran("feed_the_viewer.py", "3")
