"""No command writes over what a session or another result holds."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import av
import pytest
from PIL import Image

from tests.cli.conftest import Ran
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.storage.formats import export_camera, import_camera

Run = Callable[..., Ran]


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def session(kept_session: Path, tmp_path: Path) -> Path:
    return shutil.copytree(kept_session, tmp_path / "s1")


@pytest.fixture
def calibrated(run: Run, tilted_pictures: Path, tmp_path: Path) -> Path:
    """A folder with the result of `calibrate`, which is no session."""
    assert run("calibrate", tilted_pictures, "--output", tmp_path / "n4").code == 0
    return tmp_path / "n4"


@pytest.mark.parametrize(
    "command",
    [
        "report s1 --output s1/events.jsonl",
        "report s1 --output s1/result.json",
        "report s1 --output s1/views",
        "export s1 --to json --output s1/session.json",
        "export s1 --to json --output s1/result.json",
        "export s1 --to ros --output s1/camera.yaml",
        "export s1 --to opencv-yaml --output s1",
        "import s1/camera.yaml --output s1/views/001.png",
        "undistort PICTURES --camera s1 --output s1",
        "undistort PICTURES --camera s1 --output s1/views",
        "calibrate PICTURES --output s1",
        "calibrate s1 --output s1",
        "calibrate PICTURES --output s1/views",
        "verify s1 PICTURES --output s1/views",
        "guide sim --no-record --headless --autopilot --max-views 3 --speed 5 --output s1",
        "guide sim --no-record --headless --autopilot --from s1/result.json --output s1",
        "decompose 10 0 0 0 0 400 --output s1/views",
        "board --output s1/views/001.png",
        "board --save s1/session.json",
        "teach --export s1/views/001.png",
        "replay s1 --export s1/views/001.mp4",
        "study flatness --output s1/views",
    ],
)
def test_a_session_is_written_by_itself_alone(
    run: Run, session: Path, tilted_pictures: Path, command: str
) -> None:
    before = contents(session)
    asked = command.replace("s1", str(session)).replace("PICTURES", str(tilted_pictures))
    sentence = run(*asked.split()).sentence
    assert "s1 is the folder of a session" in sentence
    option = next(one for one in ("--export", "--save", "--output") if one in command)
    assert f"name another with {option}" in sentence or "choose another place" in sentence
    assert contents(session) == before


def test_other_names_in_a_sessions_folder_are_free(run: Run, session: Path) -> None:
    """A report also again; what the session holds stays as it is."""
    before = contents(session)
    for _ in range(2):
        assert run("report", session).code == 0
        assert run("export", session, "--to", "ros", "--output", session / "ros.yaml").code == 0
    new = {session / "report.html", session / "ros.yaml"}
    assert {path: kept for path, kept in contents(session).items() if path not in new} == before
    ran = run("guide", "--resume", session, "--headless", "--json")
    assert ran.json["views"] == json.loads(before[session / "result.json"])["views"]


def test_a_calibration_is_kept_from_other_commands(
    run: Run, calibrated: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    export_camera(PAPER_CAMERA, tmp_path / "other.json", "json")
    before = contents(calibrated)
    camera, result = calibrated / "camera.yaml", calibrated / "result.json"
    for command in (
        ("undistort", tilted_pictures, "--camera", calibrated, "--output", calibrated),
        ("undistort", tilted_pictures, "--camera", tmp_path / "other.json", "--output", calibrated),
        ("report", calibrated, "--output", camera),
        ("report", calibrated, "--output", result),
        ("export", calibrated, "--to", "json", "--output", result),
        ("import", tmp_path / "other.json", "--output", result),
        ("board", "--save", camera),
    ):
        sentence = run(*command).sentence
        assert "belongs to the calibration" in sentence and "name another with --" in sentence
    assert contents(calibrated) == before
    # The same kind of product again is no mistake: the earlier one is kept.
    assert run("calibrate", tilted_pictures, "--output", calibrated).code == 0
    assert set(before.values()) <= set(contents(calibrated).values())


def test_import_and_export_replace_no_other_file(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the usual name, too. The same content again is no loss."""
    monkeypatch.chdir(tmp_path)
    export_camera(PAPER_CAMERA, "other.json", "json")
    assert run("import", "other.json").code == 0
    written = Path("camera.yaml").read_text()
    another_day = re.sub(r'(calibration_time: )"[^"]+"', r'\1"2020-01-01T00:00:00+00:00"', written)
    assert another_day != written
    Path("camera.yaml").write_text(another_day)
    assert run("import", "other.json").code == 0
    before = Path("camera.yaml").read_bytes()
    export_camera(PAPER_CAMERA.scaled((640, 360)), "small.json", "json")
    for command in (
        ("import", "small.json"),
        ("export", "small.json", "--to", "opencv-yaml"),
        ("export", "small.json", "--to", "ros", "--output", "camera.yaml"),
    ):
        ran = run(*command)
        assert ran.code == 2 and len(ran.err.splitlines()) == 1
        assert "camera.yaml exists already" in ran.err and "name another with --output" in ran.err
    assert Path("camera.yaml").read_bytes() == before
    assert run("import", "small.json", "--output", "small.yaml").code == 0
    assert import_camera("small.yaml").camera.image_size == (640, 360)


def test_undistort_keeps_the_camera_that_it_reads(
    run: Run, tilted_pictures: Path, tmp_path: Path
) -> None:
    """Without a result.json beside it; named or by its folder. Elsewhere it is written again."""
    camera = export_camera(PAPER_CAMERA, tmp_path / "one" / "camera.yaml")
    before = contents(camera.parent)
    for given in (camera, camera.parent):
        asked = ("undistort", tilted_pictures, "--camera", given, "--output")
        assert "is the source itself" in run(*asked, camera.parent).sentence
    assert contents(camera.parent) == before
    assert run(*asked, tmp_path / "out").code == 0
    assert run(*asked, tmp_path / "out", "--alpha", 1).code == 0


def test_a_report_a_board_and_pictures_replace_only_their_own(
    run: Run, calibrated: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    letter, shots = tmp_path / "letter.html", tmp_path / "shots"
    letter.write_text("<!doctype html><p>Dear Ada, venus3d</p>")
    shutil.copytree(tilted_pictures, shots)
    notes = tmp_path / "notes.toml"
    notes.write_text('colour = "blue"\n')
    before = contents(tmp_path)
    undistort = ("undistort", tilted_pictures, "--camera", calibrated / "camera.yaml", "--output")
    for command in (
        ("report", calibrated, "--output", letter),
        ("board", "--save", notes),
        ("board", "--save", letter),
        (*undistort, shots),
    ):
        assert "exists already and holds something else" in run(*command).sentence
    assert contents(tmp_path) == before
    for command in (
        ("report", calibrated, "--output", tmp_path / "report.html"),
        ("board", "--save", tmp_path / "board.toml"),
        (*undistort, tmp_path / "straight"),
    ):
        assert run(*command).code == 0 and run(*command).code == 0
    assert run("board", "--board.columns", 7, "--save", tmp_path / "board.toml").code == 0


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("board --output PLACE", "board.pdf"),
        ("board --output PLACE", "board.svg"),
        ("board --output PLACE --paper fit", "board.PNG"),
        ("board --output PLACE --show", "board.html"),
        ("decompose 10 0 0 0 0 400 --output FOLDER", "step-3.png"),
        ("replay SHORT --export PLACE", "film.mp4"),
        ("replay SHORT --export PLACE", "class.html"),
        ("teach LESSON --export PLACE", "lesson.gif"),
        ("teach LESSON --export PLACE", "lesson.html"),
        ("verify SESSION PICTURES --output FOLDER", "verification.json"),
        ("verify SESSION PICTURES --output FOLDER", "verification.html"),
    ],
)
def test_what_a_command_makes_replaces_only_its_like(
    run: Run,
    kept_session: Path,
    short_session: Path,
    tilted_pictures: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    command: str,
    name: str,
) -> None:
    """A film or a page of somebody else's was lost by `replay --export`, a drawing by `board`. The
    same may be made again; the refusal comes before the work."""
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    folder = tmp_path / "Tür und Tor"
    folder.mkdir()
    place = folder / name
    named = {"PLACE": place, "FOLDER": folder, "SESSION": kept_session, "PICTURES": tilted_pictures}
    named["SHORT"], named["LESSON"] = short_session, tmp_path / "lesson.toml"
    named["LESSON"].write_text(
        'title = "One"\nsummary = "One."\n[[page]]\ntitle = "One"\ntext = "One."\n'
        "pose = [0, 0, 9, 0, 0, 500]\n"
    )
    asked = [named.get(word, word) for word in command.split()]
    place.write_bytes(b"mine")
    assert "exists already and holds something else" in run(*asked).sentence
    assert contents(folder) == {place: b"mine"}
    place.unlink()
    for _ in range(2):
        ran = run(*asked)
        assert ran.code in (0, 3), ran.err
    content = place.read_bytes()
    match place.suffix.lower():
        case ".png" | ".gif":
            with Image.open(place) as picture:
                picture.verify()
        case ".mp4":
            with av.open(str(place)) as film:
                assert len(list(film.decode(video=0))) > 10
        case ".svg":
            assert ElementTree.fromstring(content).tag.endswith("svg")
        case ".json":
            assert json.loads(content)["verdict"]
        case _:
            assert content.startswith((b"%PDF", b"<!doctype html>"))


def test_another_sessions_film_is_kept(run: Run, short_session: Path, tmp_path: Path) -> None:
    film = tmp_path / "film.mp4"
    assert run("replay", short_session, "--export", film).code == 0
    other = shutil.copytree(short_session, tmp_path / "other")
    header = json.loads((other / "session.json").read_text())
    header["begun"] = "2020-01-01T00:00:00"
    (other / "session.json").write_text(json.dumps(header))
    before = film.read_bytes()
    for command in (("replay", other, "--export", film), ("teach", "--export", film)):
        assert "name another with --export" in run(*command).sentence
    assert film.read_bytes() == before


def test_no_file_takes_the_place_of_a_device_or_a_pipe(
    run: Run, calibrated: Path, tmp_path: Path
) -> None:
    """`/dev/full` became a file, and a link to a device too."""
    pipe, link = tmp_path / "pipe.html", tmp_path / "link.html"
    os.mkfifo(pipe)
    link.symlink_to("/dev/null")
    for place in (pipe, link):
        for command in (
            ("report", calibrated, "--output", place),
            ("export", calibrated, "--to", "json", "--output", place),
            ("board", "--save", place),
        ):
            assert "is a device or a pipe, no file" in run(*command).sentence
    assert pipe.is_fifo() and link.is_symlink() and Path("/dev/null").is_char_device()


def test_undistort_keeps_another_cameras_file(
    run: Run, calibrated: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    other = export_camera(PAPER_CAMERA, tmp_path / "other" / "camera.yaml")
    before = contents(other.parent)
    asked = ("undistort", tilted_pictures, "--camera", calibrated / "camera.yaml", "--output")
    assert "exists already and holds something else" in run(*asked, other.parent).sentence
    assert contents(other.parent) == before


def test_a_name_that_is_too_long_ends_in_one_sentence(
    run: Run, calibrated: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    long = tmp_path / ("x" * 300)
    for command in (
        ("board", "--save", long),
        ("board", "--output", f"{long}.pdf"),
        ("report", calibrated, "--output", f"{long}.html"),
        ("export", calibrated, "--to", "ros", "--output", long),
        ("undistort", tilted_pictures, "--camera", calibrated, "--output", long),
        ("calibrate", tilted_pictures, "--output", long),
    ):
        assert "(file name too long)" in run(*command).sentence


@pytest.mark.parametrize(
    ("study", "name"),
    [
        ("flatness", "rows.csv"),
        ("flatness", "table.md"),
        ("bench", "rows.csv"),
        ("table3 --quick", "rows.csv"),
        ("table3 --quick", "rows.journal.jsonl"),
        ("figures", "verdicts.md"),
        ("figures", "figure7.svg"),
        ("table1 sim", "rows.csv"),
        ("table2 PICTURES", "table.md"),
        ("halves PICTURES", "rows.csv"),
    ],
)
def test_a_study_replaces_no_other_file(
    run: Run, tilted_pictures: Path, tmp_path: Path, study: str, name: str
) -> None:
    """It says so before its work, of which nothing is left then."""
    (tmp_path / name).write_text("mine")
    asked = study.replace("PICTURES", str(tilted_pictures)).split()
    sentence = run("study", *asked, "--output", tmp_path).sentence
    assert name in sentence and "name another" in sentence
    assert contents(tmp_path) == {tmp_path / name: b"mine"}


def test_a_study_replaces_what_it_made(run: Run, tmp_path: Path) -> None:
    asked = ("study", "flatness", "--repeats", 1, "--output", tmp_path)
    assert run(*asked).code == 0
    before = contents(tmp_path)
    assert {path.name for path in before} == {"rows.csv", "table.md"}
    assert run(*asked, "--seed", 1).code == 0
    after = contents(tmp_path)
    assert after.keys() == before.keys() and after != before
