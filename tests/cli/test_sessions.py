"""A guided session survives a kill, and is gone on with by the command that says so."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.cli.killed import check, killed_after

VENUS3D = (sys.executable, "-m", "venus3d")


def guided(*arguments: str) -> dict[str, Any]:
    """The result of a headless session that ends well."""
    command = [*VENUS3D, "guide", "--headless", "--json", *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def targets(folder: Path) -> list[Any]:
    """The pose asked for at each view; None for the first."""
    events = [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]
    asked = [event["target"] for event in events if event["event"] == "captured"]
    return [target and target["T_camera_board"] for target in asked]


@pytest.mark.slow
def test_a_killed_session_goes_on_to_the_same_targets(tmp_path: Path) -> None:
    """Killed after its second view, and resumed. `python -m tests.cli.killed` kills 200."""
    folder = tmp_path / "session"
    reported = killed_after(folder, views=2, seconds=0.2)
    assert len(reported) >= 2 and not check(folder, reported)
    result = guided("--resume", str(folder), "--max-views", "4")
    assert result["views"] == 4
    size = ("--camera-size", "640x360")
    guided(*size, "--output", str(tmp_path / "other"), "--max-views", "3")
    assert targets(folder)[:3] == targets(tmp_path / "other")
    again = subprocess.run(
        [*VENUS3D, "guide", "--headless", "--output", str(folder)], capture_output=True, text=True
    )
    assert again.returncode != 0 and f"--resume {folder}" in again.stderr
