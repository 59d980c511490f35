"""`venus3d undistort`: the pictures are where the camera file beside them says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.cli.conftest import Ran
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.undistortion import Undistortion
from venus3d.storage.formats import export_camera, import_camera

Run = Callable[..., Ran]
CAMERA = replace(PAPER_CAMERA.scaled((320, 180)), k1=-0.25, k2=0.05, k3=0.0)
POINTS = np.array([[-0.4, -0.2, 1.0], [0.3, 0.15, 1.0], [0.35, -0.2, 1.0], [0.0, 0.1, 1.0]])


def spots(camera_pixels: NDArray[np.float64], depth: int = 8) -> NDArray[np.uint8]:
    v, u = np.indices((180, 320))
    picture = sum(np.exp(-((u - x) ** 2 + (v - y) ** 2) / (2 * 2.5**2)) for x, y in camera_pixels)
    return (picture * (200 if depth == 8 else 50_000)).astype(f"uint{depth}")


def places(picture: NDArray[np.uint8], near: NDArray[np.float64]) -> NDArray[np.float64]:
    found = []
    for x, y in near:
        v, u = np.indices(picture.shape[:2])
        weight = picture.astype(float) * ((u - x) ** 2 + (v - y) ** 2 < 12**2)
        found.append([(u * weight).sum() / weight.sum(), (v * weight).sum() / weight.sum()])
    return np.array(found)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    export_camera(CAMERA, tmp_path / "camera.yaml")
    shots = tmp_path / "shots"
    shots.mkdir()
    cv2.imwrite(str(shots / "a.png"), spots(CAMERA.project(POINTS)))
    cv2.imwrite(str(shots / "b.tif"), spots(CAMERA.project(POINTS), 16))
    return tmp_path


@pytest.mark.parametrize("alpha", [None, 0, 1])
def test_points_are_where_the_new_camera_projects_them(
    run: Run, folder: Path, alpha: float | None
) -> None:
    given = [] if alpha is None else ["--alpha", alpha]
    out = folder / "out"
    ran = run("undistort", folder / "shots", "--camera", folder, "--output", out, *given)
    assert ran.code == 0 and "2 pictures" in ran.out, ran.err
    camera = import_camera(out / "camera.yaml").camera
    assert not camera.distortion.any()
    expected = camera.project(POINTS)
    inside = ((expected > 8) & (expected < [311, 171])).all(axis=1)
    assert inside.sum() >= 2
    for name, kind in (("a.png", np.uint8), ("b.png", np.uint16)):
        picture = cv2.imread(str(out / name), cv2.IMREAD_UNCHANGED)
        assert picture.dtype == kind and picture.shape[:2] == (180, 320)
        np.testing.assert_allclose(places(picture, expected[inside]), expected[inside], atol=0.15)


def test_it_is_opencvs() -> None:
    picture = np.random.default_rng(0).integers(0, 255, (180, 320, 3), dtype=np.uint8)
    smooth = cv2.GaussianBlur(picture, (0, 0), 3)
    theirs = cv2.undistort(smooth, CAMERA.K, CAMERA.distortion)
    difference = np.abs(Undistortion(CAMERA)(smooth).astype(int) - theirs)[2:-2, 2:-2]
    assert difference.max() <= 3 and difference.mean() < 0.2


def test_nothing_is_shown_twice_where_the_model_folds_back() -> None:
    camera = replace(CAMERA, k1=-0.9, k2=0.0)
    bright = np.full((180, 320), 255, np.uint8)
    undistortion = Undistortion(camera, alpha=None)
    v, u = np.indices((180, 320))
    x, y = (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy
    beyond = np.hypot(x, y) > camera.radius_limit
    assert not beyond.any() or not undistortion(bright)[beyond].any()
    wide = replace(camera, fx=120.0, fy=120.0)
    x, y = (u - wide.cx) / wide.fx, (v - wide.cy) / wide.fy
    beyond = np.hypot(x, y) > wide.radius_limit
    assert beyond.any() and not Undistortion(wide)(bright)[beyond].any()


def test_a_video_keeps_its_frames_and_times(run: Run, folder: Path) -> None:
    video = folder / "clip.avi"
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter.fourcc(*"MJPG"), 10, (320, 180))
    for _ in range(7):
        writer.write(cv2.cvtColor(spots(CAMERA.project(POINTS)), cv2.COLOR_GRAY2BGR))
    writer.release()
    out = folder / "out"
    ran = run("undistort", video, "--camera", folder / "camera.yaml", "--output", out)
    assert ran.code == 0, ran.err
    read = cv2.VideoCapture(str(out / "clip.mp4"))
    times, picture = [], None
    while True:
        good, image = read.read()
        if not good:
            break
        times.append(read.get(cv2.CAP_PROP_POS_MSEC))
        picture = image
    np.testing.assert_allclose(times, np.arange(7) * 100, atol=2)
    assert picture is not None
    expected = CAMERA.without_distortion().project(POINTS[1:2])
    np.testing.assert_allclose(places(picture[..., 1], expected), expected, atol=0.3)
    assert sorted(path.name for path in out.iterdir()) == ["camera.yaml", "clip.mp4"]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--alpha", "2"], "alpha is from 0 to 1"),
        (["--output", "shots"], "among their sources"),
    ],
)
def test_mistakes(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], told: str
) -> None:
    monkeypatch.chdir(folder)
    ran = run("undistort", "shots", "--camera", "camera.yaml", *arguments)
    assert ran.code == 2 and told in ran.err
    assert not (folder / "undistorted").exists()


def test_another_size_names_the_way_out(run: Run, folder: Path) -> None:
    export_camera(CAMERA.scaled((640, 360)), folder / "other" / "camera.yaml")
    out = folder / "out"
    ran = run("undistort", folder / "shots", "--camera", folder / "other", "--output", out)
    assert ran.code == 2 and "--size 320x180" in ran.err


def test_a_lens_model_that_folds_back_is_said(run: Run, folder: Path) -> None:
    """Black pictures were "Written" with exit code 0."""
    asked = ("undistort", folder / "shots", "--camera", folder, "--output", folder / "out")
    assert "folds back" not in run(*asked).err
    for k1, told in ((-0.6, "which is lost"), (-50.0, "nothing to see by")):
        camera = replace(CAMERA, coefficients=(k1, 0.0, 0.0, 0.0, 0.0))
        export_camera(camera, folder / f"{k1}.yaml", "opencv-yaml")
        ran = run(*asked[:3], folder / f"{k1}.yaml", "--output", folder / f"out{k1}")
        assert f"folds back within the picture (k1 = {k1:g}," in ran.err and told in ran.err
        assert ran.code == (0 if k1 == -0.6 else 2)
