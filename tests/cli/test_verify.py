"""`venus3d verify` and `venus3d report`: what they print, write and answer to mistakes."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import get_args

import cv2
import numpy as np
import pytest

from tests.cli.conftest import Ran
from venus3d.cli import main
from venus3d.engine.calibration.calibration import LeftOut, LeftOutReason
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.report.calibration_report import ReportInput, calibration_report
from venus3d.storage.formats import export_camera
from venus3d.storage.result_reader import read_result

Run = Callable[..., Ran]


class Page(HTMLParser):
    """Text and sources of a document; fails on a tag that is not closed."""

    def __init__(self, content: str) -> None:
        super().__init__()
        self.text, self.sources, self._open = "", [], []
        self.feed(content)
        assert not self._open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.sources += [value for name, value in attrs if name in ("src", "href") and value]
        assert tag != "script"
        if tag not in ("meta", "img"):
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def calibrated(tilted_pictures: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a calibration of the six pictures."""
    folder = tmp_path_factory.mktemp("calibrated")
    assert main(["calibrate", str(tilted_pictures), "--output", str(folder)]) == 0
    return folder


def test_the_same_pictures_show_no_change(
    run: Run, calibrated: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    ran = run("verify", calibrated, tilted_pictures, "--limit", 20, "--output", tmp_path, "--json")
    assert ran.code == 0, ran.err
    assert "It still holds" in ran.out and "by chance in 1 of 100 checks" in ran.out
    assert "6 of the 6 views are of the calibration itself" in ran.out
    fresh = run("verify", calibrated / "camera.yaml", tilted_pictures, "--limit", 20)
    assert "calibration itself" not in fresh.out, (
        "a camera.yaml does not tell which pictures it is from"
    )
    assert ran.json["verdict"] == "good" and ran.json["projection_diff_px"] < 1e-6
    written = json.loads((tmp_path / "verification.json").read_text())
    assert written == ran.json
    page = Page((tmp_path / "verification.html").read_text())
    assert "It still holds" in page.text
    assert page.sources and all(source.startswith("data:image/") for source in page.sources)


def test_followed_corners_are_of_the_calibration_itself_and_new_noise_is_not(
    run: Run, calibrated: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    """In a session corners are followed from picture to picture, and a few lie elsewhere than in
    the picture by itself. Of a still board that is taken again, all do."""
    result = json.loads((calibrated / "result.json").read_text())
    for view in result["captured"]:
        view["corners_px"][3][0] += 0.2
    (tmp_path / "result.json").write_text(json.dumps(result))
    ran = run("verify", tmp_path / "result.json", tilted_pictures, "--limit", 20)
    assert "6 of the 6 views are of the calibration itself" in ran.out
    rng = np.random.default_rng(0)
    for file in sorted(tilted_pictures.glob("*.png")):
        picture = cv2.imread(str(file))
        noisy = np.clip(picture + rng.normal(0, 2, picture.shape), 0, 255).astype(np.uint8)
        cv2.imwrite(str(tmp_path / file.name), noisy)
    again = run("verify", tmp_path / "result.json", tmp_path, "--limit", 20)
    assert "differ by" in again.out and "calibration itself" not in again.out


def test_a_file_without_uncertainty_and_a_changed_camera(
    run: Run, tilted_pictures: Path, tmp_path: Path
) -> None:
    changed = replace(PAPER_CAMERA, fx=1068 * 1.2, fy=1073 * 1.2)
    export_camera(changed, tmp_path / "camera.yaml")
    ran = run("verify", tmp_path / "camera.yaml", tilted_pictures)
    assert ran.code == 1, ran.err
    assert "Not this camera as it was calibrated" in ran.out
    assert "camera.yaml does not hold the covariance of its camera" in ran.out
    assert re.search(r"fx +1281\.60 px +10\d\d\.\d\d px +−\d+\.\d σ  changed", ran.out), ran.out


def test_views_that_cannot_tell_say_so(run: Run, calibrated: Path, tilted_pictures: Path) -> None:
    ran = run("verify", calibrated, tilted_pictures, "--limit", 0.001)
    assert ran.code == 3
    assert "These views cannot tell" in ran.out and "Take more views" in ran.out


def test_mistakes_end_in_a_sentence(
    run: Run, calibrated: Path, tilted_pictures: Path, tmp_path: Path
) -> None:
    assert "--limit" in run("verify", calibrated, tilted_pictures, "--limit", 0).sentence
    assert "nothing" in run("verify", tmp_path / "nothing", tilted_pictures).sentence
    export_camera(PAPER_CAMERA.scaled((640, 360)), tmp_path / "half.yaml", "opencv-yaml")
    assert "640 x 360" in run("verify", tmp_path / "half.yaml", tilted_pictures).sentence
    assert "result.json" in run("report", tmp_path).sentence


def test_a_report_says_what_the_result_holds(run: Run, calibrated: Path, tmp_path: Path) -> None:
    ran = run("report", calibrated, "--output", tmp_path / "a" / "report.html")
    assert ran.code == 0, ran.err
    page = Page((tmp_path / "a" / "report.html").read_text())
    calibration = read_result(calibrated / "result.json").calibration
    for index in range(4):
        assert f"{calibration.camera.parameters[index]:.2f} px" in page.text
        assert f"± {calibration.sigma[index]:.2f} px" in page.text
    assert all(f"{view.rms_px:.3f} px" in page.text for view in calibration.views)
    assert all(source.startswith("data:image/") for source in page.sources)
    # The lines to copy are this camera's.
    lines = page.text[page.text.index("K = np.array") : page.text.index("undistorted = cv2")]
    names: dict[str, np.ndarray] = {}
    exec("import numpy as np\n" + lines, names)
    np.testing.assert_allclose(names["K"], calibration.camera.K, rtol=1e-8)
    np.testing.assert_allclose(names["distortion"], calibration.camera.distortion, rtol=1e-8)


@pytest.mark.parametrize(
    ("turn", "code", "told"),
    [
        (cv2.ROTATE_180, 1, "turned by 180° against those of the calibration: turned back"),
        (cv2.ROTATE_90_CLOCKWISE, 2, "they were turned by a quarter: turn them back"),
    ],
)
def test_real_pictures_turned_since_are_named(
    run: Run, shared_data: Path, tmp_path: Path, turn: int, code: int, told: str
) -> None:
    """It was said that the camera no longer holds, and to look for a loose lens."""
    pictures = shared_data / "checkerboard-9x6"
    board = ("--board.kind", "chessboard", "--board.columns", 10, "--board.rows", 7)
    assert run("calibrate", pictures, *board, "--output", tmp_path / "known").code == 0
    for path in pictures.glob("*.jpg"):
        picture = cv2.rotate(cv2.imread(str(path)), turn)
        cv2.imwrite(str(tmp_path / f"{path.stem}.png"), picture)
    ran = run("verify", tmp_path / "known", tmp_path, *board)
    assert ran.code == code and told in ran.out + ran.err, ran


@pytest.mark.parametrize("reason", get_args(LeftOutReason))
def test_a_report_names_what_was_left_out_and_why(calibrated: Path, reason: LeftOutReason) -> None:
    calibration = read_result(calibrated / "result.json").calibration
    seen = replace(calibration.views[0].observation, name="<b>again&.png")
    gone = replace(calibration, left_out=(LeftOut(7, seen, reason),))
    page = Page(calibration_report(ReportInput(gone)))
    assert re.search(r"View 7 \(<b>again&\.png\) is left out: it[^.]{10}", page.text)


def test_a_sessions_report_shows_its_pictures_and_how_it_was_made(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "session"
    ran = run("guide", "sim", "--headless", "--seed", 3, "--max-views", 4, "--output", folder)
    assert ran.code == 0, ran.err
    assert run("report", folder).code == 0
    page = Page((folder / "report.html").read_text())
    photographs = [s for s in page.sources if s.startswith("data:image/jpeg")]
    assert len(photographs) == len(read_result(folder / "result.json").calibration.views)
    assert "seed3" in page.text and "opencv-contrib-python-headless" in page.text
    assert "None" not in page.text.replace("None was found", "")
