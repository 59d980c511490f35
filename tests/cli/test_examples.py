"""The examples run as they stand, stay short, and need nothing but the public names."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import venus3d
from venus3d.engine.geometry.pose import Pose

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def ran(name: str, *arguments: str) -> str:
    """What the example printed."""
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


def uncertainties(out: str) -> list[float]:
    """The figures after the word, in pixels."""
    return [float(number) for number in re.findall(r"uncertainty (\d+\.\d+) px", out)]


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_example_is_short_and_uses_the_public_names(path: Path) -> None:
    assert len(path.read_text().splitlines()) < 45
    tree = ast.parse(path.read_text())
    imported = {
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
    }
    froms = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert "venus3d" in imported
    assert not [name for name in {*imported, *froms} if name.startswith("venus3d.")]


def test_calibrate_a_folder_and_undistort_a_picture(tilted_pictures: Path, tmp_path: Path) -> None:
    out = ran("01_calibrate_a_folder.py", str(tilted_pictures), str(tmp_path))
    fx = next(line for line in out.splitlines() if line.startswith("fx = "))
    assert float(fx.split()[2]) == pytest.approx(1068, abs=3)
    assert venus3d.read_camera_yaml(tmp_path / "camera.yaml").fx == pytest.approx(1068, abs=3)

    picture = next(path for path in sorted(tilted_pictures.iterdir()) if path.suffix == ".png")
    straight = tmp_path / "straight.png"
    read = ran(
        "06_undistort_a_picture.py", str(tmp_path / "result.json"), str(picture), str(straight)
    )
    assert uncertainties(read) == uncertainties(out)
    before, after = cv2.imread(str(picture)), cv2.imread(str(straight))
    assert before is not None and after is not None and before.shape == after.shape
    assert np.mean(cv2.absdiff(before, after)) > 0.1


def test_a_fisheyes_picture_is_undistorted(tmp_path: Path) -> None:
    board = venus3d.Board()
    lens = venus3d.LENSES["equidistant"]
    camera = venus3d.Camera(640, 480, 250, 250, 320, 240, lens=lens)
    turns = ([40, 0, 0], [-40, 0, 0], [0, 40, 0], [0, -40, 0], [20, 20, 30], [0, 0, 0])
    poses = [Pose.from_vector([*turn, 0.03, -0.02, 0.13]) for turn in turns]
    noise = np.random.default_rng(0).normal(0, 0.05, (len(poses), board.corner_count, 2))
    views = []
    for pose, moved in zip(poses, noise, strict=True):
        pixels = camera.project(pose.apply(board.corners)) + moved
        ids = np.flatnonzero(((pixels > 0) & (pixels < [639, 479])).all(axis=1))
        views.append(venus3d.Observation(ids, pixels[ids], camera.image_size))
    calibration = venus3d.calibrate(views, board)
    assert not calibration.camera.lens.is_perspective
    # The printed value is for a person to read: some lines, not every corner of every view.
    assert len(str(calibration)) + len(str(calibration.views[0])) < 2000

    # A straight edge in front of the lens, black to the left of x = 0.4 z.
    pixels = np.stack(np.meshgrid(np.arange(640), np.arange(480)), axis=-1)
    rays = camera.unproject(pixels)
    picture = np.where(rays[..., 0] > 0.4 * rays[..., 2], 255, 0).astype(np.uint8)
    cv2.imwrite(str(tmp_path / "bent.png"), picture)
    venus3d.write_result(tmp_path / "result.json", calibration)
    straight = tmp_path / "straight.png"
    ran(
        "06_undistort_a_picture.py",
        str(tmp_path / "result.json"),
        str(tmp_path / "bent.png"),
        str(straight),
    )
    after = cv2.imread(str(straight), cv2.IMREAD_GRAYSCALE)
    assert after is not None
    edges = np.argmax(after[20:460] > 127, axis=1)
    np.testing.assert_allclose(edges, 320 + 0.4 * 250, atol=2.5)


def test_suggest_the_next_pose() -> None:
    out = ran("02_suggest_the_next_pose.py")
    first, second, third = uncertainties(out)
    assert third < second < first


def test_decompose_a_pose() -> None:
    out = ran("03_decompose_a_pose.py")
    assert "2. Tilt the top edge towards the camera by 25°." in out
    target = Pose.from_vector([25, -30, 20, 0, 0, 1])
    own = Pose.from_vector([25, -30, 20, 0, 0, 1], axes="own")
    assert f"{target.angle_to_deg(own):.1f}° away" in out


@pytest.mark.slow
def test_show_your_calibration() -> None:
    """No browser need be open."""
    assert "http://" in ran("04_show_your_calibration.py", "3")


@pytest.mark.slow
def test_guide_your_own_camera() -> None:
    out = ran("05_guide_your_own_camera.py", "2", "--no-window")
    assert "http://" in out and "finished after 2 views" in out
