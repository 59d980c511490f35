"""What is printed: safe to show, and no traceback where nobody can read it."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from shutil import copytree

import pytest

from tests.cli.conftest import Ran
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.storage.formats import export_camera

Run = Callable[..., Ran]
FULL = Path("/dev/full")


def ended(redirected: str, *arguments: object) -> tuple[int, str]:
    """Exit code and stderr of a program whose streams a shell redirects."""
    command = ["sh", "-c", f'exec "$0" -m venus3d "$@" {redirected}', sys.executable]
    ran = subprocess.run(
        [*command, *map(str, arguments)], stderr=subprocess.PIPE, stdin=subprocess.DEVNULL
    )
    return ran.returncode, ran.stderr.decode()


def test_a_closed_stdout_changes_nothing_else(tilted_pictures: Path, tmp_path: Path) -> None:
    code, err = ended(">&-", "calibrate", tilted_pictures, "--output", tmp_path / "k")
    assert code == 0 and "Traceback" not in err and "Error" not in err
    assert (tmp_path / "k" / "result.json").is_file()
    code, err = ended(">&-", "calibrate", tmp_path / "nothing")
    assert code == 2 and err.startswith("venus3d: There is no file")
    assert ended(">&-", "--help") == (0, "")
    assert ended(">&- 2>&-", "calibrate", tmp_path / "nothing") == (2, "")


@pytest.mark.skipif(not FULL.exists(), reason="needs a disk that is always full")
def test_a_full_disk_under_stdout_is_one_sentence(tilted_pictures: Path, tmp_path: Path) -> None:
    """The files are written, also those after which something is printed."""
    camera = export_camera(PAPER_CAMERA, tmp_path / "camera.yaml")
    asked: dict[str, tuple[object, ...]] = {
        "k/result.json": ("calibrate", tilted_pictures, "--output", tmp_path / "k"),
        "u/camera.yaml": (
            *("undistort", tilted_pictures, "--camera", camera),
            *("--output", tmp_path / "u"),
        ),
    }
    for written, arguments in asked.items():
        code, err = ended(f"> {FULL}", *arguments)
        assert code == 2 and (tmp_path / written).is_file()
        assert err.splitlines()[-1].startswith(
            "venus3d: What the command prints could not be written: No space left on device;"
        )
        assert "Traceback" not in err and "ignored" not in err
    code, err = ended(f"> {FULL}", "--help")
    assert code == 2 and len(err.splitlines()) == 1
    assert ended(f"> {FULL} 2> {FULL}", *asked["k/result.json"])[0] == 2


def test_the_names_of_files_move_no_cursor(run: Run, tilted_pictures: Path, tmp_path: Path) -> None:
    pictures = Path(copytree(tilted_pictures, tmp_path / "p"))
    (pictures / "01.png").rename(pictures / "v\x1b[2J\x9b.png")
    output = tmp_path / "o\x1b[1m"
    camera = export_camera(PAPER_CAMERA, tmp_path / "camera.yaml")
    asked: list[tuple[object, ...]] = [
        ("calibrate", pictures, "--output", output, "--json"),
        ("report", output),
        ("undistort", pictures, "--camera", camera, "--output", output / "u"),
        ("export", output, "--to", "ros", "--output", output / "ros.yaml"),
        ("verify", output, pictures, "--output", output, "--json"),
        ("board", "--output", output / "board.pdf"),
    ]
    for arguments in asked:
        ran = run(*arguments)
        assert ran.code in (0, 1, 3), ran.err
        assert not {"\x1b", "\x9b"} & {*ran.out, *ran.err} and r"o\x1b[1m" in ran.out
        if "--json" in arguments:
            assert ran.json
        if arguments[0] == "calibrate":
            names = [one.split("  ")[0] for one in ran.out.splitlines() if ".png" in one]
            assert r"v\x1b[2J\x9b.png" in names
