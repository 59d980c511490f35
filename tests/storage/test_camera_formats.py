"""Camera files of other programs: each is read by the real one and projects the same points."""

from __future__ import annotations

import json
import subprocess
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml
from scipy.io import loadmat, savemat

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import lens_called
from venus3d.engine.geometry.pose import Array
from venus3d.storage.formats import FORMATS, CameraRecord, encode, export_camera, import_camera

ROOT = Path(__file__).resolve().parents[2]
CAMERA = Camera(1280, 720, 1068, 1073.5, 635.25, 355.5, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
POINTS = np.random.default_rng(5).uniform([-0.5, -0.3, 0.9], [0.5, 0.3, 2], (200, 3))
NARROW = {"kalibr": replace(CAMERA, k3=0.0)}
NARROW |= {name: CAMERA.without_distortion() for name in ("blender", "unity")}
"""Cameras for formats that hold fewer coefficients."""


def file_of(name: str, folder: Path, camera: Camera = CAMERA) -> Path:
    place = folder / FORMATS[name].file_name
    place.write_bytes(encode(CameraRecord(camera), FORMATS[name]).content)
    return place


def projected(K: Any, distortion: Any) -> Array:
    """By OpenCV, independent of our camera."""
    zero = np.zeros(3)
    matrix = np.array(K, dtype=np.float64).reshape(3, 3)
    return cv2.projectPoints(POINTS, zero, zero, matrix, np.array(distortion, float))[0][:, 0]


TRUE = projected(CAMERA.K, CAMERA.distortion)


@pytest.mark.parametrize("name", FORMATS)
def test_what_is_written_is_read_back(name: str, tmp_path: Path) -> None:
    camera = NARROW.get(name, CAMERA)
    record = import_camera(file_of(name, tmp_path, camera))
    assert record.camera.image_size == camera.image_size
    np.testing.assert_allclose(record.camera.project(POINTS), camera.project(POINTS), atol=1e-6)
    # Also under a name that tells nothing.
    other = tmp_path / "unnamed"
    other.write_bytes((tmp_path / FORMATS[name].file_name).read_bytes())
    np.testing.assert_allclose(import_camera(other).camera.parameters, record.camera.parameters)


@pytest.mark.parametrize("name", ["opencv-yaml", "opencv-json", "opencv-xml"])
def test_opencv_reads_ours(name: str, tmp_path: Path) -> None:
    file = cv2.FileStorage(str(file_of(name, tmp_path)), cv2.FILE_STORAGE_READ)
    K, distortion = (
        file.getNode(key).mat() for key in ("camera_matrix", "distortion_coefficients")
    )
    np.testing.assert_allclose(projected(K, distortion), TRUE, atol=1e-6)
    assert file.getNode("image_width").real() == 1280


def test_ros_finds_the_fields_of_the_message(tmp_path: Path) -> None:
    """As rtabmap's yaml_to_camera_info.py and camera_calibration_parsers fill CameraInfo."""
    found = yaml.safe_load(file_of("ros", tmp_path).read_text())
    assert found["distortion_model"] == "plumb_bob"
    for key, rows, columns in (
        ("camera_matrix", 3, 3),
        ("distortion_coefficients", 1, 5),
        ("rectification_matrix", 3, 3),
        ("projection_matrix", 3, 4),
    ):
        assert (found[key]["rows"], found[key]["cols"]) == (rows, columns)
        assert len(found[key]["data"]) == rows * columns
    K, D = found["camera_matrix"]["data"], found["distortion_coefficients"]["data"]
    np.testing.assert_allclose(projected(K, D), TRUE, atol=1e-6)
    P = np.reshape(found["projection_matrix"]["data"], (3, 4))
    assert np.array_equal(P[:, :3], CAMERA.K) and not P[:, 3].any()


def test_kalibr_finds_its_keys(tmp_path: Path) -> None:
    camera = NARROW["kalibr"]
    cam0 = yaml.safe_load(file_of("kalibr", tmp_path, camera).read_text())["cam0"]
    assert (cam0["camera_model"], cam0["distortion_model"]) == ("pinhole", "radtan")
    assert cam0["resolution"] == [1280, 720] and cam0["rostopic"]
    fx, fy, cx, cy = cam0["intrinsics"]
    K = [fx, 0, cx, 0, fy, cy, 0, 0, 1]
    expected = projected(camera.K, camera.distortion)
    np.testing.assert_allclose(projected(K, cam0["distortion_coeffs"]), expected, atol=1e-6)


@pytest.mark.parametrize("camera", [CAMERA, NARROW["kalibr"]], ids=["FULL_OPENCV", "OPENCV"])
def test_colmap_projects_the_same_points(tmp_path: Path, camera: Camera) -> None:
    """COLMAP's first pixel has its centre at (0.5, 0.5)."""
    pycolmap = pytest.importorskip("pycolmap", reason="pycolmap is not installed")
    place = file_of("colmap", tmp_path, camera)
    for empty in ("images.txt", "points3D.txt"):
        (place.parent / empty).write_text("")
    model = pycolmap.Reconstruction()
    model.read_text(str(place.parent))
    read = model.cameras[1]
    assert (read.width, read.height) == (1280, 720)
    pixels = np.array([read.img_from_cam(point) for point in POINTS]).reshape(-1, 2)
    np.testing.assert_allclose(
        pixels - 0.5, projected(camera.K, camera.distortion), rtol=0, atol=1e-6
    )


MRCAL = """
import sys, json, mrcal, numpy as np
model = mrcal.cameramodel(sys.argv[1])
points = np.array(json.load(sys.stdin))
pixels = mrcal.project(points, *model.intrinsics())
print(json.dumps([pixels.tolist(), model.imagersize().tolist()]))
"""


def test_mrcal_projects_the_same_points(tmp_path: Path) -> None:
    """Debian's python3-mrcal, in the system's Python."""
    system = Path("/usr/bin/python3")
    if (
        not system.exists()
        or subprocess.run(
            [system, "-c", "import mrcal"], capture_output=True, check=False
        ).returncode
    ):
        pytest.skip("mrcal is not installed (Debian: python3-mrcal)")
    record = CameraRecord(CAMERA, covariance=np.eye(9))
    place = tmp_path / "camera.cameramodel"
    place.write_bytes(encode(record, FORMATS["mrcal"]).content)
    done = subprocess.run(
        [system, "-c", MRCAL, place],
        input=json.dumps(POINTS.tolist()),
        capture_output=True,
        text=True,
        check=True,
        env={"PATH": "/usr/bin"},
    )
    pixels, size = json.loads(done.stdout)
    np.testing.assert_allclose(pixels, TRUE, rtol=0, atol=1e-6)
    assert size == [1280, 720]


def test_scipy_finds_what_matlab_takes(tmp_path: Path, calibration: Calibration) -> None:
    place = export_camera(calibration, tmp_path / "camera.mat")
    found = loadmat(place)
    pixels = projected(found["intrinsicMatrix"], found["distortionCoefficients"])
    camera = calibration.camera
    np.testing.assert_allclose(pixels, projected(camera.K, camera.distortion), atol=1e-6)
    assert found["imageSize"].tolist() == [[720, 1280]]
    np.testing.assert_allclose(found["covariance"], calibration.covariance)


def test_nerfstudio_counts_from_the_corner(tmp_path: Path) -> None:
    """Its ray of pixel (i, j) goes through (i + 0.5, j + 0.5)."""
    found = json.loads(file_of("nerfstudio", tmp_path).read_text())
    K = [found["fl_x"], 0, found["cx"] - 0.5, 0, found["fl_y"], found["cy"] - 0.5, 0, 0, 1]
    distortion = [found[key] for key in ("k1", "k2", "p1", "p2", "k3")]
    np.testing.assert_allclose(projected(K, distortion), TRUE, atol=1e-6)
    assert (found["w"], found["h"], found["camera_model"]) == (1280, 720, "OPENCV")


def test_blender_draws_the_same_pixels(tmp_path: Path) -> None:
    """By the view plane of BKE_camera_params_compute_viewplane at distance 1, y upwards."""
    camera = NARROW["blender"]
    b = json.loads(file_of("blender", tmp_path, camera).read_text())
    w, h, ycor = b["resolution_x"], b["resolution_y"], b["pixel_aspect_y"] / b["pixel_aspect_x"]
    assert min(b["pixel_aspect_x"], b["pixel_aspect_y"]) == 1
    pixel = b["sensor_width"] / w / b["lens"]
    left, bottom = -w / 2 + b["shift_x"] * w, -ycor * h / 2 + b["shift_y"] * w
    x, y = POINTS[:, 0] / POINTS[:, 2], -POINTS[:, 1] / POINTS[:, 2]
    from_left, from_bottom = x / pixel - left, (y / pixel - bottom) / ycor
    pixels = np.stack([from_left - 0.5, h - from_bottom - 0.5], axis=-1)
    np.testing.assert_allclose(pixels, camera.project(POINTS), atol=1e-6)
    assert b["angle_x"] == pytest.approx(np.radians(camera.fov_deg[0]))


def test_unity_draws_the_same_pixels(tmp_path: Path) -> None:
    """By the frustum of its physical camera: the sensor, moved by the lens shift."""
    camera = NARROW["unity"]
    u = json.loads(file_of("unity", tmp_path, camera).read_text())
    sensor = np.array([u["sensorSize"]["x"], u["sensorSize"]["y"]])
    shift = np.array([u["lensShift"]["x"], u["lensShift"]["y"]])
    on_sensor = POINTS[:, :2] * [1, -1] / POINTS[:, 2:] * u["focalLength"]
    part = on_sensor / sensor + 0.5 - shift  # of the picture, from the lower left
    pixels = np.stack([part[:, 0] * 1280 - 0.5, (1 - part[:, 1]) * 720 - 0.5], axis=-1)
    np.testing.assert_allclose(pixels, camera.project(POINTS), atol=1e-6)
    assert u["fieldOfView"] == pytest.approx(camera.fov_deg[1])


def test_json_keeps_covariance_and_board(tmp_path: Path, calibration: Calibration) -> None:
    record = import_camera(export_camera(calibration, tmp_path / "camera.json"))
    np.testing.assert_allclose(record.covariance, calibration.covariance)
    assert record.board == calibration.board and record.views == len(calibration.views)
    np.testing.assert_allclose(record.sigma, calibration.sigma)


def test_what_is_lost_is_said(tmp_path: Path, calibration: Calibration) -> None:
    with pytest.warns(UserWarning, match="no place for the covariance"):
        export_camera(calibration, tmp_path / "cameras.txt")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        export_camera(CAMERA, tmp_path / "cameras.txt")


@pytest.mark.parametrize(
    ("name", "told"),
    [("kalibr", "no k3.*--without-k3"), ("blender", "undistort"), ("unity", "--undistorted")],
)
def test_what_cannot_be_held_is_refused(name: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(StorageError, match=told):
        export_camera(CAMERA, tmp_path / "file", name)
    assert not (tmp_path / "file").exists()


def test_the_nearest_camera_without_k3_says_how_far_it_is_off(tmp_path: Path) -> None:
    place = tmp_path / "camchain.yaml"
    with pytest.warns(UserWarning, match="px off") as told:
        export_camera(CAMERA, place, without_k3=True)
    said = float(str(told[0].message).split("up to ")[1].split(" px")[0])
    near = import_camera(place).camera
    seen = CAMERA.project(POINTS)
    inside = ((seen >= 0) & (seen <= [1279, 719])).all(axis=1)
    off = np.linalg.norm(near.project(POINTS[inside]) - seen[inside], axis=1).max()
    # Dropping k3 alone would be far worse.
    alone = np.linalg.norm(
        replace(CAMERA, k3=0.0).project(POINTS[inside]) - seen[inside], axis=1
    ).max()
    assert off <= 1.05 * said and off < alone / 4


def test_one_camera_of_several(tmp_path: Path) -> None:
    chain = yaml.safe_load(file_of("kalibr", tmp_path, NARROW["kalibr"]).read_text())
    chain["cam1"] = {**chain["cam0"], "intrinsics": [500, 500, 640, 360]}
    place = tmp_path / "camchain.yaml"
    place.write_text(yaml.safe_dump(chain))
    with pytest.raises(StorageError, match="2 cameras; name one of them with --name: cam0, cam1"):
        import_camera(place)
    assert import_camera(place, name="cam1").camera.fx == 500


OTHERS: dict[str, tuple[str, list[float]]] = {
    "cameracalibrator of ROS": (
        """image_width: 640
image_height: 480
camera_name: rgb_Astra_Orbbec
camera_matrix:
  rows: 3
  cols: 3
  data: [526.6908, 0, 312.3333, 0, 525.7542, 246.2279, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0.01864, -0.08079, 6.7e-4, -1e-3, 0]
""",
        [526.6908, 525.7542, 312.3333, 246.2279, 0.01864, -0.08079, 6.7e-4, -1e-3, 0],
    ),
    "ros2 topic echo": (
        """header:
  frame_id: default_cam
height: 480
width: 640
distortion_model: rational_polynomial
d: [0.17, -0.69, -0.003, -0.005, 0.1, 0.0, 0.0, 0.0]
k: [500.0, 0.0, 320.5, 0.0, 501.0, 240.5, 0.0, 0.0, 1.0]
binning_x: 0
---
""",
        [500, 501, 320.5, 240.5, 0.17, -0.69, -0.003, -0.005, 0.1],
    ),
    "Kalibr's wiki, under OpenCV's first line": (
        """%YAML:1.0
cam0:
  cam_overlaps: []
  camera_model: pinhole
  intrinsics: [461.629, 460.152, 362.680, 246.049]
  distortion_model: radtan
  distortion_coeffs: [-0.27695497, 0.06712482, 0.00087538, 0.00011556]
  T_cam_imu:
  - [0.01779318, 0.99967549,-0.01822936, 0.07008565]
  timeshift_cam_imu: -8.121e-05
  rostopic: /cam0/image_raw
  resolution: [640, 480]
""",
        [461.629, 460.152, 362.68, 246.049, -0.27695497, 0.06712482, 0.00087538, 0.00011556, 0],
    ),
    "an old .cameramodel": (
        """# generated with ...
{ 'lens_model': 'LENSMODEL_OPENCV5',
  'intrinsics': [ 1761.18, 1761.25, 365.7, 287.5, -0.01266, 0.0359, -0.00025, 0.00052, 0.0196],
  'extrinsics': [ 0, 0, 0, -0, -0, -0,],
  'imagersize': [ 640, 480 ]
}
""",
        [1761.18, 1761.25, 365.7, 287.5, -0.01266, 0.0359, -0.00025, 0.00052, 0.0196],
    ),
    "COLMAP's SIMPLE_RADIAL": (
        "# Camera list\n7 SIMPLE_RADIAL 640 480 559.81 320 240 0.05\n",
        [559.81, 559.81, 319.5, 239.5, 0.05, 0, 0, 0, 0],
    ),
}
"""As other programs write them; the numbers are shortened."""


@pytest.mark.parametrize("case", OTHERS)
def test_files_of_others_are_read(case: str, tmp_path: Path) -> None:
    text, expected = OTHERS[case]
    place = tmp_path / "file"
    place.write_text(text)
    camera = import_camera(place).camera
    assert camera.image_size == (640, 480)
    np.testing.assert_allclose(camera.parameters, expected)


def opencv_yaml(**changes: str) -> bytes:
    text = encode(CameraRecord(CAMERA), FORMATS["opencv-yaml"]).content.decode()
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new)
    return text.encode()


LAUGHS = "a0: &a0 {x: 1}\n" + "".join(
    f"a{n + 1}: &a{n + 1} {{<<: [{', '.join([f'*a{n}'] * 10)}]}}\n" for n in range(20)
)
BAD: dict[str, tuple[bytes, str]] = {
    "nan": (opencv_yaml(a=("1068.", ".Nan")), "not finite"),
    "infinite": (opencv_yaml(a=("1068.", ".Inf")), "not finite"),
    "negative": (opencv_yaml(a=("1068.", "-1068.")), "must be positive"),
    "zero": (opencv_yaml(a=("1068.", "0.")), "must be positive"),
    "no size": (opencv_yaml(a=("image_width: 1280", "image_width: -5")), "no camera"),
    "huge": (opencv_yaml(a=("image_width: 1280", "image_width: 2000000000")), "no camera"),
    "skew": (b"1 PINHOLE 10 10 nan 5 5 5\n", "not finite"),
    "deep YAML": (b"%YAML:1.0\n---\na: !!opencv-matrix " + b"[" * 200_000, "no camera"),
    "deep JSON": (b'{"camera_matrix": {"type_id": "opencv-matrix", "a": ' + b"[" * 200_000,
                  "no camera"),
    "deep XML": (b'<?xml version="1.0"?><opencv_storage>' + b"<a>" * 100_000, "no camera"),
    "deep literal": (b"{'lensmodel': 'LENSMODEL_OPENCV5', 'imagersize': " + b"-" * 300_000,
                     "no camera"),
    "a call": (b"{'lensmodel': 'LENSMODEL_OPENCV5', 'imagersize': __import__('os')}", "no camera"),
    "a YAML object": (b"camera_matrix: !!python/object/apply:os.getcwd []\ndistortion_model: a\n",
                      "no camera"),
    "laughs": (LAUGHS.encode() + b"camera_matrix: 1\ndistortion_model: plumb_bob\n", "no camera"),
    "large YAML": (b"camera_matrix: 1\ndistortion_model: a\n" + b"#" * 2_000_000, "no camera"),
    "OpenCV without a size": (opencv_yaml(a=("image_width: 1280", "")), "width and the height"),
    "Kalibr without a size": (b"cam0: {camera_model: pinhole, distortion_model: radtan, "
                              b"intrinsics: [500, 500, 320, 240], "
                              b"distortion_coeffs: [0, 0, 0, 0]}", "width and the height"),
    "ROS without a size": (b"distortion_model: plumb_bob\nk: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n"
                           b"d: [0, 0, 0, 0, 0]\n", "width and the height"),
    "ROS's file without a size": (b"distortion_model: plumb_bob\n"
                                  b"camera_matrix: {data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n"
                                  b"distortion_coefficients: {data: [0, 0, 0, 0, 0]}\n",
                                  "width and the height"),
    "one id twice": (b"1 PINHOLE 10 10 5 5 5 5\n1 PINHOLE 10 10 6 6 5 5\n", "of one id"),
    "no camera's number": (b"1 PINHOLE 10 10 1e200 5 5 5\n", "1e.200 is no number of a camera"),
    "another fisheye": (b"1 THIN_PRISM_FISHEYE 10 10 5 5 5 5 0 0 0 0\n", "OPENCV"),
    "omni": (b"cam0: {camera_model: omni, distortion_model: radtan, resolution: "
                    b"[10, 10], intrinsics: [1, 1, 1, 1]}", "pinhole-radtan"),
    "no format": (b"hello", "name it with --format"),
    "nothing": (b"", "name it with --format"),
    "a pickle": (b"\x80\x04\x95", "name it with --format"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_ends_in_one_sentence(case: str, tmp_path: Path) -> None:
    """OpenCV's own parsers end the process at 200,000 brackets."""
    content, told = BAD[case]
    place = tmp_path / "file"
    place.write_bytes(content)
    with pytest.raises(StorageError, match=told) as caught:
        import_camera(place)
    assert "\n" not in str(caught.value)


def test_an_empty_mat_file_ends_in_one_sentence(tmp_path: Path) -> None:
    place = tmp_path / "camera.mat"
    place.write_bytes(bytes(500))
    with pytest.raises(StorageError, match="no camera"):
        import_camera(place)


def test_a_mat_file_of_complex_numbers_ends_in_one_sentence(tmp_path: Path) -> None:
    place = tmp_path / "camera.mat"
    K = np.array([[500 + 1j, 0, 320], [0, 500, 240], [0, 0, 1]])
    size, none = np.array([[480, 640]]), np.zeros((1, 5))
    savemat(place, {"intrinsicMatrix": K, "imageSize": size, "distortionCoefficients": none})
    with pytest.raises(StorageError, match="no camera"):
        import_camera(place)


def test_a_mat_file_unpacks_only_small_arrays(tmp_path: Path) -> None:
    place = tmp_path / "camera.mat"
    savemat(place, {"intrinsicMatrix": np.zeros((1500, 1500))}, do_compression=True)
    assert place.stat().st_size < 1_000_000
    with pytest.raises(StorageError, match="no camera"):
        import_camera(place)


WIDE = {
    "rational": Camera(
        *(1280, 720, 700, 705, 640, 355, 0.4, 0.05, 1e-3, -2e-3, 0.01, 0.7, 0.1, 0.005),
        lens=lens_called("rational"),
    ),
    "fisheye": Camera(
        1280, 720, 400, 405, 640, 355, 0.02, -0.01, 3e-3, -7e-4, lens=lens_called("fisheye")
    ),
}


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("lens", WIDE)
def test_other_lenses_come_back_or_are_refused(lens: str, name: str, tmp_path: Path) -> None:
    camera, target = WIDE[lens], FORMATS[name]
    place = tmp_path / target.file_name
    if lens not in target.lenses:
        with pytest.raises(StorageError, match=f"{lens}; export to .*opencv-yaml"):
            export_camera(camera, place, name)
        return
    covariance = np.diag(np.arange(1.0, 1 + len(camera.parameters)))
    record = CameraRecord(camera, covariance, np.sqrt(np.diag(covariance)))
    export_camera(record, place, name)
    back = import_camera(place)
    assert back.camera.lens == camera.lens
    np.testing.assert_allclose(back.camera.parameters, camera.parameters, rtol=1e-12)
    if target.keeps_sigma:
        assert back.sigma is not None
        np.testing.assert_allclose(back.sigma, record.sigma)


def test_a_simpler_lens_is_written_as_one_that_the_format_has() -> None:
    camera = Camera(640, 480, 500, 500, 320, 240, -0.2, 0.05, 0, 0, lens=lens_called("brown4"))
    sigma = np.arange(1.0, 9.0)
    held = encode(CameraRecord(camera, np.diag(sigma**2), sigma), FORMATS["opencv-yaml"])
    back = FORMATS["opencv-yaml"].read(held.content, None)
    assert back.camera == Camera(640, 480, 500, 500, 320, 240, -0.2, 0.05)
    assert back.sigma is not None and back.sigma.tolist() == [*sigma, 0.0]


def test_a_skew_is_refused(tmp_path: Path) -> None:
    content = yaml.safe_load(file_of("ros", tmp_path).read_text())
    content["camera_matrix"]["data"][1] = 3.0
    (tmp_path / "camera_info.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(StorageError, match="skew of 3 px"):
        import_camera(tmp_path / "camera_info.yaml")


def test_the_page_has_every_format() -> None:
    page = (ROOT / "docs" / "formats.md").read_text()
    assert [name for name in FORMATS if f"`{name}`" not in page] == []
