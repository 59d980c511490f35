"""What one tab is taught, and, with --follow-me, who leads the class.

Every tab has a `Learner` of its own. In a `Classroom`, the leading tab's lesson, page, pose and
point of view are shown in all others, where only answers and the brightness remain one's own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from threading import Lock
from typing import Literal

import numpy as np

from venus3d.languages import Language
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.pages.teach.actions import Answer, PageAction, Request, after_action
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import AnalysePose, TaughtPose

Role = Literal["alone", "leads", "follows", "may-lead"]
"""alone: no class, or one that was let go. may-lead: the same, in a tab that may lead it."""
Look = tuple[SceneCamera, float]
"""A tab's point of view, and its window's width over height."""
AWAY_S = 10.0
"""Seconds without the leading tab (it is being reloaded) after which the class is let go."""
_MOST_PLAYED_S = 0.25
"""Most that the animation moves on at once: a server that stood still leaves out no step."""


@dataclass(frozen=True, eq=False)
class TabView:
    """What one tab shows."""

    state: TeachState
    taught: TaughtPose
    role: Role = "alone"
    may_lead: bool = False
    """Whether this tab may take the lead, or has it."""
    others: int = 0
    """Number of the other tabs, for the one that leads."""
    look: Look | None = None
    """The leading tab's point of view, for those that follow."""


@dataclass
class Classroom:
    """Who leads the tabs of one server, and what that tab shows. Used by one thread."""

    tabs: Callable[[], set[int]]
    """The numbers of the open tabs."""
    leader: int | None = None
    state: TeachState | None = None
    """What the leading tab shows, or showed last."""
    look: Look | None = None
    let_go: bool = False
    """Whether the class was let go on purpose: then nobody leads by just coming."""
    seen_s: float = 0.0
    """When the leading tab was open last."""

    def lead(self, number: int, state: TeachState) -> None:
        """Let this tab lead."""
        self.leader, self.state, self.look, self.let_go = number, state, None, False

    def show(self, state: TeachState, look: Look | None, now_s: float) -> None:
        """Called by the leading tab with what it shows."""
        self.state, self.seen_s = state, now_s
        if look is not None and (self.look is None or _differ(look, self.look)):
            self.look = look

    def is_led(self, now_s: float) -> bool:
        """Whether somebody leads: a tab that is open, or was a moment ago."""
        if self.leader not in self.tabs() and now_s - self.seen_s > AWAY_S:
            self.leader = None
        return self.leader is not None


class Learner:
    """One tab's state, changed by its person and by time. Any thread may call `change`."""

    def __init__(
        self,
        analyse: AnalysePose,
        state: TeachState,
        *,
        number: int = 0,
        room: Classroom | None = None,
        may_lead: bool = False,
        look: Callable[[], Look | None] = lambda: None,
    ) -> None:
        """
        Args:
            analyse: called with each new pose; a few milliseconds at most.
            number: the tab's.
            room: the class this tab belongs to; None: everybody learns alone.
            may_lead: whether this tab may lead the class.
            look: the tab's point of view now.
        """
        self._analyse, self._number, self._room = analyse, number, room
        self._may_lead, self._look = may_lead and room is not None, look
        self._state = state
        self._lock = Lock()
        self._now_s: float | None = None
        self._view: TabView | None = None

    @property
    def state(self) -> TeachState:
        """The state shown."""
        return self._state

    @property
    def language(self) -> Language | None:
        """The open lesson's, if it states one."""
        lesson = self._state.current_lesson
        return None if lesson is None else lesson.language

    def change(self, change: Callable[[TeachState], TeachState]) -> TeachState:
        """Change the state and return the new one."""
        with self._lock:
            self._state = change(self._state)
            return self._state

    def handle(self, request: Request) -> None:
        """Carry out a person's request, as far as the person's role permits."""
        if request is PageAction.LEAD:
            self._lead_or_let_go()
        elif not self._follows or request is PageAction.BRIGHTNESS or isinstance(request, Answer):
            self.change(lambda state: after_action(state, request))

    def tick(self, now_s: float) -> None:
        """Advance the clock: the animation, or what the leading tab shows."""
        is_new, seconds = self._now_s is None, now_s - (self._now_s or now_s)
        self._now_s = now_s
        room = self._room
        # The first tab leads, and one that is reloaded goes on leading.
        may_begin = self._may_lead and is_new and room is not None and not room.let_go
        if room is not None and may_begin and room.leader not in room.tabs():
            self.change(lambda state: _followed(state, room.state))
            room.lead(self._number, self._state)
        if self._state.playing and not self._follows:
            idle = self.view().taught.idle(self._state.arrangement)
            played = min(seconds, _MOST_PLAYED_S)
            self.change(lambda state: state.after(played, idle))
        if room is not None and room.is_led(now_s):
            if room.leader == self._number:
                room.show(self._state, self._look(), now_s)
            else:
                self.change(lambda state: _followed(state, room.state))

    def view(self) -> TabView:
        """What is to be shown now; the same object until something has changed."""
        state, room, role = self._state, self._room, self._role
        look = room.look if room is not None and role == "follows" else None
        others = len(room.tabs()) - 1 if room is not None and role == "leads" else 0
        view = self._view
        if (
            view is None
            or (view.state, view.role, view.others) != (state, role, others)
            or view.look is not look
        ):
            taught = self._analyse(state.vector, state.order)
            view = self._view = TabView(state, taught, role, self._may_lead, others, look)
        return view

    @property
    def last_view(self) -> TabView:
        """The view made last, for other threads."""
        return self._view or self.view()

    @property
    def _role(self) -> Role:
        leader = None if self._room is None else self._room.leader
        if leader is None:
            return "may-lead" if self._may_lead else "alone"
        return "leads" if leader == self._number else "follows"

    @property
    def _follows(self) -> bool:
        return self._role == "follows"

    def _lead_or_let_go(self) -> None:
        if self._room is None or not self._may_lead:
            return
        if self._role == "leads":
            self._room.leader, self._room.let_go = None, True
        else:
            self._room.lead(self._number, self._state)


def _followed(mine: TeachState, theirs: TeachState | None) -> TeachState:
    """The leading tab's state with what remains one's own: answer, brightness, the lessons'
    language."""
    if theirs is None:
        return mine
    same_page = (mine.lesson, mine.page) == (theirs.lesson, theirs.page)
    followed = replace(
        theirs,
        lessons=mine.lessons if _same_pages(mine, theirs) else theirs.lessons,
        dark=mine.dark,
        answer=mine.answer if same_page else None,
        dragged=False,
        # The sliders follow too, though nobody here has moved them.
        pose_version=mine.pose_version + (mine.vector != theirs.vector),
    )
    return mine if followed == mine else followed


def _same_pages(one: TeachState, other: TeachState) -> bool:
    """Whether both have the same lessons, in whatever language."""
    first, second = ([(k.name, len(k.pages)) for k in state.lessons] for state in (one, other))
    return first == second


def _differ(one: Look, other: Look) -> bool:
    (a, a_aspect), (b, b_aspect) = one, other
    places = np.array([a.position - b.position, a.look_at - b.look_at])
    return bool(np.abs(places).max() > 1e-6) or (a.fov_rad, a_aspect) != (b.fov_rad, b_aspect)
