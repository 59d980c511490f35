"""What other commands do with the folder of a session."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.cli.conftest import Ran
from tests.engine.calibration.test_adjustment import GOOD, observe
from venus3d.cli.kept_session import opened_session, resumed_options
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.views import CapturedView
from venus3d.options import BoardOptions
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.sources.camera_settings import CameraSettings
from venus3d.storage.session_moments import moments_of

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
    usual = run("calibrate", session, "--json", "--board.square-mm", 28, "--board.marker-mm", 21)
    assert usual.json["board"]["square_mm"] == 28.0
    header["options"]["board"]["columns"] = 7
    (session / "session.json").write_text(json.dumps(header))
    assert run("calibrate", session, "--json", "--board.columns", 9).json["board"] == {
        **usual.json["board"],
        "square_mm": 56.0,
        "marker_mm": 42.0,
    }
    (session / "session.json").write_text('{"schema": 1}')
    assert "give --board.* too" in run("calibrate", session).sentence
    (session / "session.json").write_text("nonsense")
    assert run("calibrate", session, "--board.columns", 9).code == 0


def test_calibrate_of_a_session_without_a_picture(run: Run, tmp_path: Path) -> None:
    (tmp_path / "session.json").write_text('{"schema": 1, "options": {"board": {}}}')
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


def test_from_takes_the_board_of_the_views(
    run: Run, kept_session: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    """Unless another is given, also the usual one; the new session tells it to whoever reads it."""
    result = json.loads((kept_session / "result.json").read_text())
    result["board"].update(square_mm=56.0, marker_mm=42.0)
    session = shutil.copytree(kept_session, tmp_path / "session")
    (session / "result.json").write_text(json.dumps(result))
    asked = ("guide", tilted_pictures, "--headless", "--method", "random", "--max-views", 7)
    asked = (*asked, "--from", session, "--output", tmp_path / "on")
    assert "another board" in run(*asked, "--board.square-mm", 28, "--board.marker-mm", 21).sentence
    assert run(*asked).code == 0
    assert run("calibrate", tmp_path / "on", "--json").json["board"]["square_mm"] == 56.0


def test_a_source_that_cannot_be_opened_leaves_no_session(run: Run, tmp_path: Path) -> None:
    """Nor is it said that one is kept."""
    ran = run("guide", tmp_path / "nothing.mp4", "--output", tmp_path / "new")
    assert "nothing.mp4" in ran.sentence and "kept" not in ran.err
    assert not (tmp_path / "new").exists()


def test_what_is_set_on_the_camera_is_set_again_when_it_goes_on(
    tmp_path: Path, default_board: Board, paper_camera: Camera
) -> None:
    """By its last state, not by how it began; what is asked for now wins, and another camera gets
    nothing of it."""
    directory = tmp_path / "session"
    begun = GuideOptions(
        source="0", output=directory, camera=CameraSettings(focus="lock", gain="3")
    )
    kept = opened_session(begun, print)
    assert kept.folder is not None
    rng = np.random.default_rng(0)
    seen = observe(paper_camera, default_board, GOOD[0], rng, 0.1)
    kept.folder.changed(Session(default_board, paper_camera.image_size).state)
    kept.folder.captured(CapturedView(1, seen, None)).result()
    kept.camera_set(CameraSettings(focus="35", gain="3"))
    kept.camera_set(CameraSettings(focus="40", gain="3"))
    kept.close()

    def resumed(*arguments: str) -> CameraSettings:
        given = ["--resume", str(directory), *arguments]
        again = opened_session(resumed_options(given, directory), print)
        again.close()
        return again.options.camera

    assert resumed() == CameraSettings(focus="40", gain="3")
    asked = resumed("0", "--camera.gain", "auto")
    assert asked == CameraSettings(focus="40", gain="auto")
    assert resumed("1") == CameraSettings()
    assert [moment.kind for moment in moments_of(directory)] == ["captured"]


def test_what_is_given_again_counts_also_where_it_is_the_usual(
    tmp_path: Path, default_board: Board, paper_camera: Camera
) -> None:
    """ "sim" and 20 views are what a command without options takes; switches stay on."""
    directory = tmp_path / "session"
    begun = GuideOptions(
        source="0",
        output=directory,
        max_views=3,
        flip=True,
        auto_capture=False,
        headless=True,
        json=True,
        board=BoardOptions(columns=7, legacy=True),
    )
    kept = opened_session(begun, print)
    assert kept.folder is not None
    seen = observe(paper_camera, default_board, GOOD[0], np.random.default_rng(0), 0.1)
    kept.folder.captured(CapturedView(1, seen, None)).result()
    kept.close()

    def resumed(*arguments: str) -> GuideOptions:
        return resumed_options(["--resume", str(directory), *arguments], directory)

    # Without a page, and printed as JSON, is one run alone: no option could undo it.
    before = replace(begun, output=None, resume=directory, headless=False, json=False)
    assert resumed() == before
    assert resumed("sim", "--max-views", "20") == replace(before, source="sim", max_views=20)
    assert resumed("--auto-capture", "--headless").auto_capture
    assert resumed("--board.columns", "9").board == BoardOptions(columns=9, legacy=True)
    for elsewhere in (("--output", str(tmp_path / "other")), ("--no-record",)):
        with pytest.raises(VenusError, match="own folder"):
            resumed(*elsewhere)


@pytest.mark.slow
def test_a_session_that_goes_on_keeps_its_board(run: Run, tmp_path: Path) -> None:
    """Half of its views would be of a board of another size. What a reader of session.json needs is
    in it: the size of the pictures, and the board as it is read."""
    directory = tmp_path / "session"
    guided = ("guide", "sim", "--headless", "--autopilot", "--speed", "4", "--max-views", "3")
    run(*guided, "--camera-size", "640x360", "--output", directory)
    header = json.loads((directory / "session.json").read_text())
    assert header["image_size"] == [640, 360]
    assert header["board"]["columns"] == 9 and header["board"]["marker_mm"] == pytest.approx(21)
    again = ("guide", "--resume", directory, "--headless", "--max-views", "4")
    ran = run(*again, "--board.square-mm", "14", "--board.marker-mm", "10.5")
    assert "leave the board's options out" in ran.sentence
    assert "Going on with 3 views" in run(*again, "--board.columns", "9").err


def test_a_session_that_cannot_be_gone_on_with_names_the_way_out(
    run: Run, kept_session: Path, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(kept_session, tmp_path / "session"))
    header = folder / "session.json"
    newer = {**json.loads(header.read_text()), "schema": 99}
    wrong = {**newer, "schema": 1, "options": {"source": 5}}
    told = {
        "{": "is damaged (Expecting property name",
        "[]": "is damaged (no schema)",
        json.dumps(newer): "has schema 99, and this version reads schema 1: a newer venus3d",
        json.dumps(wrong): "is not of this version",
    }
    for content, cause in told.items():
        header.write_text(content)
        sentence = run("guide", "--resume", folder, "--headless").sentence
        assert cause in sentence and f"venus3d calibrate {folder / 'views'}," in sentence
    assert run("calibrate", folder / "views").code == 0


def test_a_missing_picture_is_told_and_its_corners_count(
    run: Run, kept_session: Path, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(kept_session, tmp_path / "session"))
    asked = ("guide", "--resume", folder, "--headless", "--method", "random", "--json")
    before = run(*asked)
    assert "is missing" not in before.err
    (folder / "views" / "002.png").unlink()
    after = run(*asked)
    assert f"The picture of view 2 is missing ({folder}/views/002.png)" in after.err
    assert after.json["views"] == before.json["views"] > 1
    calibrated = run("calibrate", folder, "--json")
    assert f"{folder}/views/002.png is missing and left out" in calibrated.err
