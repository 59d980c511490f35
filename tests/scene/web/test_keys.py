"""A key means the same on every page, and docs/keys.md says what."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.browser.keyboard import hotkeys
from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.scene.teach_server import served_teaching
from tests.waiting import wait_until
from venus3d.engine.calibration.measurement import MeasuringCamera
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.audience.controls import AudienceControls
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.exercise.practice import PracticeSettings
from venus3d.scene.pages.exercise.run import PracticeServer, trial_server
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_pictures import TrialPictures
from venus3d.scene.pages.exercise.trial_plan import plan_of
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.pages.measure.page import MeasurePage
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.board_keys import BOARD_KEYS
from venus3d.scene.web.help import key_name
from venus3d.scene.web.keys import KEYS
from venus3d.scene.web.server import start_server
from venus3d.storage.exercise import ExerciseFile

DOCUMENT = Path(__file__).parents[3] / "docs" / "keys.md"
PAGES = ("guide", "teach", "practice", "trial", "measure")
_OF_THE_HELP = {"H", "escape"}


@pytest.fixture(scope="module")
def gui_of(
    paper_camera: Camera,
    default_board: Board,
    painter: Offscreen,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[dict[str, Any]]:
    """The widgets of each page with everything that it can offer."""
    target = Pose.from_vector([0, 0, 0, 0, 0, 0.5])
    trial = Trial(default_board, paper_camera, plan_of("Anna", []), (target,), lambda _: None)
    settings = PracticeSettings.of(paper_camera, default_board, 0, "practice.csv")
    file = ExerciseFile(tmp_path_factory.mktemp("keys") / "practice.csv", "practice")
    servers = [start_server("127.0.0.1", free_port())[0] for _ in range(2)]
    exercises = {
        "practice": PracticeServer(servers[0], settings, file, painter),
        "trial": trial_server(servers[1], trial, TrialPictures(), simulated=True),
    }
    guide = Viewer(port=free_port(), draggable_board=True)
    AudienceControls(guide.server, SimpleNamespace(state=AudienceState()))  # pyright: ignore
    measuring = MeasurePage("127.0.0.1", free_port(), MeasuringCamera(paper_camera), default_board)
    found: dict[str, Any] = {"guide": guide.server.gui, "measure": measuring.server.gui}
    teaching = served_teaching(PoseAnalysis(paper_camera, default_board), painter)
    with (
        closing(guide),
        closing(measuring),
        teaching as teach,
        RawClient(teach.port) as tab,
        closing(file),
    ):
        tab.look()
        teach.page()
        found["teach"] = teach.server.tabs[0].client.gui
        for name, exercise in exercises.items():
            with RawClient(exercise.server.get_port()) as client:
                client.look()
                wait_until(lambda exercise=exercise: exercise.tabs)
                found[name] = exercise.tabs[0].client.gui
        yield found
        for exercise in exercises.values():
            exercise.close()
        for server in servers:
            server.stop()


def commands_of(gui: Any) -> dict[str, str]:
    """Label of each command by its key, without the help's own."""
    labels = (c.label for c in gui._command_handle_from_uuid.values())
    pairs = zip(hotkeys(gui), labels, strict=True)
    return {key: label for key, label in pairs if key is not None and key not in _OF_THE_HELP}


def documented() -> dict[str, dict[str, str]]:
    """Per page, label of each command by the name of its key, as the document says."""
    rows = re.findall(r"^\| `(.+?)` \|(.+)\|$", DOCUMENT.read_text(encoding="utf-8"), re.M)
    told: dict[str, dict[str, str]] = {page: {} for page in PAGES}
    for key, cells in rows:
        meaning, *labels = (cell.strip() for cell in cells.split("|"))
        assert meaning, key
        for page, label in zip(PAGES, labels, strict=True):
            if label:
                assert key not in told[page], f"{key} stands twice"
                told[page][key] = label
    return told


def test_the_document_names_every_key_of_every_page_and_no_other(gui_of: dict[str, Any]) -> None:
    found = {
        page: {key_name(key): label for key, label in commands_of(gui_of[page]).items()}
        for page in PAGES
    }
    assert found == documented()


def test_the_second_monitors_document_names_its_keys() -> None:
    text = DOCUMENT.with_name("second-monitor.md").read_text(encoding="utf-8")
    for option, name in (("--no-audience-mirror", "mirror"), ("--audience-view lens", "lens")):
        assert f"| `{option}` | {key_name(KEYS[name])} |" in text


def test_a_key_stands_for_one_meaning_on_all_pages(gui_of: dict[str, Any]) -> None:
    """A meaning has one key, and each key of a page is one of these, a board's, or a digit."""
    assert len(set(KEYS.values())) == len(KEYS)
    assert not set(KEYS.values()) & BOARD_KEYS.keys()
    assert not set("WASDQEH") & set(KEYS.values()), "the browser's camera, and the help"
    used: set[str] = set()
    for page in PAGES:
        used |= commands_of(gui_of[page]).keys()
    extra = used - set(KEYS.values()) - BOARD_KEYS.keys()
    assert extra <= set("123456"), extra
