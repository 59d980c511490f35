"""What a teaching page shows, by what people press; and what its scene holds then."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.lessons.lesson import Lesson, LessonPage, Question
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground
from venus3d.render.shapes import LabelShape, MeshShape
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import LookFrom, PageAction, after_action
from venus3d.scene.pages.teach.comparison import comparison_words
from venus3d.scene.pages.teach.controls import HOTKEYS, labels_of
from venus3d.scene.pages.teach.lesson_html import card_html, heading_html, steps_html
from venus3d.scene.pages.teach.pictures import TeachPictures
from venus3d.scene.pages.teach.scene_shapes import board_pose_at, camera_shapes_at, scene_shapes
from venus3d.scene.pages.teach.state import FREE_VECTOR, SECONDS_PER_STEP, TeachState, Vector
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.theme import Theme

BUSY = (False, False, False, False)
REFUSED: Vector = (20.0, 10.0, 30.0, 190.0, -60.0, 420.0)
PAGE = LessonPage("One", "Text", (10.0, 0.0, 0.0, 0.0, 0.0, 500.0), viewpoint="above")
ASKING = msgspec.structs.replace(
    PAGE, question=Question("Which?", ("A", "B"), 2, "So."), arrangement="axes"
)
LESSONS = (Lesson("a", "A", "", (PAGE, ASKING)), Lesson("b", "B", "", (PAGE,)))


def later(state: TeachState, seconds: float) -> TeachState:
    for _ in range(round(seconds / 0.05)):
        state = state.after(0.05, BUSY)
    return state


def test_play_goes_through_all_steps_once_and_stops_at_the_pose() -> None:
    state = TeachState().play(True)
    seen: list[int] = []
    for _ in range(400):
        state = state.after(0.05, BUSY)
        if not seen or seen[-1] != state.step:
            seen.append(state.step)
    assert seen == [1, 2, 3, 4]
    assert not state.playing and state.at_rest
    assert later(replace(TeachState(), loop=True).play(True), 5.0 * SECONDS_PER_STEP).progress < 4
    assert later(replace(TeachState(), loop=True).play(True), 40).playing


def test_next_lets_one_step_happen_and_previous_goes_back() -> None:
    state = later(TeachState().step_on(), 10)
    assert (state.progress, state.playing, state.step) == (1.0, False, 1)
    state = later(state.step_on(), 10)
    assert state.progress == 2.0
    assert state.step_back().progress == 1.0
    assert state.carried_to(0.6).step_back().progress == 2.0
    assert TeachState().carried_to(0.0).step_back().progress == 0.0


def test_an_idle_step_is_passed_quickly() -> None:
    idle = (True, False, False, False)
    state = TeachState().step_on().after(0.35 * SECONDS_PER_STEP / 2, idle)
    assert state.progress == 1.0


def test_a_slider_shows_its_own_step_and_stops_the_animation() -> None:
    moved = (*FREE_VECTOR[:1], 33.0, *FREE_VECTOR[2:])
    state = TeachState().play(True).with_vector(moved)
    assert (state.step, state.sweep, state.playing) == (3, 1.0, False)
    assert state.with_vector((*moved[:4], 5.0, moved[5])).step == 1


def test_editing_a_number_shows_the_board_where_the_numbers_say(study: PoseAnalysis) -> None:
    """Way went to the start once, and the card said "right" of a board that stood elsewhere."""
    generator, theme = np.random.default_rng(4), Theme(True)
    home: Vector = (0.0, 0.0, 0.0, 0.0, 0.0, 500.0)
    state = TeachState(vector=home)
    for _ in range(150):
        # Whatever was going on before ...
        doing = generator.integers(4)
        if doing == 0:
            state = state.carried_to(float(generator.choice([0.0, 0.25, 0.4, 1.0])))
        elif doing == 1:
            state = state.play(True).after(0.3, BUSY)
        elif doing == 2:
            state = state.step_back()
        number = int(generator.integers(6))
        value = home[number] if generator.random() < 0.4 else float(generator.integers(-40, 40))
        edited = [*state.vector]
        edited[number] = value + (500 if number == 5 and value < 500 else 0)
        state = state.with_vector((edited[0], edited[1], edited[2], *edited[3:]))  # type: ignore[arg-type]
        taught = study(state.vector)
        assert state.progress == 4.0 and not state.playing
        shown = board_pose_at(taught, state)
        np.testing.assert_allclose(1000 * shown.t, state.vector[3:], atol=1e-9)
        card = card_html(taught, state, theme)
        assert "The position is right" not in card and "Nothing to turn" not in card
        if not state.at_rest and not taught.steps[state.step - 1].is_idle:
            assert f"Step {state.step} of 4" in card


def test_lessons_set_the_page_and_turn_into_each_other() -> None:
    state = TeachState(lessons=LESSONS).opened(0)
    assert state.vector == PAGE.pose and state.viewpoint == "above"
    state = state.page_turned(1)
    assert state.arrangement == "axes" and state.answered(2).answer == 2
    assert state.answered(3).answer is None, "there is no third answer"
    state = state.answered(1).page_turned(1)
    assert (state.lesson, state.page, state.answer) == (1, 0, None)
    assert state.page_turned(1) == state.opened(None), "after the last page of all"
    assert state.page_turned(-1).page == 1
    names = [labels_of((PageAction.NEXT_PAGE,), one) for one in (state, state.page_turned(-1))]
    assert [list(n.values()) for n in names] == [
        [texts.LABELS[PageAction.NEXT_PAGE]],
        [texts.ON_TO_LESSON],
    ], "the button says where it leads"
    assert state.opened(None).vector == FREE_VECTOR
    swapped = state.opened(None).next_order()
    assert swapped.arrangement == "order", "what it changes is shown first"
    assert swapped.next_order().order != swapped.order
    assert TeachState().page_turned(1) == TeachState(), "no lessons"


def test_every_hotkey_changes_something() -> None:
    keys = [key for key in HOTKEYS.values() if key is not None]
    assert len(set(keys)) == len(keys)
    assert not {"W", "A", "S", "D", "Q", "E", "H"} & set(HOTKEYS.values())
    question = msgspec.structs.replace(
        ASKING, question=Question("?", ("A", "B", "C", "D", "E"), 1, "")
    )
    lessons = (Lesson("a", "A", "", (PAGE, question, PAGE)), LESSONS[1])
    state = TeachState(lessons=lessons).opened(0).page_turned(1).carried_to(0.3)
    state = replace(state, vector=FREE_VECTOR)
    for action in HOTKEYS:
        if action is PageAction.MENU:
            continue  # opens in the tab, whatever it shows
        before = replace(state, viewpoint="camera") if action != LookFrom("camera") else state
        assert after_action(before, action) != before, action


@pytest.fixture
def study(paper_camera: Camera, default_board: Board) -> PoseAnalysis:
    return PoseAnalysis(paper_camera, default_board)


def test_the_board_goes_along_one_degree_of_freedom_at_a_time(study: PoseAnalysis) -> None:
    taught = study(FREE_VECTOR)
    for step, axis in ((2, "x"), (3, "y"), (4, "z")):
        start = board_pose_at(taught, TeachState(progress=step - 1 + 1e-9))
        half = board_pose_at(taught, TeachState(progress=step - 0.5))
        wanted = Rotation.from_euler(axis, FREE_VECTOR[step - 2] / 2, degrees=True).as_matrix()
        np.testing.assert_allclose(half.R @ start.R.T, wanted, atol=1e-6)
        np.testing.assert_allclose(half.t, [0.06, -0.03, 0.52], atol=1e-9)
    end = board_pose_at(taught, TeachState())
    whole = Rotation.from_euler("xyz", FREE_VECTOR[:3], degrees=True).as_matrix()
    np.testing.assert_allclose(end.R, whole, atol=1e-12)


def test_the_angle_counts_up_and_a_refused_target_says_so(study: PoseAnalysis) -> None:
    taught = study(FREE_VECTOR)

    def text(name: str, state: TeachState, vector: Vector = FREE_VECTOR) -> str:
        shapes = scene_shapes(study(vector), state)
        return next(s.text for s in shapes if isinstance(s, LabelShape) and s.name == name)

    assert text("/steps/2/label", TeachState(progress=1.5)) in ("+12°", "+13°")
    assert text("/steps/3/label", TeachState(progress=2.9)) == "−27°"
    assert not taught.refusals
    assert "refused" in text("/target/label", TeachState(), REFUSED)


def test_the_sector_grows_with_the_board(study: PoseAnalysis) -> None:
    taught = study(FREE_VECTOR)
    for draw in (scene_shapes, camera_shapes_at):
        for progress in (1.02, 1.4, 1.8, 2.0):
            (mesh,) = (
                shape.mesh
                for shape in draw(taught, TeachState(progress=progress))
                if isinstance(shape, MeshShape) and shape.name == "/steps/2/sector"
            )
            rim = mesh.vertices[1:]
            angles = np.degrees(np.arctan2(rim[:, 1], rim[:, 0]))
            assert np.ptp(angles) == pytest.approx(
                abs(FREE_VECTOR[0]) * (progress - 1), abs=0.51
            ), progress


def test_two_readings_stand_apart_by_the_angle_that_scipy_finds(study: PoseAnalysis) -> None:
    taught = study(FREE_VECTOR, "zyx")
    angles = FREE_VECTOR[:3]
    fixed = Rotation.from_euler("xyz", angles, degrees=True)
    for arrangement, other in (
        ("axes", Rotation.from_euler("XYZ", angles, degrees=True)),
        ("order", Rotation.from_euler("zyx", angles[::-1], degrees=True)),
    ):
        apart = np.degrees((other * fixed.inv()).magnitude())
        assert taught.apart_deg(arrangement) == pytest.approx(apart)  # type: ignore[arg-type]
        state = replace(TeachState(progress=2.5), arrangement=arrangement)  # type: ignore[arg-type]
        names = {shape.name for shape in scene_shapes(taught, state)}
        assert {"/compare/left/board", "/compare/right/board", "/compare/right/arc"} <= names
        # One turn done, the next one not begun: scene and words speak of the same.
        state = replace(state, progress=2.0)
        labels = {s.name: s.text for s in scene_shapes(taught, state) if isinstance(s, LabelShape)}
        assert labels["/compare/left/angle"] == f"{angles[0]:+.0f}°"
        assert comparison_words(taught, state).turn == 1


def test_pictures_mark_what_is_refused_and_are_drawn_once(
    painter: Offscreen, study: PoseAnalysis
) -> None:
    pictures, warning = TeachPictures(painter), np.array(ground(True).warning)

    def warned(vector: Vector) -> int:
        state = TeachState(vector=vector)
        picture = pictures.camera_picture(study(vector), state, fine=False)
        return int((np.abs(picture.astype(int) - warning).sum(axis=2) < 12).sum())

    assert warned(FREE_VECTOR) == 0 and warned(REFUSED) > 2000
    taught = study(FREE_VECTOR)
    drawn = [
        pictures.step_picture(taught, step, True, fine=fine)
        for step in taught.steps
        for fine in (False, True)
    ]
    assert drawn[1].shape > drawn[0].shape
    assert not np.array_equal(drawn[0], drawn[2]), "another step"
    again = pictures.step_picture(study(FREE_VECTOR), taught.steps[0], True, fine=True)
    assert again is drawn[1], "another tab gets the same"
    light = pictures.step_picture(taught, taught.steps[0], False, fine=True)
    assert light.mean() > again.mean() + 50


def test_the_steps_card_marks_the_step_and_tells_both_sides(study: PoseAnalysis) -> None:
    taught, theme = study(FREE_VECTOR), Theme(True)
    assert "data-marked='3'" in heading_html("", TeachState(progress=2.5).step)
    told = steps_html(taught, theme)
    for step in taught.steps:
        words = step_prompt(step)
        assert words.camera in told
        assert words.holder[1:] in told
    for viewpoint, first, then in (("outside", "right", "left"), ("holder", "left", "right")):
        state = replace(TeachState(progress=1.0), viewpoint=viewpoint)  # type: ignore[arg-type]
        card = card_html(taught, state, theme)
        assert card.index(f"mm to {'the' if first == 'right' else 'your'} {first}") < card.index(
            f"mm to {'your' if then == 'left' else 'the'} {then}"
        )
    there = TeachState(progress=4.0)
    assert "Space bar" in card_html(taught, there, theme)
    assert "Space bar" not in card_html(taught, there, theme, live=False), "who follows has no way"
    tilt = card_html(taught, TeachState(progress=2.0), theme)
    assert tilt.count("Tilt the top edge") == 1, "the same for both sides is said once"
