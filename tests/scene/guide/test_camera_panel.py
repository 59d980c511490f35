"""A camera's settings on the page: shown, set, locked, and the same when it is opened again."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import cv2
import pytest

from tests.ports import free_port
from tests.sources.webcam import Webcam
from tests.waiting import wait_until
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.guidance.session import Session
from venus3d.scene.pages.guide import texts
from venus3d.scene.pages.guide.intents import SetCamera
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.camera_controls import CameraControls
from venus3d.sources.camera_settings import CameraSetting, CameraSettings
from venus3d.sources.live import Live

FOCUS_RANGE = (0.0, 250.0, 5.0)


class Setup:
    """A session on a webcam that can be plugged in again; `webcam` is the one opened last."""

    def __init__(self) -> None:
        controls = CameraControls("Camera 0", CameraSettings(), lambda: {"focus": FOCUS_RANGE})
        self.kept: list[CameraSettings] = []

        def opening() -> Webcam:
            self.webcam = Webcam()
            controls.opened(self.webcam)
            return self.webcam

        self.source = Live(opening, "Camera 0", controls=controls, timeout_s=1.0)
        self.source.notes = controls.notes
        self.viewer = Viewer(port=free_port())
        session = Session(Board(), self.source.image_size)
        tracker = BoardTracker(Detector(Board(), find_layout=False))
        self.live = LiveGuide(
            session,
            self.source,
            tracker,
            self.viewer,
            lambda _: None,
            lambda: self.source,
            on_camera=self.kept.append,
        )
        self.running = threading.Thread(target=self.live.run, daemon=True)
        self.running.start()

    def shown(self, name: str) -> CameraSetting:
        return next(one for one in self.viewer.state.camera if one.name == name)


@pytest.fixture
def setup() -> Iterator[Setup]:
    setup = Setup()
    yield setup
    setup.live.stop()
    setup.running.join(20)
    setup.viewer.close()


def test_settings_are_shown_set_locked_and_kept(setup: Setup) -> None:
    viewer = setup.viewer
    assert "focuses by itself" in setup.source.notes[0]
    wait_until(lambda: viewer.state.camera)
    assert [one.name for one in viewer.state.camera] == ["exposure", "gain", "focus"]
    assert setup.shown("focus") == CameraSetting("focus", 35.0, True, FOCUS_RANGE)
    assert setup.shown("gain").automatic is None

    rows = viewer.view.camera._rows  # pyright: ignore[reportPrivateUsage]
    wait_until(lambda: rows["focus"]._number.visible and rows["focus"]._number.value == 35)
    focus = rows["focus"]._number
    assert (focus.min, focus.max, focus.step) == FOCUS_RANGE and "0 to 250" in focus.label
    assert not rows["gain"]._who.visible and not rows["white_balance"]._number.visible
    viewer._ask(SetCamera("focus", "lock"))
    wait_until(lambda: setup.shown("focus").automatic is False)
    assert setup.webcam.values[cv2.CAP_PROP_AUTOFOCUS] == 0
    wait_until(lambda: viewer._note.text == texts.FOCUS_LOCKED)
    viewer._ask(SetCamera("exposure", "120"))
    wait_until(lambda: setup.shown("exposure") == CameraSetting("exposure", 120.0, False))
    wait_until(lambda: rows["exposure"]._number.value == 120)

    for refused in (("focus", "900"), ("gain", "auto"), ("gain", "nan")):
        viewer._ask(SetCamera(*refused))
        wait_until(lambda wanted=refused[1]: wanted in viewer._note.text)
    assert setup.webcam.values[cv2.CAP_PROP_GAIN] == 12

    viewer._ask(SetCamera("focus", "40"))
    wait_until(lambda: setup.shown("focus").value == 40)
    before = setup.webcam
    before.unplugged = True
    wait_until(lambda: setup.webcam is not before)
    wait_until(lambda: setup.webcam.values[cv2.CAP_PROP_EXPOSURE] == 120)
    assert setup.webcam.values[cv2.CAP_PROP_FOCUS] == 40
    assert setup.webcam.values[cv2.CAP_PROP_AUTOFOCUS] == 0
    assert setup.kept == [
        CameraSettings(focus="35"),
        CameraSettings(focus="35", exposure="120"),
        CameraSettings(focus="40", exposure="120"),
    ]
