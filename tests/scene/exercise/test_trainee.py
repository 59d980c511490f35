"""One trainee from wish to score, without a page."""

from __future__ import annotations

import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.scene.pages.exercise.trainee import Course, Trainee
from venus3d.scene.pages.exercise.view_model import ChooseLevel, MoveBoard, Nudge, Press, Rename


@pytest.fixture
def course(paper_camera: Camera, default_board: Board) -> Course:
    return Course.of(paper_camera, default_board, 5, "practice.csv")


def reach(trainee: Trainee, at: float) -> None:
    trainee.obey(MoveBoard(trainee.moment(at).target, "gizmo"), at)
    assert trainee.moment(at).stage == "hold"
    assert trainee.tick(at + 1.01)


def test_a_pose_is_reached_after_being_held_and_two_lead_to_the_next_level(course: Course) -> None:
    trainee = Trainee(course, 1)
    target = trainee.moment(0).target
    trainee.obey(MoveBoard(target, "gizmo"), 10.0)
    trainee.tick(10.9)
    assert trainee.moment(10.9).stage == "hold" and not trainee.new_rows
    trainee.tick(11.01)
    assert trainee.moment(12).stage == "reached" and trainee.moment(12).level == 1
    assert trainee.new_rows[0].outcome == "reached" and trainee.new_rows[0].off_deg < 1e-3
    trainee.obey(Press("next"), 13.0)
    reach(trainee, 14.0)
    assert trainee.moment(16).level == 2
    trainee.obey(Press("next"), 17.0)
    assert sum(trainee.moment(17).free) == 2 and trainee.moment(17).seconds == 0


def test_whoever_moves_what_a_level_leaves_alone_is_told_why_nothing_happens(
    course: Course,
) -> None:
    trainee = Trainee(course, 1)
    free = trainee.moment(0).free
    trainee.obey(Nudge(free.index(False), 1), 1.0)
    assert trainee.moment(1).note and trainee.moment(1).path_mm == 0
    trainee.obey(Nudge(free.index(True), 1), 2.0)
    assert not trainee.moment(2).note


def test_digits_of_a_typed_number_are_not_walked(course: Course) -> None:
    trainee = Trainee(course, 1)
    trainee.obey(ChooseLevel(6), 0.0)
    start = trainee.moment(0).pose
    for now, mm in ((1.0, 4.0), (1.1, 45.0), (1.2, 4.0), (1.3, 40.0)):
        trainee.obey(MoveBoard(start.moved([mm / 1000, 0, 0]), "sliders"), now)
    assert trainee.moment(1.3).path_mm == pytest.approx(40)


def test_trainees_share_targets_and_nothing_else(course: Course) -> None:
    one, other = Trainee(course, 1), Trainee(course, 2)
    assert (one.moment(0).target.matrix == other.moment(0).target.matrix).all()
    one.obey(ChooseLevel(6), 1.0)
    one.obey(Nudge(3, 1), 2.0)
    assert other.moment(2).pose.t[0] == 0 and other.moment(2).level == 1
    assert one.moment(2).pose.t[0] == pytest.approx(0.002)


def test_a_name_goes_on_where_it_left_off(course: Course) -> None:
    trainee = Trainee(course, 1)
    trainee.obey(Rename("  Anna "), 0.0)
    trainee.obey(ChooseLevel(3), 1.0)
    reach(trainee, 2.0)
    rows = tuple(trainee.new_rows)
    assert rows[0].trainee == "Anna"
    back = Trainee(course, 2)
    back.obey(Rename("Anna"), 0.0, rows)
    moment = back.moment(0)
    assert moment.level == 3
    back.obey(Press("give_up"), 1.0)
    assert (back.new_rows[0].pose, back.new_rows[0].outcome) == (2, "given up")


def test_a_name_that_a_spreadsheet_would_run_is_harmless(course: Course) -> None:
    trainee = Trainee(course, 1)
    trainee.obey(Rename("=1+1"), 0.0)
    assert trainee.name == "1+1"
    trainee.obey(Rename("  "), 0.0)
    assert trainee.name.startswith("guest")
