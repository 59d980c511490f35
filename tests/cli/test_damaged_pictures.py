"""Pictures that cannot be read are no reason to lose the others: every command leaves them out and
names them."""

from __future__ import annotations

import json
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path

import cv2
import pytest

import venus3d
from tests.cli.conftest import Ran

Run = Callable[..., Ran]
SAID = (
    "3 files cannot be read and are left out: 00.jpg (empty), 03.jpg (breaks off early) and 99.jpg "
    "(not an image); copy them again or remove them."
)


@pytest.fixture
def shots(tilted_pictures: Path, tmp_path: Path) -> Path:
    """Six good pictures and three that cannot be read, one of which begins well."""
    folder = shutil.copytree(tilted_pictures, tmp_path / "shots")
    picture = cv2.imread(str(folder / "03.png"))
    assert picture is not None
    jpeg = cv2.imencode(".jpg", picture)[1].tobytes()
    (folder / "00.jpg").touch()
    (folder / "03.jpg").write_bytes(jpeg[: len(jpeg) // 2])
    (folder / "99.jpg").write_text("no picture")
    return folder


def test_calibrate_names_them_in_all_it_writes(run: Run, shots: Path, tmp_path: Path) -> None:
    """It was refused with one sentence about the first of them."""
    ran = run("calibrate", shots, "--output", tmp_path / "out")
    assert ran.code == 0 and SAID in ran.out + ran.err
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert SAID in result["warnings"] and result["views"] == 6
    assert run("report", tmp_path / "out").code == 0
    assert SAID in (tmp_path / "out" / "report.html").read_text()
    again = run("verify", tmp_path / "out", shots, "--output", tmp_path / "verified")
    assert again.code in (0, 3) and SAID in again.err
    told = json.loads((tmp_path / "verified" / "verification.json").read_text())
    assert SAID in told["warnings"]
    assert SAID in (tmp_path / "verified" / "verification.html").read_text()


def test_undistort_writes_the_others_and_says_so(run: Run, shots: Path, tmp_path: Path) -> None:
    """Its exit code too, as pictures are missing; without them it is 0."""
    assert run("calibrate", shots, "--output", tmp_path / "out").code == 0
    asked = ("undistort", shots, "--camera", tmp_path / "out", "--output", tmp_path / "straight")
    ran = run(*asked)
    assert ran.code == 1 and SAID in ran.err and "Written: 6 pictures" in ran.out
    assert len(list((tmp_path / "straight").glob("*.png"))) == 6
    for path in shots.glob("*.jpg"):
        path.unlink()
    assert run(*asked).code == 0


def test_board_find_and_guide_go_on(run: Run, shots: Path, tmp_path: Path) -> None:
    found = run("board", "--find", shots)
    assert found.code == 0 and "in 6 of 6 pictures" in found.out and SAID in found.err
    asked = ("guide", shots, "--headless", "--method", "random", "--max-views", 6)
    ran = run(*asked, "--output", tmp_path / "session", "--json")
    assert ran.code == 0 and ran.json["views"] >= 3
    assert any("00.jpg (empty)" in warning for warning in ran.json["warnings"])


def test_guide_names_them_when_it_finds_them(run: Run, shots: Path, tmp_path: Path) -> None:
    """Not only at its end: whoever reads it then can still copy them again."""
    asked = ("guide", shots, "--headless", "--method", "random", "--output", tmp_path / "out")
    ran = run(*asked, "--max-views", 6)
    assert ran.code == 0
    lines = [line.strip() for line in ran.err.splitlines()]
    assert lines.index(SAID) < next(i for i, line in enumerate(lines) if "View 4" in line)


def test_the_library_warns(shots: Path) -> None:
    with pytest.warns(UserWarning, match=r"00\.jpg \(empty\), 03\.jpg"):
        calibration = venus3d.calibrate(str(shots), venus3d.Board())
    assert len(calibration.views) == 6
    for path in shots.glob("*.jpg"):
        path.unlink()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(venus3d.calibrate(str(shots), venus3d.Board()).views) == 6


def test_a_picture_that_is_named_alone_is_refused(run: Run, shots: Path) -> None:
    assert run("calibrate", shots / "03.jpg").sentence == (
        f"The image {shots / '03.jpg'} breaks off early; copy it again or remove it."
    )
    for path in shots.glob("*.png"):
        path.unlink()
    assert run("calibrate", shots).sentence == (
        f"The file {shots / '00.jpg'} is empty; record or copy it again."
    )
