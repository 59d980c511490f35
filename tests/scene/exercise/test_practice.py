"""One trainee from request to row, without a page."""

from __future__ import annotations

import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.exercise import LEVELS
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.scene.pages.exercise.html import practice_card_html
from venus3d.scene.pages.exercise.practice import Practice, PracticeSettings
from venus3d.scene.pages.exercise.view_model import (
    ChooseLevel,
    MoveBoard,
    Nudge,
    PracticeViewModel,
    Press,
    Rename,
    Request,
)
from venus3d.scene.web.board_keys import BOARD_KEYS
from venus3d.scene.web.pose_texts import NUDGES
from venus3d.scene.web.theme import Theme


@pytest.fixture
def settings(paper_camera: Camera, default_board: Board) -> PracticeSettings:
    return PracticeSettings.of(paper_camera, default_board, 5, "practice.csv")


def ask(trainee: Practice, request: Request, at: float) -> None:
    trainee.tick(at)
    trainee.handle(request)


def view_of(trainee: Practice, at: float) -> PracticeViewModel:
    trainee.tick(at)
    return trainee.view()


def reach(trainee: Practice, at: float) -> None:
    ask(trainee, MoveBoard(view_of(trainee, at).target, "gizmo"), at)
    assert view_of(trainee, at).stage == "hold"
    assert view_of(trainee, at + 1.01).stage == "reached"


def test_a_pose_is_reached_after_being_held_and_two_lead_to_the_next_level(
    settings: PracticeSettings,
) -> None:
    trainee = Practice(settings, 1)
    target = view_of(trainee, 0).target
    ask(trainee, MoveBoard(target, "gizmo"), 10.0)
    trainee.tick(10.9)
    assert view_of(trainee, 10.9).stage == "hold" and not trainee.rows
    trainee.tick(11.01)
    assert view_of(trainee, 12).stage == "reached" and view_of(trainee, 12).level == 1
    assert trainee.rows[0].outcome == "reached" and trainee.rows[0].off_deg < 1e-3
    ask(trainee, Press("next"), 13.0)
    reach(trainee, 14.0)
    assert view_of(trainee, 16).level == 2
    ask(trainee, Press("next"), 17.0)
    assert sum(view_of(trainee, 17).attempt.free) == 2 and view_of(trainee, 17).seconds == 0


def test_whoever_moves_what_a_level_leaves_alone_is_told_why_nothing_happens(
    settings: PracticeSettings,
) -> None:
    trainee = Practice(settings, 1)
    free = view_of(trainee, 0).attempt.free
    ask(trainee, Nudge(free.index(False), 1), 1.0)
    assert view_of(trainee, 1).note and view_of(trainee, 1).attempt.path_mm == 0
    ask(trainee, Nudge(free.index(True), 1), 2.0)
    assert not view_of(trainee, 2).note


def keys_for(sentence: str) -> list[tuple[int, int]]:
    """The keys that a person presses who reads this and has not learnt what a turn is: those whose
    words are in it."""
    words = {
        "top edge towards": "top edge nearer",
        "bottom edge towards": "bottom edge nearer",
        "right edge towards": "right edge nearer",
        "left edge towards": "left edge nearer",
        "board clockwise": "clockwise",
        "counter-clockwise": "counter-clockwise",
        "to the right": "right",
        "to the left": "left",
        " down": "down",
        " up": "up",
        "mm away": "farther",
        "mm towards": "nearer",
    }
    told = [key for said, key in words.items() if said in sentence]
    return [BOARD_KEYS[key] for key in BOARD_KEYS if NUDGES[BOARD_KEYS[key]] in told]


@pytest.mark.parametrize("level", LEVELS)
def test_who_presses_the_keys_of_the_words_reaches_the_target(
    settings: PracticeSettings, level: int
) -> None:
    """Swing was guessed wrong: the words named one edge, the key the other one."""
    trainee, now = Practice(settings, 1), 0.0
    ask(trainee, ChooseLevel(level), now)
    for _ in range(1500):
        view = view_of(trainee, now)
        if view.stage != "aim":
            break
        step = view.match.steps[view.match.active_step - 1]
        wanted = keys_for(step_prompt(step).camera)
        assert wanted, step_prompt(step).camera
        for number, sign in wanted:
            now += 0.3  # each a press of its own
            ask(trainee, Nudge(number, sign), now)
    assert view_of(trainee, now).stage == "hold"
    assert view_of(trainee, now + 1.1).stage == "reached"


def test_a_drag_says_which_numbers_it_changes(settings: PracticeSettings) -> None:
    trainee = Practice(settings, 1)
    ask(trainee, ChooseLevel(6), 0.0)
    start = view_of(trainee, 0).pose
    ask(trainee, MoveBoard(start.moved([0.02, 0, -0.03]), "picture", start), 1.0)
    note = view_of(trainee, 1).note
    assert "right +20 mm" in note and "distance −30 mm" in note
    assert "down" not in note and "°" not in note
    ask(trainee, MoveBoard(start.turned("z", 12), "picture", start), 2.0)
    assert "turn about Z +12°" in view_of(trainee, 2).note
    ask(trainee, Nudge(3, 1), 3.0)
    assert not view_of(trainee, 3).note


def test_digits_of_a_typed_number_are_not_walked(settings: PracticeSettings) -> None:
    trainee = Practice(settings, 1)
    ask(trainee, ChooseLevel(6), 0.0)
    start = view_of(trainee, 0).pose
    for now, mm in ((1.0, 4.0), (1.1, 45.0), (1.2, 4.0), (1.3, 40.0)):
        ask(trainee, MoveBoard(start.moved([mm / 1000, 0, 0]), "sliders"), now)
    assert view_of(trainee, 1.3).attempt.path_mm == pytest.approx(40)


def test_trainees_share_targets_and_nothing_else(settings: PracticeSettings) -> None:
    one, other = Practice(settings, 1), Practice(settings, 2)
    assert (view_of(one, 0).target.matrix == view_of(other, 0).target.matrix).all()
    ask(one, ChooseLevel(6), 1.0)
    ask(one, Nudge(3, 1), 2.0)
    assert view_of(other, 2).pose.t[0] == 0 and view_of(other, 2).level == 1
    assert view_of(one, 2).pose.t[0] == pytest.approx(0.002)


def test_a_name_goes_on_where_it_left_off(settings: PracticeSettings) -> None:
    trainee = Practice(settings, 1)
    ask(trainee, Rename("  Anna "), 0.0)
    ask(trainee, ChooseLevel(3), 1.0)
    reach(trainee, 2.0)
    rows = tuple(trainee.rows)
    assert rows[0].participant == "Anna"
    back = Practice(settings, 2, known=rows)
    ask(back, Rename("Anna"), 0.0)
    view = view_of(back, 0)
    assert view.level == 3
    ask(back, Press("give_up"), 1.0)
    assert (back.rows[0].pose, back.rows[0].outcome) == (2, "given up")


def test_a_name_that_a_spreadsheet_would_run_is_harmless(settings: PracticeSettings) -> None:
    trainee = Practice(settings, 1)
    ask(trainee, Rename("=1+1"), 0.0)
    assert trainee.name == "1+1"
    ask(trainee, Rename("  "), 0.0)
    assert trainee.name.startswith("guest")


def test_a_move_is_told_without_the_parts_that_are_right_already(
    settings: PracticeSettings,
) -> None:
    """It said "move the board 1 mm to the right and ...", where a key moves by 2 mm."""
    trainee = Practice(settings, 1)
    ask(trainee, ChooseLevel(6), 0.0)
    target = view_of(trainee, 0).target
    ask(trainee, MoveBoard(target.moved([-0.001, 0.0, -0.08]), "gizmo"), 1.0)
    told = practice_card_html(view_of(trainee, 1), Theme(True))
    assert "Move the board 80 mm away from the camera." in told
