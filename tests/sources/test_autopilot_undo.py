"""The simulated hand after every view was taken back: it brings the board into view again."""

from __future__ import annotations

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.target import unpredicted_target
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


def test_the_hand_leaves_a_target_whose_view_was_taken_back_and_comes_again(
    paper_camera: Camera, default_board: Board, painter: Offscreen
) -> None:
    """It stood at the target, where a view is captured by itself only once the board has left: if
    the same pose was asked for after an undo, the autopilot waited there for ever."""
    pose = Pose.from_vector([0, 30, 10, 0.05, 0, 0.4])
    aim = unpredicted_target(2, pose, paper_camera, default_board, reason="a test")
    simulation = Simulation(paper_camera, default_board, fps=10, speed=3, offscreen=painter)
    ways: list[float] = []
    for taken_back in (False, True, False):
        for _ in range(60):
            simulation.follow(aim, simulation.board_pose, taken_back=taken_back)
            assert simulation.read() is not None
        ways.append(simulation.board_pose.distance_to(aim.pose))
    arrived, left, again = ways
    assert arrived < 0.01 and again < 0.01
    assert left > 0.05
