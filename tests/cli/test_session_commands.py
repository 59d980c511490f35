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


def test_from_a_result_goes_on_with_its_views(
    run: Run, kept_session: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    """They are in the new session as well, with their pictures, and the same pictures add nothing
    to them."""
    views = json.loads((kept_session / "result.json").read_text())["views"]
    asked = ("guide", tilted_pictures, "--headless", "--method", "random", "--max-views", 7)
    ran = run(*asked, "--from", kept_session, "--output", tmp_path / "on", "--json")
    assert ran.code == 0 and f"Going on from the {views} views" in ran.err
    assert ran.json["views"] >= views
    kept = [path.name for path in sorted((tmp_path / "on" / "views").iterdir())]
    assert len(kept) == ran.json["views"]
    for path in (kept_session / "views").iterdir():
        assert (tmp_path / "on" / "views" / path.name).read_bytes() == path.read_bytes()
    again = run("guide", "--resume", tmp_path / "on", "--headless", "--json")
    assert again.json["views"] == ran.json["views"]


def test_from_what_does_not_go_together(
    run: Run, kept_session: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    asked = ("guide", tilted_pictures, "--headless", "--output", tmp_path / "on")
    both = run(*asked, "--from", kept_session, "--resume", kept_session)
    assert "give one of them" in both.sentence
    board = run(*asked, "--from", kept_session, "--board.square-mm", 30)
    assert "another board" in board.sentence
    few = run(*asked, "--from", kept_session, "--max-views", 2)
    assert "--max-views" in few.sentence
    small = run("guide", "sim", *asked[2:], "--camera-size", "640x480", "--from", kept_session)
    assert "1280 x 720" in small.sentence
    assert "cannot be read" in run(*asked, "--from", tmp_path / "none.yaml").sentence
    assert not (tmp_path / "on" / "session.json").exists()


def test_a_source_that_cannot_be_opened_leaves_no_session(run: Run, tmp_path: Path) -> None:
    """Nor is it said that one is kept."""
    ran = run("guide", tmp_path / "nothing.mp4", "--output", tmp_path / "new")
    assert "nothing.mp4" in ran.sentence and "kept" not in ran.err
    assert not (tmp_path / "new").exists()
