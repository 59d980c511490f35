"""Every tab is its own learner; a class follows the tab that leads it, and only that one."""

from __future__ import annotations

import numpy as np
import pytest
from websockets import Headers

from tests.scene.raw_client import RawClient
from tests.scene.teach_server import served_teaching
from tests.waiting import wait_until
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.languages import Language
from venus3d.lessons.reading import shipped_lessons
from venus3d.render.offscreen import Offscreen
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.pages.teach.actions import Answer, CarryTo, LookFrom, PageAction, SetPose
from venus3d.scene.pages.teach.learner import AWAY_S, Classroom, Learner, Look
from venus3d.scene.pages.teach.state import FREE_VECTOR, TeachState
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.handshake import came_from_here

OTHER = (*FREE_VECTOR[:1], 12.0, *FREE_VECTOR[2:])
LOOK: Look = (SceneCamera(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.7), 1.5)


class Class:
    """Some tabs of one class, and a clock."""

    def __init__(self, analyse: PoseAnalysis) -> None:
        self.analyse, self.now_s = analyse, 100.0
        self.tabs: dict[int, Learner] = {}
        self.room = Classroom(lambda: set(self.tabs))

    def join(self, number: int, *, here: bool = False, language: Language = "en") -> Learner:
        state = TeachState(lessons=shipped_lessons(language)).opened(0)
        self.tabs[number] = Learner(
            self.analyse,
            state,
            number=number,
            room=self.room,
            may_lead=here,
            look=lambda: LOOK,
        )
        self.tick()
        return self.tabs[number]

    def tick(self, seconds: float = 0.1, rounds: int = 2) -> None:
        for _ in range(rounds):  # the leading tab may come after those that follow
            self.now_s += seconds
            for learner in self.tabs.values():
                learner.tick(self.now_s)


@pytest.fixture
def analyse(paper_camera: Camera, default_board: Board) -> PoseAnalysis:
    return PoseAnalysis(paper_camera, default_board)


def test_without_a_class_every_tab_goes_its_own_way(analyse: PoseAnalysis) -> None:
    one, other = (Learner(analyse, TeachState(lessons=shipped_lessons())) for _ in "ab")
    one.handle(PageAction.NEXT_PAGE)
    one.handle(SetPose(OTHER))
    for now_s in (0.0, 0.1):
        one.tick(now_s), other.tick(now_s)
    assert one.state.lesson == 0 and other.state.lesson is None
    assert one.view().role == other.view().role == "alone"
    one.handle(PageAction.LEAD)
    assert other.view().role == "alone"


def test_the_class_follows_the_first_tab_on_this_machine(analyse: PoseAnalysis) -> None:
    room = Class(analyse)
    early = room.join(1)
    assert early.view().role == "alone", "nobody leads yet"
    teacher = room.join(2, here=True)
    late, screen = room.join(3), room.join(4, here=True)
    assert [one.view().role for one in (early, teacher, late, screen)] == [
        *("follows", "leads", "follows", "follows")
    ]
    assert teacher.view().others == 3
    teacher.handle(PageAction.NEXT_PAGE)
    teacher.handle(SetPose(OTHER))
    teacher.handle(LookFrom("holder"))
    teacher.handle(CarryTo(0.4))
    room.tick()
    for one in (early, late, screen):
        state = one.state
        assert (state.lesson, state.page, state.vector) == (0, 1, OTHER)
        assert (state.viewpoint, state.progress) == ("holder", pytest.approx(1.6))
        assert not state.dragged, "its own slider must follow"
        assert one.view().look is LOOK
        assert one.view() is one.view(), "drawn once"
    teacher.handle(PageAction.PLAY)
    room.tick(0.2)
    assert early.state.playing and late.state.progress == teacher.state.progress > 1.7
    teacher.handle(PageAction.PLAY)
    room.tick(0.2)
    assert early.state.progress == teacher.state.progress < 2.0, "not played twice"


def test_each_tab_reads_the_same_page_in_its_own_language(analyse: PoseAnalysis) -> None:
    room = Class(analyse)
    teacher, german = room.join(1, here=True), room.join(2, language="de")
    teacher.handle(PageAction.NEXT_PAGE)
    room.tick()
    assert german.state.current_page == shipped_lessons("de")[0].pages[1]
    assert german.state.vector == teacher.state.vector
    assert german.view() is german.view(), "drawn once"


def test_a_server_that_stood_still_plays_on_where_it_was(analyse: PoseAnalysis) -> None:
    learner = Learner(analyse, TeachState())
    learner.tick(1.0)
    learner.handle(PageAction.PLAY)
    begun = learner.state.progress
    learner.tick(30.0)
    assert learner.state.playing, "no step is left out"
    assert begun < learner.state.progress < begun + 1


def test_whoever_follows_changes_nothing_but_answer_and_brightness(analyse: PoseAnalysis) -> None:
    room = Class(analyse)
    teacher, pupil, other = room.join(1, here=True), room.join(2), room.join(3)
    teacher.handle(PageAction.NEXT_PAGE)
    room.tick()
    before = pupil.state
    for request in (
        *(action for action in PageAction if action is not PageAction.BRIGHTNESS),
        LookFrom("above"),
        SetPose(OTHER),
        CarryTo(0.1),
    ):
        pupil.handle(request)
        room.tick()
        assert pupil.state == before and room.room.leader == 1, request
    pupil.handle(Answer(2)), pupil.handle(PageAction.BRIGHTNESS)
    room.tick()
    assert pupil.state.answer == 2 and pupil.state.dark != teacher.state.dark
    assert teacher.state.answer is None and other.state.answer is None
    teacher.handle(PageAction.NEXT_PAGE)
    room.tick()
    assert pupil.state.answer is None and pupil.state.page == teacher.state.page


def test_the_teacher_lets_go_and_leads_again(analyse: PoseAnalysis) -> None:
    room = Class(analyse)
    teacher, pupil = room.join(1, here=True), room.join(2)
    teacher.handle(PageAction.NEXT_PAGE)
    room.tick()
    teacher.handle(PageAction.LEAD)
    room.tick()
    assert (teacher.view().role, pupil.view().role) == ("may-lead", "alone")
    assert pupil.state.page == 1, "it goes on from where it was"
    pupil.handle(PageAction.NEXT_PAGE)
    room.tick()
    assert (pupil.state.page, teacher.state.page) == (2, 1)
    assert room.join(3, here=True).view().role == "may-lead", "nobody leads by just coming"
    teacher.handle(PageAction.LEAD)
    room.tick()
    assert pupil.state.page == 1 and pupil.view().role == "follows"
    room.tabs[3].handle(PageAction.LEAD)
    room.tick()
    assert teacher.view().role == "follows", "the lead can be taken over on this machine"


def test_a_teacher_who_reloads_goes_on_leading_and_one_who_leaves_lets_go(
    analyse: PoseAnalysis,
) -> None:
    room = Class(analyse)
    room.join(1, here=True).handle(PageAction.NEXT_PAGE)
    pupil = room.join(2)
    del room.tabs[1]
    room.tick(1.0)
    assert pupil.view().role == "follows", "it may only be a reload"
    again = room.join(3, here=True)
    assert again.view().role == "leads" and again.state.page == pupil.state.page == 1
    del room.tabs[3]
    room.tick(AWAY_S + 1)
    assert pupil.view().role == "alone"
    pupil.handle(PageAction.NEXT_PAGE)
    assert pupil.state.page == 2


@pytest.mark.parametrize(
    ("peer", "headers", "here"),
    [
        ("127.0.0.1", {}, True),
        ("::1", {}, True),
        ("::ffff:127.0.0.1", {}, True),
        ("192.168.1.20", {}, False),
        ("::ffff:192.168.1.20", {}, False),
        ("127.0.0.1", {"X-Forwarded-For": "192.168.1.20"}, False),
        ("127.0.0.1", {"Forwarded": "for=192.168.1.20"}, False),
        ("127.0.0.1", {"Via": "1.1 proxy"}, False),
        ("", {}, False),
    ],
)
def test_only_a_browser_on_this_machine_may_lead(
    peer: str, headers: dict[str, str], here: bool
) -> None:
    assert came_from_here(Headers(headers), peer) is here


@pytest.mark.parametrize("follow_me", [False, True])
def test_two_tabs_of_a_server(follow_me: bool, analyse: PoseAnalysis, painter: Offscreen) -> None:
    lessons = shipped_lessons()
    with (
        served_teaching(analyse, painter, lessons=lessons, lesson=0, follow_me=follow_me) as teach,
        RawClient(teach.port) as one,
    ):
        one.look()
        first = teach.learner()
        with RawClient(teach.port) as other:
            other.look()
            second = teach.learner(1)
            first.change(lambda state: state.opened(1).page_turned(1))
            if follow_me:
                wait_until(lambda: second.state.page == 1, "the class follows")
                assert (second.state.lesson, second.view().role) == (1, "follows")
            else:
                wait_until(lambda: first.view() is teach.server.tabs[0].shown, "it is drawn")
                assert (second.state.lesson, second.state.page) == (0, 0)
