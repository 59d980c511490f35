"""Calibration and search in a process of their own: the same outcomes, and no process left over."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Iterator

import numpy as np
import psutil
import pytest

from tests.waiting import wait_until
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.loop import Calibrated
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.work import Outcome, Work
from venus3d.threads.work_process import WorkProcess

POSES = ((10, 0, 0, 0, 0, 0.5), (0, 40, 0, 0.05, 0, 0.6), (-35, 0, 20, 0, 0.03, 0.5))


def searching() -> list[psutil.Process]:
    """The processes that calibrate and search."""
    children = (one.as_dict(["pid", "cmdline"]) for one in psutil.Process().children())
    return [psutil.Process(one["pid"]) for one in children if "spawn_main" in str(one["cmdline"])]


class Desk:
    """A process that works, and what it has told."""

    def __init__(self) -> None:
        self.calibrated: list[tuple[Work, Calibrated]] = []
        self.answers: list[Outcome | CalibrationError] = []
        self.process = WorkProcess(lambda work, done: self.calibrated.append((work, done)))

    def answer(self) -> Outcome | CalibrationError:
        """What `take` gives when it gives something."""
        wait_until(self._takes, "no outcome", within_s=120)
        return self.answers[-1]

    def _takes(self) -> bool:
        answer = self.process.take()
        if answer is not None:
            self.answers.append(answer)
        return answer is not None

    def child(self) -> psutil.Process:
        """The process itself."""
        wait_until(searching)  # a new process is a copy of this one for a moment
        (found,) = searching()
        return found


def begun(desk: Desk, camera: Camera, board: Board) -> Work:
    """The first work of a session, which the process has been given."""
    work = session(camera, board).pending
    assert work is not None
    desk.process.begin(work)
    return work


@pytest.fixture
def desk() -> Iterator[Desk]:
    made = Desk()
    yield made
    made.process.close()
    assert not searching()


def session(camera: Camera, board: Board, views: int = 3) -> Session:
    """A session with so many views, whose newest work is to be done."""
    made = Session(
        board, camera.image_size, Settings(auto_capture=False, wanted_uncertainty_px=None)
    )
    rng = np.random.default_rng(1)
    for vector in POSES[:views]:
        pixels = camera.project(Pose.from_vector(vector).apply(board.corners))
        seen = pixels + rng.normal(0, 0.1, pixels.shape)
        made.observe(Observation(np.arange(len(seen)), seen, camera.image_size))
        assert made.capture()
    return made


def test_the_outcome_is_that_of_the_same_work_done_here(
    desk: Desk, paper_camera: Camera, default_board: Board
) -> None:
    asked = session(paper_camera, default_board)
    work = asked.pending
    assert work is not None
    desk.process.begin(work)  # at once: it does not wait until the process is there
    outcome, here = desk.answer(), work.run()
    assert isinstance(outcome, Outcome) and outcome.work is work
    assert np.array_equal(outcome.calibration.camera.parameters, here.calibration.camera.parameters)
    assert np.array_equal(outcome.calibration.covariance, here.calibration.covariance)
    assert outcome.suggestion is not None and here.suggestion is not None
    assert np.array_equal(
        outcome.suggestion.target.pose.vector(), here.suggestion.target.pose.vector()
    )
    assert outcome.warnings == here.warnings and outcome.diagnoses == here.diagnoses
    ((calibrated_work, figures),) = desk.calibrated
    assert calibrated_work is work and figures.rms_px == outcome.calibration.rms_px
    # The session takes it, and its next work goes on with it.
    assert asked.apply(outcome).phase == "guiding" and asked.skip_target()
    assert asked.pending is not None
    desk.process.begin(asked.pending)
    other = desk.answer()
    assert isinstance(other, Outcome) and other.suggestion is not None
    apart = other.suggestion.target.pose.vector() - outcome.suggestion.target.pose.vector()
    assert np.abs(apart).max() > 1e-3, "the skipped pose is avoided"


def test_newer_work_takes_the_place_of_older(
    desk: Desk, paper_camera: Camera, default_board: Board
) -> None:
    old = session(paper_camera, default_board).pending
    new = session(paper_camera, default_board, views=2).pending
    assert old is not None and new is not None
    desk.process.begin(old)
    wait_until(lambda: desk.process.take() or desk.calibrated, "it never began", within_s=120)
    desk.process.begin(new)
    answer = desk.answer()
    assert isinstance(answer, Outcome) and answer.work is new
    time.sleep(0.2)
    assert desk.process.take() is None and desk.process.work is None, "once"


def test_why_views_determine_no_camera_is_told(
    desk: Desk, paper_camera: Camera, default_board: Board
) -> None:
    work = session(paper_camera, default_board, views=1).pending
    assert work is not None
    seen = work.observations[0]
    line = seen.only(seen.ids < 3)
    object.__setattr__(work, "observations", (line,))
    with pytest.raises(CalibrationError) as here:
        work.run()
    desk.process.begin(work)
    answer = desk.answer()
    assert isinstance(answer, CalibrationError) and answer.args == here.value.args


def test_its_matrices_are_multiplied_by_one_thread(desk: Desk) -> None:
    """Here by as many as the user has."""
    before = os.environ.get("OPENBLAS_NUM_THREADS")
    assert desk.child().environ()["OPENBLAS_NUM_THREADS"] == (before or "1")


@pytest.mark.skipif(sys.platform == "win32", reason="signals of a terminal")
def test_what_is_typed_at_the_terminal_is_not_for_it(
    desk: Desk, paper_camera: Camera, default_board: Board
) -> None:
    for number in (signal.SIGINT, signal.SIGHUP):
        os.kill(desk.child().pid, number)  # while it starts, too
    begun(desk, paper_camera, default_board)
    assert isinstance(desk.answer(), Outcome)
    # This process hears them as before.
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)


def test_another_process_does_the_work_of_one_that_died_but_not_for_ever(
    desk: Desk, paper_camera: Camera, default_board: Board, caplog: pytest.LogCaptureFixture
) -> None:
    work = begun(desk, paper_camera, default_board)
    desk.child().kill()
    answer = desk.answer()
    assert isinstance(answer, Outcome) and answer.work is work
    assert "another one does its work" in caplog.text

    def killed_again() -> bool:
        for one in searching():
            one.kill()
        return desk.process.take() is not None

    with pytest.raises(RuntimeError, match="3 times"):
        wait_until(killed_again)


def test_a_group_of_processes_that_is_asked_to_end_is_no_fault(
    desk: Desk, paper_camera: Camera, default_board: Board, caplog: pytest.LogCaptureFixture
) -> None:
    work = begun(desk, paper_camera, default_board)
    desk.child().terminate()
    answer = desk.answer()
    assert isinstance(answer, Outcome) and answer.work is work and not caplog.text
