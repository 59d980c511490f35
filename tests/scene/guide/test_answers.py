"""What the page says to whom asks for something that is not to be had, and how long it says so."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest

from tests.ports import free_port
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.guidance.session import Session
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import ChooseAlternative, DropView, Intent, PageAction
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.sim import Simulation


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    page = Viewer(port=free_port())
    yield page
    page.close()


def noted(viewer: Viewer) -> str:
    return viewer._note.text  # pyright: ignore[reportPrivateUsage]


def test_what_cannot_be_done_is_answered(viewer: Viewer) -> None:
    """Undo without a view and after the end, and another pose while there is none, said nothing;
    a pose that was never offered was said to have changed."""
    camera, board = PAPER_CAMERA.scaled((640, 360)), Board()
    with closing(Simulation(camera, board)) as source:
        session = Session(board, camera.image_size)
        tracker = BoardTracker(Detector(board, find_layout=False))
        live: Any = LiveGuide(session, source, tracker, viewer, lambda _: None, lambda: source)

        def answer(intent: Intent) -> str:
            viewer.say("")
            live._obey(intent)
            return noted(viewer)

        assert answer(PageAction.UNDO_VIEW) == say.NO_VIEW_LEFT
        assert answer(PageAction.SKIP_TARGET) == say.NO_POSE_TO_CHOOSE
        assert answer(ChooseAlternative(0, 0)) == say.NO_POSE_TO_CHOOSE
        assert answer(DropView(7)) == "", "it is gone, as was asked"
        session.finish()
        assert answer(PageAction.UNDO_VIEW) == say.NO_VIEW_LEFT
        assert answer(PageAction.CAPTURE) == say.HAS_ENDED
        live._end()


def test_an_answer_goes_when_the_page_turns_to_something_else(viewer: Viewer) -> None:
    """ "No more views are taken" stood below the next step for seconds after Go on."""
    viewer.say(say.HAS_ENDED)
    viewer._ask(PageAction.GO_ON)  # pyright: ignore[reportPrivateUsage]
    assert noted(viewer) == ""
    viewer.warn("The disk is full.")
    viewer._ask(PageAction.GO_ON)  # pyright: ignore[reportPrivateUsage]
    assert noted(viewer) == "The disk is full."
