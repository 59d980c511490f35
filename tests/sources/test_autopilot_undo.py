"""The simulated hand after every view was taken back: it brings the board into view again."""

from __future__ import annotations

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.render.offscreen import Offscreen
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.sim import Simulation


def guide(session: Session, simulation: Simulation, tracker: BoardTracker, frames: int) -> None:
    for _ in range(frames):
        frame = simulation.read()
        assert frame is not None
        session.observe(tracker.track(frame))
        session.run_pending()
        now = session.snapshot()
        simulation.follow(now.target, now.pose, begins=not now.captured, taken_back=now.taken_back)
        if now.views:
            return


def test_a_board_out_of_sight_comes_back_once_no_view_is_left(
    paper_camera: Camera, default_board: Board, painter: Offscreen
) -> None:
    """The hand had had a target, and without one it held the board where it was, for ever."""
    simulation = Simulation(paper_camera, default_board, fps=10, speed=3, offscreen=painter)
    session = Session(default_board, paper_camera.image_size, Settings(hold_frames=1))
    tracker = BoardTracker(Detector(default_board, find_layout=False))
    guide(session, simulation, tracker, 150)
    assert session.snapshot().captured == (1,)
    simulation.move_to(Pose.from_vector([0, 0, 0, -0.6, -0.5, 0.6]))
    session.undo_view()
    guide(session, simulation, tracker, 200)
    assert session.snapshot().captured == (2,)


def test_the_hand_leaves_a_pose_whose_view_was_taken_back_and_comes_again(
    paper_camera: Camera, default_board: Board, painter: Offscreen
) -> None:
    """It stood at the target, which is captured by itself only once the board has left it: after an
    undo the autopilot waited for ever, beside a page that asks to move the board away."""
    simulation = Simulation(paper_camera, default_board, fps=10, speed=3, offscreen=painter)
    session = Session(default_board, paper_camera.image_size, Settings(hold_frames=1))
    tracker = BoardTracker(Detector(default_board, find_layout=False))
    guide(session, simulation, tracker, 150)
    session.undo_view()
    assert session.snapshot().captured == ()
    guide(session, simulation, tracker, 200)
    assert session.snapshot().captured == (2,)
