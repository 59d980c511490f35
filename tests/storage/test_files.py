"""What is written can be read: by OpenCV, by every JSON reader, by a printer."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.guidance.convergence import Progress
from venus3d.engine.planning.forecast import Forecast
from venus3d.storage.camera_yaml import read_camera_yaml, write_camera_yaml
from venus3d.storage.folder import prepare, write_bytes
from venus3d.storage.result import summary_of
from venus3d.storage.result_folder import ResultFolder

PARAMETERS = PAPER_CAMERA.parameter_names


def test_opencv_reads_camera_yaml(
    tmp_path: Path, calibration: Calibration, default_board: Board
) -> None:
    path = write_camera_yaml(tmp_path / "camera.yaml", calibration)
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    np.testing.assert_array_equal(file.getNode("camera_matrix").mat(), calibration.camera.K)
    distortion = file.getNode("distortion_coefficients").mat()
    np.testing.assert_array_equal(distortion.ravel(), calibration.camera.distortion)
    assert file.getNode("image_width").real() == 1280
    assert file.getNode("image_height").real() == 720
    assert file.getNode("avg_reprojection_error").real() == calibration.rms_px
    assert file.getNode("aruco_dictionary").string() == "DICT_5X5_100"
    deviations = file.getNode("standard_deviations").mat()
    np.testing.assert_array_equal(deviations.ravel(), calibration.sigma)
    assert read_camera_yaml(path) == calibration.camera


def test_camera_yaml_of_opencvs_own_sample(tmp_path: Path) -> None:
    """Other tools write a column of distortion, and only four or five of it."""
    path = tmp_path / "other.yml"
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    file.write("image_width", 640)
    file.write("image_height", 480)
    file.write("camera_matrix", np.array([[500.0, 0, 320], [0, 510, 240], [0, 0, 1]]))
    file.write("distortion_coefficients", np.array([[0.1], [-0.2], [0.001], [0.002]]))
    file.release()
    assert read_camera_yaml(path) == Camera(
        640, 480, 500, 510, 320, 240, 0.1, -0.2, 0.001, 0.002, 0.0
    )


@pytest.mark.parametrize("text", ["", "hello", "%YAML:1.0\n---\na: 1\n", "{}", "\x00\x01"])
def test_file_without_a_camera(tmp_path: Path, text: str) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(StorageError, match="There is no camera in"):
        read_camera_yaml(path)
    with pytest.raises(StorageError, match="cannot be read"):
        read_camera_yaml(tmp_path / "absent.yaml")


def test_result_json(
    tmp_path: Path, calibration: Calibration, default_board: Board, paper_camera: Camera
) -> None:
    nothing = float("nan")
    history = (Progress(1, 0.3, np.ones(9), np.ones(9), nothing),)
    summary = summary_of(calibration, warnings=["w"], converged=True, truth=paper_camera)
    _, path = ResultFolder(tmp_path).write(calibration, summary, history)

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    result = json.loads(path.read_text(), parse_constant=refuse)
    assert list(result["intrinsics"]) == list(result["std"]) == list(PARAMETERS)
    assert result["views"] == 4 and result["converged"] is True and result["warnings"] == ["w"]
    assert result["board"]["square_mm"] == 28 and result["board"]["legacy"] is False
    assert result["history"][0]["uncertainty_px"] is None
    assert result["history"][0]["promised_uncertainty_px"] is None
    assert set(result["history"][0]["promised_std"].values()) == {None}
    assert "forecast" not in result
    assert result["projection_diff_px"] > 0
    # The file alone is enough to compute the errors anew, with OpenCV.
    camera = result["intrinsics"]
    K = np.array([[camera["fx"], 0, camera["cx"]], [0, camera["fy"], camera["cy"]], [0, 0, 1]])
    d = np.array([camera[name] for name in PARAMETERS[4:]])
    for view in result["captured"]:
        T = np.array(view["T_camera_board"])
        points = default_board.points_of(view["ids"])
        pixels, _ = cv2.projectPoints(points, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, d)
        errors = np.array(view["corners_px"]) - pixels.reshape(-1, 2)
        np.testing.assert_allclose(errors, view["errors_px"], atol=1e-6)


def test_folder_is_made_and_tried(tmp_path: Path) -> None:
    folder = prepare(tmp_path / "a" / "b")
    assert folder.is_dir() and not list(folder.iterdir())
    with pytest.raises(StorageError, match="Nothing can be written to /proc/venus3d"):
        prepare(Path("/proc/venus3d"))


def test_file_is_written_whole_or_not_at_all(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A full disk must leave the earlier result alone, and no rubbish beside it."""
    path = write_bytes(tmp_path / "result.json", b"first")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    with pytest.raises(StorageError, match="no space left on device"):
        write_bytes(path, b"second")
    assert path.read_bytes() == b"first" and list(tmp_path.iterdir()) == [path]


def test_promises_and_forecast_in_the_result(
    tmp_path: Path, calibration: Calibration, default_board: Board
) -> None:
    history = (
        Progress(3, 0.3, np.ones(9), np.ones(9), 0.62),
        Progress(4, 0.3, np.ones(9), np.ones(9), 0.43, np.full(9, 0.5), 0.41),
    )
    summary = summary_of(calibration, forecast=Forecast(0.3, 3, 2, None, 10))
    _, path = ResultFolder(tmp_path).write(calibration, summary, history)
    result = json.loads(path.read_text())
    assert result["forecast"] == {
        "wanted_uncertainty_px": 0.3,
        "views": 3,
        "low": 2,
        "high": None,
        "looked_ahead": 10,
    }
    before, last = result["history"]
    assert before["uncertainty_px"] == 0.62 and last["uncertainty_px"] == 0.43
    assert last["promised_uncertainty_px"] == 0.41 and last["promised_std"]["fx"] == 0.5
