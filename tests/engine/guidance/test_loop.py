"""The loop's figures are those of the work done, and its active part is the one going on."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.loop import Calibrated, Loop
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings


def seen(camera: Camera, board: Board, vector: list[float], detect_s: float) -> Observation:
    pixels = camera.project(Pose.from_vector(vector).apply(board.corners))
    inside = ((pixels >= 0) & (pixels < camera.image_size)).all(axis=1)
    found = Observation(np.flatnonzero(inside), pixels[inside], camera.image_size)
    return replace(found, detect_s=detect_s)


def work_on_the_captured_view(session: Session) -> Loop:
    """Runs the pending work, and returns the loop as it was while the next pose was searched."""
    work = session.pending
    assert work is not None
    during: list[Loop] = []

    def note(calibrated: Calibrated) -> None:
        session.note_calibrated(work, calibrated)
        during.append(session.snapshot().loop)

    began = time.perf_counter()
    outcome = work.run(on_calibrated=note)
    whole_s = time.perf_counter() - began
    after = session.apply(outcome).loop
    assert after.rms_px == during[0].rms_px == outcome.calibration.rms_px
    assert 0 < after.calibrate_s == during[0].calibrate_s
    assert after.search_s > 0
    assert after.calibrate_s + after.search_s <= whole_s
    return during[0]


def test_the_parts_follow_each_other_with_their_figures(
    paper_camera: Camera, default_board: Board
) -> None:
    size = paper_camera.image_size
    session = Session(default_board, size, Settings(auto_capture=False))
    assert session.observe(Observation.nothing(size)).loop.active == "detect"
    poses = ([30.0, 0, 0, 0, 0, 0.45], [0, 30, 0, 0.03, 0, 0.4], [-25, 10, 5, -0.03, 0, 0.4])
    for number, (vector, took_s) in enumerate(zip(poses, (0.01, 0.03, 0.05), strict=True), start=1):
        session.observe(seen(paper_camera, default_board, vector, took_s))
        assert session.capture()
        assert session.snapshot().loop.active == "calibrate"
        during = work_on_the_captured_view(session)
        assert (during.active, during.views) == ("search", number)
        now = session.snapshot()
        assert now.target is not None
        assert now.remaining is not None
        assert (now.loop.active, now.loop.views) == ("decompose", number)
        assert (now.loop.poses, now.loop.search_s) == (now.target.evaluated, now.target.search_s)
        assert now.loop.steps_left == sum(not step.done for step in now.remaining.each)
    assert now.loop.detect_s == pytest.approx(0.03), "the median; what was not measured is left out"
    assert now.loop.after_px == now.history[-1].uncertainty_px
    assert now.loop.before_px == now.history[-2].uncertainty_px
    there = list(now.target.pose.vector())
    assert session.observe(seen(now.camera, default_board, there, 0.05)).loop.active == "capture"
    assert session.observe(Observation.nothing(size)).loop.active == "detect"
    session.finish()
    assert session.snapshot().loop.active is None


def test_another_works_calibration_is_not_taken_for_this_ones(
    paper_camera: Camera, default_board: Board
) -> None:
    """Another view is captured while the first one's work runs on another thread, which reports."""
    session = Session(default_board, paper_camera.image_size, Settings(auto_capture=False))
    session.observe(seen(paper_camera, default_board, [30, 0, 0, 0, 0, 0.45], 0.01))
    session.capture()
    old = session.pending
    session.observe(seen(paper_camera, default_board, [0, 30, 0, 0, 0, 0.45], 0.01))
    session.capture()
    assert old is not None
    assert old is not session.pending
    session.note_calibrated(old, Calibrated(1.0, 1, 0.5))
    now = session.snapshot().loop
    assert now.active == "calibrate"
    assert np.isnan(now.calibrate_s)
