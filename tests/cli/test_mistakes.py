"""Every mistake a user can make ends in one sentence and exit code 2.

The texts are pinned: a sentence that names cause and cure is part of the program.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.cli.conftest import Ran
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Pose
from venus3d.storage.formats import export_camera

Run = Callable[..., Ran]
Photographs = Callable[[str, Sequence[Pose]], Path]


def test_no_such_source(run: Run) -> None:
    assert run("calibrate", "no/such/place").sentence == (
        "There is no file or folder no/such/place; give an existing video, image or folder, a "
        "pattern of images, a camera's number or a stream's address (guide also takes sim)."
    )


def test_text_file_named_jpg(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "text.jpg"
    path.write_text("no picture")
    assert run("calibrate", path).sentence == (
        f"{path} is not an image, whatever its name says; use a PNG, JPEG, TIFF or BMP file."
    )


def test_image_without_board(run: Run, blank_picture: Path) -> None:
    assert run("calibrate", blank_picture).sentence == (
        "There is no view to calibrate from: the board was found in no image; check its size "
        "(columns and rows swapped?), its dictionary and that the picture is sharp."
    )


def test_truncated_video(run: Run, tmp_path: Path, shared_data: Path) -> None:
    whole = (shared_data / "wpilib-charuco-12x8.mp4").read_bytes()
    path = tmp_path / "cut.mp4"
    path.write_bytes(whole[: len(whole) // 3])
    assert "cut.mp4" in run("calibrate", path).sentence


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (
            ["--board.square-mm", "20", "--board.marker-mm", "20"],
            "The marker (20 mm) must be smaller than the square (20 mm); are the two swapped?",
        ),
        (
            ["--board.dictionary", "DICT_4X4_50", "--board.columns", "12", "--board.rows", "12"],
            "DICT_4X4_50 has 50 markers, but a board of 12 x 12 squares needs 72; use a larger "
            "dictionary.",
        ),
        (
            ["--board.columns", "2"],
            "A board of 2 x 6 squares has too few inner corners to calibrate with; use at least 3 "
            "columns and 3 rows.",
        ),
        (
            ["--board.marker-mm", "-3"],
            "Square and marker sizes must be positive numbers.",
        ),
    ],
)
@pytest.mark.parametrize("command", [["calibrate", "."], ["board"], ["guide", "--headless"]])
def test_options_that_make_no_board(
    run: Run, command: list[str], options: list[str], sentence: str
) -> None:
    ran = run(*command, *options)
    if sentence.endswith("?"):  # the sentence with its question is one sentence all the same
        assert (ran.code, ran.err) == (2, f"venus3d: {sentence}\n")
    else:
        assert ran.sentence == sentence


def test_unknown_dictionary(run: Run) -> None:
    sentence = run("board", "--board.dictionary", "DICT_9X9").sentence
    assert sentence.startswith("There is no marker dictionary 'DICT_9X9'; use one of DICT_4X4_100")


def test_two_images_only(run: Run, tmp_path: Path, tilted_pictures: Path) -> None:
    for name in ("01.png", "02.png"):
        shutil.copy(tilted_pictures / name, tmp_path / name)
    assert run("calibrate", tmp_path).sentence == (
        "Only 2 pictures show the board, and a calibration needs at least 3 different views, "
        "better 10 with the board tilted in different directions."
    )


def test_all_views_parallel(run: Run, photographs: Photographs) -> None:
    poses = [Pose.from_vector((0, 0, 0, x, 0, z)) for x in (-0.05, 0.05) for z in (0.4, 0.5)]
    sentence = run("calibrate", photographs("parallel", poses)).sentence
    assert sentence.startswith("The focal length is not determined by these views:")
    assert sentence.endswith("tilt the board by 20-45° in different directions.")


def test_mixed_image_sizes(run: Run, tmp_path: Path, tilted_pictures: Path) -> None:
    shutil.copy(tilted_pictures / "01.png", tmp_path / "a.png")
    cv2.imwrite(str(tmp_path / "b.png"), np.zeros((480, 640, 3), np.uint8))
    sentence = run("calibrate", tmp_path).sentence
    assert "1280 x 720" in sentence and "640 x 480" in sentence
    assert "a.png" in sentence and "b.png" in sentence


@pytest.mark.parametrize("command", [["calibrate", "."], ["guide", "--headless"]])
def test_unwritable_output(run: Run, tmp_path: Path, command: list[str]) -> None:
    """Said before the work starts: a file stands where the folder should be."""
    (tmp_path / "file").write_text("")
    place = tmp_path / "file" / "results"
    assert run(*command, "--output", place).sentence == (
        f"Nothing can be written to {place} (not a directory); choose another folder with --output."
    )


def test_board_into_unwritable_place(run: Run, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    path = tmp_path / "file" / "board.png"
    assert run("board", "--output", path).sentence == (
        f"{path} cannot be written (not a directory); choose another place."
    )


def test_board_too_coarse(run: Run, tmp_path: Path) -> None:
    assert run("board", "--dpi", "10", "--output", tmp_path / "b.png").sentence == (
        "At 10 dpi a square of 28 mm is 11 px wide, too coarse for the markers; use a higher --dpi."
    )


@pytest.mark.parametrize(
    ("pose", "limit"),
    [
        ((0, 0, 80, 0, 0, 500), "The turn about Z is 80°; more than 70° is hard to hold"),
        ((0, 62, 0, 0, 0, 500), "The board is tilted by 62° away from the camera's line of sight"),
        ((0, 0, 0, 0, 0, 5000), "1200 mm is the farthest"),
        ((0, 0, 0, 0, 0, 120), "leaves the picture"),
        ((0, 0, 0, 400, 0, 500), "leaves the picture on the right"),
    ],
)
def test_pose_outside_the_limits(
    run: Run, tmp_path: Path, pose: tuple[float, ...], limit: str
) -> None:
    sentence = run("decompose", *pose, "--output", tmp_path).sentence
    assert limit in sentence and "choose another pose" in sentence
    # No option moves the border of the picture.
    assert ("--limits" in sentence) == ("picture" not in limit)
    assert not list(tmp_path.iterdir())


def test_pose_behind_the_lens(run: Run) -> None:
    assert run("decompose", 0, 0, 0, 0, 0, -500).sentence == (
        "The board's centre would be 500 mm behind the lens; ZT must be positive."
    )


def test_pose_that_is_no_number(run: Run) -> None:
    ran = run("decompose", "nan", 0, 0, 0, 0, 500)
    assert ran.sentence.startswith("A pose is six finite numbers")
    ran = run("decompose", "left", 0, 0, 0, 0, 500)
    assert ran.code == 2 and "Traceback" not in ran.err


def test_camera_file_that_holds_none(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "camera.yaml"
    path.write_text("%YAML:1.0\n---\nfocal: 3\n")
    assert run("decompose", 0, 0, 0, 0, 0, 500, "--camera", path).sentence == (
        f"There is no camera in {path} as OpenCV's YAML holds it; docs/formats.md says what it "
        "must hold. If it is of another format, name that with --format (venus3d import makes a "
        "camera.yaml of it)."
    )


@pytest.mark.parametrize(
    "command",
    [
        "measure --camera FILE",
        "undistort PICTURES --camera FILE",
        "decompose 10 0 0 0 0 400 --camera FILE",
        "guide PICTURES --headless --no-record --from FILE",
        "teach --camera FILE",
        "practice --camera FILE",
        "trial --camera FILE",
    ],
)
@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"fx": 1e9, "fy": 1e9}, "would see 7.334e-05° (fx = 1e+09,"),
        ({"fx": 0.83, "fy": 0.83}, "would see 179.9° (fx = 0.83,"),
        ({"cx": 1e6}, "no ray reaches 100 % of it"),
    ],
)
def test_a_camera_that_cannot_be(
    run: Run,
    tilted_pictures: Path,
    tmp_path: Path,
    command: str,
    changed: dict[str, float],
    told: str,
) -> None:
    """It was measured, taught and guided with, without a word."""
    file = tmp_path / "camera.json"
    export_camera(replace(PAPER_CAMERA, **changed), file, "json")
    asked = command.replace("FILE", str(file)).replace("PICTURES", str(tilted_pictures))
    sentence = run(*asked.split()).sentence
    assert told in sentence and "camera file" in sentence


def test_decompose_takes_any_camera_file(run: Run, tmp_path: Path) -> None:
    printed: set[str] = set()
    for name in ("opencv-yaml", "ros", "colmap", "mrcal", "json", "matlab"):
        export_camera(PAPER_CAMERA, tmp_path / name, name)
        asked = ("decompose", 20, 0, 0, 0, 0, 400, "--camera", tmp_path / name)
        ran = run(*asked, "--output", tmp_path / "steps")
        assert ran.code == 0
        printed.add(ran.out)
    assert len(printed) == 1


def test_a_name_where_cameras_have_none(run: Run, tmp_path: Path) -> None:
    """It was ignored."""
    export_camera(PAPER_CAMERA, tmp_path / "camera.yaml")
    asked = ("import", tmp_path / "camera.yaml", "--output", tmp_path / "other.yaml")
    assert "leave out --name" in run(*asked, "--name", "cam1").sentence


def test_a_report_is_html(run: Run, kept_session: Path, tmp_path: Path) -> None:
    """Other names ended in a traceback, or were given to a file that is none of the kind."""
    for name in ("report.pdf", "report.txt"):
        sentence = run("report", kept_session, "--output", tmp_path / name).sentence
        assert "name it .html" in sentence
    assert not list(tmp_path.iterdir())
    assert run("report", kept_session, "--output", tmp_path / "new").code == 0
    assert (tmp_path / "new" / "report.html").is_file()


def test_a_folder_of_a_session_as_source_names_its_pictures(run: Run, kept_session: Path) -> None:
    for asked in (("undistort", kept_session, "--camera", kept_session), ("board", "--find")):
        sentence = run(*asked, *([kept_session] if asked[-1] == "--find" else [])).sentence
        assert f"there are some in {kept_session}/views: give that" in sentence


def test_a_folder_in_place_of_a_camera_file(run: Run, tmp_path: Path) -> None:
    """What is in it is what to give."""
    sentence = run("import", tmp_path).sentence
    assert "a folder with neither a result.json nor a camera.yaml" in sentence
    export_camera(PAPER_CAMERA, tmp_path / "camera.yaml")
    assert f"give its camera.yaml: {tmp_path}/camera.yaml." in run("import", tmp_path).sentence
    (tmp_path / "result.json").touch()
    assert f"result.json, which holds the covariance as well: {tmp_path}/result.json." in (
        run("import", tmp_path).sentence
    )


@pytest.mark.parametrize(
    "command",
    [
        "board --output -",
        "board --save -",
        "calibrate shots --output -",
        "export camera.json --to ros --output -",
        "import camera.json --output=-",
        "report shots --output -",
        "replay shots --export -",
        "teach --export -",
        "guide sim --headless --output -",
        "study flatness --output -",
    ],
)
def test_stdout_is_no_place_for_results(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    """A folder or a file of that name was made."""
    monkeypatch.chdir(tmp_path)
    assert "would write to stdout" in run(*command.split()).sentence
    assert not list(tmp_path.iterdir())


def test_camera_size_that_is_none(run: Run) -> None:
    assert run("guide", "--headless", "--camera-size", "big").sentence == (
        "A picture's size is WIDTHxHEIGHT, such as 1280x720, not 'big'."
    )


@pytest.mark.parametrize(("option", "value"), [("--host", "192.0.2.1"), ("--port", "99999")])
def test_address_that_cannot_be_bound(run: Run, tmp_path: Path, option: str, value: str) -> None:
    """viser would hang for ever on such an address; 192.0.2.1 is reserved for documentation. It is
    refused before a session is begun and said to be kept."""
    ran = run("guide", "sim", option, value, "--output", tmp_path / "session")
    assert value in ran.sentence
    assert "kept in" not in ran.err and not (tmp_path / "session").exists()


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--speed", "0"),
        ("--speed", "nan"),
        ("--speed", "inf"),
        ("--overlap", "2"),
        ("--overlap", "nan"),
        ("--seed", "-5"),
        ("--max-views", "1"),
        ("--camera-size", "1x1"),
        ("--camera-size", "100000x100000"),
        ("--limits.max-tilt-deg", "180"),
        ("--limits.max-tilt-deg", "nan"),
        ("--limits.nearest-mm", "-1"),
        ("--board.square-mm", "0"),
        ("--sim.bow-mm", "100"),
        ("--sim.view-bow-mm", "-1"),
        ("--sim.view-bias-px", "nan"),
        ("--sim.view-blur-px", "11"),
    ],
)
def test_numbers_that_cannot_be_met(run: Run, option: str, value: str) -> None:
    """Some of these ran without end, some ended in a traceback."""
    ran = run("guide", "sim", "--headless", "--autopilot", option, value)
    assert ran.code == 2 and ran.sentence.count("\n") == 0
    assert "must be" in ran.sentence or "is of no use" in ran.sentence


@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("guide", ("--autopilot",)),
        ("guide", ("--speed", "2")),
        ("guide", ("--sim.bow-mm", "3")),
        ("trial", ("--autopilot",)),
        ("trial", ("--speed", "2")),
    ],
)
def test_what_is_simulated_is_refused_beside_a_recording(
    run: Run, tmp_path: Path, command: str, option: tuple[str, ...]
) -> None:
    """It was ignored."""
    ran = run(command, tmp_path, *option)
    assert ran.code == 2 and option[0].split(".")[0] in ran.sentence and "leave" in ran.sentence


def test_a_board_is_a_picture_or_a_pdf(run: Run, tmp_path: Path) -> None:
    ran = run("board", "--output", tmp_path / "board.txt")
    assert ran.code == 2 and ".pdf, .svg or .png" in ran.sentence and not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (
            ["--method", "random", "--search", "annealing"],
            "The method random does not search, so the search annealing has no use there; leave it "
            "out or use the method venus or global.",
        ),
        (
            ["--method", "venus", "--cost", "rms", "--search", "dual-annealing"],
            "The cost rms calibrates anew for every pose and is too slow for the search "
            "dual-annealing; use it with the method venus and its own search, or use "
            "projection-variance.",
        ),
        (["--wanted-error", "0"], "--wanted-error must be from 0.001 to 100, not 0."),
    ],
)
def test_ways_to_the_next_pose_that_make_no_sense(
    run: Run, options: list[str], sentence: str
) -> None:
    assert run("guide", "sim", "--headless", *options).sentence == sentence


@pytest.mark.parametrize(
    "arguments",
    [
        ("teach", "{pipe}.toml", "--export", "{folder}/lesson.html"),
        ("board", "--board", "{pipe}.toml", "--output", "{folder}/board.pdf"),
        ("export", "{pipe}.yaml", "--to", "ros", "--output", "{folder}/camera.ros.yaml"),
        ("undistort", "{folder}", "--camera", "{pipe}.json", "--output", "{folder}/u"),
        ("calibrate", "{folder}"),
        ("report", "{pipe}.json"),
    ],
)
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
def test_a_pipe_in_place_of_a_file_is_not_waited_for(
    tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    for suffix in (".toml", ".yaml", ".json", ".png"):
        os.mkfifo(tmp_path / f"pipe{suffix}")
    asked = [one.format(pipe=tmp_path / "pipe", folder=tmp_path) for one in arguments]
    ran = subprocess.run(
        [sys.executable, "-m", "venus3d", *asked], capture_output=True, text=True, timeout=60
    )
    assert ran.returncode == 2 and "not a regular file" in ran.stderr.lower(), ran.stderr
    assert "Traceback" not in ran.stderr
