"""The second monitor's dial and words: which way, how far, when it is right; for the holder."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.scene.guided import matched
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.matching import Match, match
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.target import Target
from venus3d.render.palette import contrast, ground, step_colour
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.dial import (
    amount_text,
    dial_html,
    share,
    tick_html,
)
from venus3d.scene.pages.audience.glance import glance_html, picture_share
from venus3d.scene.pages.audience.view_model import achieved, view_model_of
from venus3d.scene.pages.guide import texts as guide_texts
from venus3d.scene.pages.guide.guidance_panel import guidance_html
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.web.step_card import NO_NOTE
from venus3d.scene.web.theme import Theme

GOAL = Pose.from_vector([10, 5, 0, 0.0, 0.0, 0.5])


@pytest.fixture
def at(paper_camera: Camera, default_board: Board):
    """The match of a board that has to be turned and moved by so much."""

    def found(x: float = 0, y: float = 0, z: float = 0, mm: tuple[float, ...] = (0, 0, 0)) -> Match:
        start = GOAL.turned("z", -z).turned("y", -y).turned("x", -x).moved(-np.array(mm) / 1000)
        return match(paper_camera, default_board, start, GOAL)

    return found


def svg(html: str) -> ElementTree.Element:
    return ElementTree.fromstring(html)


def hand(html: str) -> tuple[float, float]:
    """The end of the gauge's hand."""
    (knob,) = svg(html).findall("circle")
    return float(knob.attrib["cx"]), float(knob.attrib["cy"])


def angle_of(point: tuple[float, float]) -> float:
    """From the gauge's top, clockwise, degrees."""
    return float(np.degrees(np.arctan2(point[0] - 200, 210 - point[1])))


def test_the_hand_moves_as_the_board_does_for_its_holder(at) -> None:
    """Clockwise in the picture is counter-clockwise for who holds it: from the right to the top."""
    clockwise = at(z=30)
    assert "counter-clockwise" in step_prompt(clockwise.steps[3]).holder
    assert angle_of(hand(dial_html(clockwise, 4))) > 20
    assert angle_of(hand(dial_html(at(z=-30), 4))) < -20
    right, left = (angle_of(hand(dial_html(at(z=deg), 4))) for deg in (12, -12))
    assert right == pytest.approx(-left, abs=0.1)


@pytest.mark.parametrize(("step", "axis"), [(2, "x"), (3, "y"), (4, "z")])
def test_the_green_band_ends_where_the_step_is_done(at, step: int, axis: str) -> None:
    """The band's end and a hand at the tolerance coincide; the nearer, the smaller the angle."""
    limit = at().limit_deg
    angles = [
        abs(angle_of(hand(dial_html(at(**{axis: deg}), step)))) for deg in (limit, 10, 30, 89)
    ]
    assert angles == sorted(angles)
    band = [p for p in svg(dial_html(at(x=10), step)).iter("path") if "done" in p.attrib["stroke"]]
    x, y = (float(v) for v in band[0].attrib["d"].split(" ")[-2:])
    assert abs(angle_of((x, y))) == pytest.approx(angles[0], abs=0.2)


def test_a_move_has_three_scales_with_the_holders_left_and_right(at) -> None:
    """To the picture's right is to the holder's left: the board is on its right side now."""
    found = at(mm=(50, -20, 0))
    assert (
        "left" in step_prompt(found.steps[0]).holder and "up" in step_prompt(found.steps[0]).holder
    )
    root = svg(dial_html(found, 1))
    boards = [float(c.attrib["cx"]) for c in root.iter("circle")]
    assert boards[0] > 230 and boards[1] > 215 and boards[2] == pytest.approx(200, abs=1)
    ways = [t.text for t in root.iter("text") if "v-way" in t.attrib["class"]]
    assert ways == ["left", "up"]
    said = [t.text for t in root.iter("text") if "v-part" in t.attrib["class"]]
    assert said == ["← 50 mm", "↑ 20 mm", "✓ done"]


def test_three_scales_that_are_right_make_a_move_that_is_done(at) -> None:
    """The tolerance is for the whole way, a scale has its share of it."""
    share_mm = 0.99 * at().limit_mm / np.sqrt(3)
    found = at(mm=(share_mm, -share_mm, share_mm))
    assert dial_html(found, 1).count("✓") == 3 and found.within[0]


def test_the_sentence_leaves_out_what_a_scale_ticks_off(guided: Snapshot, at) -> None:
    """Not "Move the board 2 mm to your left" beside a tick."""
    found = at(mm=(-2, 0.3, 40))
    moment = view_model_of(matched(guided, found))
    assert moment.sentence == "Move the board 40 mm away from the camera."
    told = [t.text for t in svg(dial_html(found, 1)).iter("text") if "v-part" in t.attrib["class"]]
    assert told == ["✓ 2 mm →", "✓ done", "40 mm"]


def test_amounts_have_a_sign_and_a_unit(at) -> None:
    found = at(x=12, y=-31, mm=(30, 0, 40))
    assert [amount_text(found, step) for step in (1, 2, 3, 4)] == ["50 mm", "+12°", "−31°", "0°"]
    assert share(-500, 300) == -1 and share(0, 300) == 0


@pytest.mark.parametrize("dark", [True, False])
def test_everything_can_be_told_from_its_ground(dark: bool) -> None:
    """WCAG AA: 4.5 for letters, 3 for large ones and what is drawn."""
    paper, good = ground(dark).background, ground(dark).reached
    assert contrast(good, paper) >= 4.5
    assert contrast(ground(dark).warning, paper) >= 4.5
    for number in (1, 2, 3, 4):
        assert contrast(step_colour(number, dark), paper) >= 4.5
    svg(tick_html())


@pytest.mark.parametrize("aspect", [4 / 3, 3 / 2, 16 / 9, 2.0])
def test_the_picture_has_half_of_a_wide_screen_whatever_its_shape(aspect: float) -> None:
    wide, tall = picture_share(aspect)
    assert wide * 16 / (tall * 9) == pytest.approx(aspect), "no margin inside its place"
    assert wide * tall >= 0.5 and tall < 0.83, "and room is left for two lines of text"


@pytest.fixture
def guided(paper_camera: Camera, default_board: Board, at) -> Snapshot:
    """A snapshot on the way to a target."""
    session = Session(default_board, paper_camera.image_size)
    pixels = paper_camera.project(GOAL.apply(default_board.corners))
    seen = Observation(np.arange(40), pixels, paper_camera.image_size)
    known = session.observe(seen)
    target = Target(
        1, GOAL, at().steps, "global", "projection-variance", (), "", np.zeros(9), 0.1, 0, 0.0
    )
    return matched(replace(known, phase="guiding", target=target, pose=GOAL), at(y=20))


def test_each_state_has_its_sentence(guided: Snapshot, at) -> None:
    assert view_model_of(None).sentence == texts.STARTING[2]
    assert view_model_of(guided, paused=True).sentence == texts.PAUSED[2]
    step = view_model_of(guided)
    assert (step.badge, step.title, step.step) == ("3", "Swing", 3)
    assert step.sentence == step_prompt(at(y=20).steps[2]).holder
    assert view_model_of(matched(guided, at())).title == texts.HOLD_STILL[1]
    assert view_model_of(matched(replace(guided, pose=None), None)).title == texts.NOT_SEEN[1]
    assert view_model_of(replace(guided, phase="captured")).title == texts.THINKING[1]
    assert view_model_of(replace(guided, phase="converged")).title == texts.CONVERGED[1]
    for moment in (
        step,
        view_model_of(None),
        view_model_of(matched(guided, at(mm=(9, 90, 0)))),
    ):
        html = glance_html(moment, guided, dark=True)
        assert moment.sentence.replace(" mm", "\u00a0mm") in html and "<script" not in html
        ElementTree.fromstring(html)


def test_a_view_taken_back_is_told_as_on_the_guide_page(guided: Snapshot, at) -> None:
    """There "Move the board away", here "Hold still"; and also while the hand trembles."""
    there = replace(at(), motion_px=9.0, lingers=True)
    taken_back = replace(matched(guided, there), taken_back=True)
    moment = view_model_of(taken_back)
    assert moment.title == guide_texts.TAKEN_BACK and moment.kind == "wait"
    said = guidance_html(taken_back, ViewState(), Theme(True), NO_NOTE)
    assert moment.sentence in said and texts.HOLD_STILL[2] not in said


def test_a_picture_that_is_old_has_no_steps_beside_it(guided: Snapshot) -> None:
    """Four steps to do stood beside "No new pictures", "Paused" and "Done"."""
    for moment in (
        view_model_of(guided, silent_since="14:05:33"),
        view_model_of(guided, paused=True),
        view_model_of(replace(guided, phase="converged")),
    ):
        assert "v-chip'" not in glance_html(moment, guided, dark=True)
    assert "v-is-silent" in glance_html(
        view_model_of(guided, silent_since="14:05:33"), guided, dark=True
    )
    assert glance_html(view_model_of(guided), guided, dark=True).count("<i class='v-chip") == 4


def test_what_was_achieved_is_told_once(guided: Snapshot, at) -> None:
    """A step that becomes right, a view that is taken; not a skipped target, not a new one."""
    done = matched(guided, at(z=20))
    assert achieved(None, guided) is None and achieved(guided, guided) is None
    cue = achieved(guided, done)
    assert cue is not None and cue[0] == "reached" and cue[1].step == 3
    assert achieved(done, done) is None
    assert guided.target is not None
    other = replace(done, target=replace(guided.target, number=2))
    assert achieved(guided, other) is None

    there = matched(guided, at())
    thinking = replace(guided, phase="captured", captured=(1,))
    taken = achieved(there, thinking)
    assert taken is not None and taken[0] == "captured"
    assert "1 picture captured" in glance_html(taken[1], thinking, dark=True)
    assert "1 picture captured" in glance_html(view_model_of(thinking), thinking, dark=True)
    assert achieved(thinking, replace(guided, captured=(1,))) is None, "told already"
    assert achieved(guided, replace(guided, phase="captured")) is None, "a skipped target"
