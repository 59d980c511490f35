"""What other commands do with the folder of a session."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.conftest import Ran

Run = Callable[..., Ran]


def test_calibrate_takes_a_session(run: Run, kept_session: Path) -> None:
    """The same pictures give what the session found; the detector sees what it saw."""
    found = json.loads((kept_session / "result.json").read_text())
    ran = run("calibrate", kept_session, "--json")
    assert ran.json["views"] == found["views"]
    assert ran.json["intrinsics"]["fx"] == pytest.approx(found["intrinsics"]["fx"], abs=0.5)
    assert f"pictures of the {found['views']} views" in ran.err


def test_calibrate_takes_the_sessions_board(run: Run, kept_session: Path, tmp_path: Path) -> None:
    """As given with the session, unless one is given now; and all pictures without a journal."""
    session = tmp_path / "session"
    shutil.copytree(kept_session, session)
    header = json.loads((session / "session.json").read_text())
    header["options"]["board"]["square_mm"] = 56.0
    header["options"]["board"]["marker_mm"] = 42.0
    (session / "session.json").write_text(json.dumps(header))
    (session / "events.jsonl").write_text("nonsense\n")
    assert run("calibrate", session, "--json").json["board"]["square_mm"] == 56.0
    given = run("calibrate", session, "--json", "--board.square-mm", 30, "--board.marker-mm", 22.5)
    assert given.json["board"]["square_mm"] == 30.0


def test_calibrate_of_a_session_without_a_picture(run: Run, tmp_path: Path) -> None:
    (tmp_path / "session.json").write_text('{"schema": 1}')
    assert "without a picture" in run("calibrate", tmp_path).sentence
