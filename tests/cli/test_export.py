"""`venus3d export` and `venus3d import`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.cli.conftest import Ran
from venus3d.engine.geometry.camera import PAPER_CAMERA as CAMERA
from venus3d.storage.formats import CameraRecord, export_camera, import_camera

Run = Callable[..., Ran]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """As `calibrate` leaves it, without the views."""
    record = CameraRecord(CAMERA, covariance=np.eye(9), sigma=np.ones(9), rms_px=0.2)
    export_camera(record, tmp_path / "result.json")
    return tmp_path


def test_a_folder_is_exported_and_read_back(run: Run, folder: Path) -> None:
    ran = run("export", folder, "--to", "colmap", "--output", folder / "cameras.txt")
    assert ran.code == 0, ran.err
    assert "no place for the covariance" in ran.out + ran.err
    ran = run("import", folder / "cameras.txt", "--output", folder / "back" / "camera.yaml")
    assert ran.code == 0 and "1280 x 720 px" in ran.out, ran.err
    back = import_camera(folder / "back" / "camera.yaml").camera
    np.testing.assert_allclose(back.parameters, CAMERA.parameters, atol=1e-12)


def test_the_name_tells_the_format(run: Run, folder: Path) -> None:
    assert run("export", folder, "--output", folder / "a.cameramodel").code == 0
    assert "LENSMODEL_OPENCV5" in (folder / "a.cameramodel").read_text()
    ran = run("export", folder, "--output", folder / "a.yaml")
    assert ran.code == 2 and "--to: opencv-yaml" in ran.err


def test_another_size(run: Run, folder: Path) -> None:
    to = ("--to", "json", "--output", folder / "small.json", "--size")
    ran = run("export", folder, *to, "640x480")
    assert ran.code == 2 and "--by crop" in ran.err and not (folder / "small.json").exists()
    assert run("export", folder, *to, "640x480", "--by", "crop", "--offset", "10,20").code == 0
    assert import_camera(folder / "small.json").camera.cx == CAMERA.cx - 10
    to = ("--to", "json", "--output", folder / "smaller.json", "--size")
    ran = run("export", folder, *to, "640x360")
    assert ran.code == 0 and "same field of view" in ran.out + ran.err
    small = import_camera(folder / "smaller.json")
    assert small.covariance is not None and small.covariance[0, 0] == 0.25
    assert small.covariance[4, 4] == 1 and small.rms_px is None
    assert small.camera == CAMERA.scaled((640, 360))


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--to", "kalibr"], "--without-k3"),
        (["--to", "blender"], "--undistorted"),
        (["--to", "words"], "There is no format 'words'"),
        (["--to", "ros", "--by", "crop"], "go with --size"),
        (["--to", "ros", "--size", "640x480", "--by", "crop", "--offset", "left"], "X,Y"),
    ],
)
def test_mistakes_are_one_sentence(run: Run, folder: Path, arguments: list[str], told: str) -> None:
    ran = run("export", folder, *arguments)
    assert ran.code == 2 and told in ran.err and len(ran.err.strip().splitlines()) == 1


def test_what_is_approximated_is_told(run: Run, folder: Path) -> None:
    ran = run("export", folder, "--without-k3", "--output", folder / "camchain.yaml")
    assert ran.code == 0 and "px off" in ran.out + ran.err
    ran = run("export", folder, "--to", "unity", "--undistorted", "--output", folder / "u.json")
    assert ran.code == 0 and "undistorted to this camera" in ran.out + ran.err
    flat = replace(CAMERA, k1=0, k2=0, p1=0, p2=0, k3=0)
    read = import_camera(folder / "u.json").camera
    np.testing.assert_allclose(read.parameters, flat.parameters, atol=1e-9)


def test_the_source_is_not_overwritten(run: Run, folder: Path) -> None:
    before = (folder / "result.json").read_bytes()
    ran = run("export", folder / "result.json", "--to", "json", "--output", folder / "result.json")
    assert ran.code == 2 and "is the source itself" in ran.err
    assert (folder / "result.json").read_bytes() == before
