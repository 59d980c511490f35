"""Cameras at this machine: what is listed of them (linuxpy with a faked driver), what is set."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import cv2
import pytest

from tests.sources.webcam import Webcam
from venus3d.cli import main
from venus3d.engine.errors import SourceError
from venus3d.sources import camera_list
from venus3d.sources.camera_settings import CameraSettings, apply_settings, settings_notes
from venus3d.sources.v4l2 import setting_ranges


@pytest.fixture
def webcam(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> str:
    """Its device, by id."""
    ioctl = pytest.importorskip("linuxpy.ioctl")
    from tests.sources.v4l2_driver import Driver

    device = tmp_path / "video0"
    device.touch()
    by_id = tmp_path / "usb-HD_Pro_Webcam-video-index0"
    by_id.symlink_to(device)
    monkeypatch.setattr(ioctl, "fcntl", SimpleNamespace(ioctl=Driver().ioctl))
    monkeypatch.setattr(camera_list, "present_cameras", lambda: [str(by_id)])
    return str(by_id)


def test_a_webcam_is_listed_with_all_that_it_has(
    webcam: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["cameras", "--json"]) == 0
    *lines, last = capsys.readouterr().out.splitlines()
    assert lines == [
        "HD Pro Webcam",
        f"  venus3d guide {webcam}",
        "  MJPEG  1920 x 1080  at 30 pictures/s",
        "  MJPEG   1280 x 720  at 60, 30 pictures/s",
        "  YUYV     640 x 480  at 30 pictures/s",
        "  gain = 12 (0 to 255)",
        "  auto_exposure = 3 (1: Manual Mode, 3: Aperture Priority Mode)",
        "  exposure_time_absolute = 250 (3 to 2047; set by an automatic)",
        "  focus_absolute = 30 (0 to 250 in steps of 5; set by an automatic)",
        "  focus_automatic_continuous = on (on or off)",
    ]
    (camera,) = json.loads(last)["cameras"]
    assert camera["modes"][1] == {"encoding": "MJPEG", "size": [1280, 720], "rates": [60.0, 30.0]}


def test_the_ranges_of_the_settings_that_a_driver_tells(webcam: str, tmp_path: Path) -> None:
    """By the controls' numbers in V4L2: their names differ from kernel to kernel."""
    assert setting_ranges(webcam) == {
        "exposure": (3.0, 2047.0, 1.0),
        "gain": (0.0, 255.0, 1.0),
        "focus": (0.0, 250.0, 5.0),
    }
    assert setting_ranges(str(tmp_path / "none")) == {}


def test_without_a_camera_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(camera_list, "present_cameras", list)
    monkeypatch.setattr("sys.platform", "linux")
    assert main(["cameras"]) == 2
    assert "There is no camera at this machine" in capsys.readouterr().err


def test_a_locked_focus_is_the_same_when_the_camera_is_opened_again() -> None:
    webcam = Webcam()
    assert "focuses by itself" in settings_notes(webcam, "Camera 0")[0]
    settings = apply_settings(webcam, CameraSettings(focus="lock"), "Camera 0")
    assert webcam.values[cv2.CAP_PROP_AUTOFOCUS] == 0 and not settings_notes(webcam, "Camera 0")
    again = Webcam()
    again.values[cv2.CAP_PROP_FOCUS] = 80.0
    apply_settings(again, settings, "Camera 0")
    assert again.values[cv2.CAP_PROP_FOCUS] == 35.0


@pytest.mark.parametrize(("backend", "manual"), [("V4L2", 1.0), ("DSHOW", 0.25)])
def test_a_number_switches_the_automatic_off(backend: str, manual: float) -> None:
    webcam = Webcam(backend)
    apply_settings(webcam, CameraSettings(exposure="120"), "Camera 0")
    assert webcam.values[cv2.CAP_PROP_AUTO_EXPOSURE] == manual
    assert webcam.values[cv2.CAP_PROP_EXPOSURE] == 120


@pytest.mark.parametrize(
    "settings",
    [
        CameraSettings(gain="auto"),
        CameraSettings(focus="900"),
        CameraSettings(white_balance="lock"),
        CameraSettings(white_balance="4000"),
    ],
)
def test_what_a_camera_has_not_is_refused(settings: CameraSettings) -> None:
    with pytest.raises(SourceError, match="does not take --camera"):
        apply_settings(Webcam(), settings, "Camera 0")


def test_mistyped_settings_and_sources_without_any(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["guide", "0", "--camera.focus", "soft"]) == 2
    assert "--camera.focus wants a number, auto or lock, not 'soft'" in capsys.readouterr().err
    assert main(["guide", "sim", "--camera.gain", "3", "--headless", "--no-record"]) == 2
    assert "nothing to set" in capsys.readouterr().err


def test_a_pipeline_without_gstreamer_names_the_way_out(capsys: pytest.CaptureFixture[str]) -> None:
    """OpenCV 5 lists GStreamer as a plugin, whether it is there or not."""
    if cv2.videoio_registry.hasBackend(cv2.CAP_GSTREAMER):
        pytest.skip("this OpenCV has GStreamer")
    pipeline = "videotestsrc ! videoconvert ! appsink"
    assert main(["guide", pipeline, "--headless", "--no-record"]) == 2
    assert "was built without GStreamer" in capsys.readouterr().err
