"""Guiding without a viewer, through an end that nobody asked for."""

from __future__ import annotations

from contextlib import closing

import pytest

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.guidance.session import Session
from venus3d.scene.pages.guide.headless import run_headless
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.sim import Simulation


@pytest.mark.slow
def test_a_picture_that_stays_out_of_focus_is_told_as_the_reason(default_board: Board) -> None:
    """It was said that the hand did not come near enough."""
    with closing(Simulation(board=default_board, fps=5, speed=2.5, blur_sigma=2.0)) as source:
        session = Session(default_board, source.image_size)
        tracker = BoardTracker(Detector(default_board, find_layout=False))
        end = run_headless(session, source, tracker, lambda _: None)
    assert end.broke_off and "Out of focus" in end.why
    assert not session.snapshot().views
