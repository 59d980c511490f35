"""What a person may ask of a teaching page, by button, key, palette or slider, and how it changes
the page's state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum, auto
from typing import Literal, get_args

from venus3d.lessons.lesson import VIEWPOINTS, Arrangement, Viewpoint
from venus3d.scene.pages.teach.state import TeachState, Vector

FileKind = Literal["html", "png", "mp4", "gif"]
"""File types of a saved lesson."""
FILE_KINDS: tuple[FileKind, ...] = get_args(FileKind)


class PageAction(Enum):
    """Actions without a value."""

    PLAY = auto()
    NEXT_STEP = auto()
    PREVIOUS_STEP = auto()
    SPEED = auto()
    LOOP = auto()
    NEXT_ORDER = auto()
    NEXT_PAGE = auto()
    PREVIOUS_PAGE = auto()
    NEXT_LESSON = auto()
    FREE = auto()
    RESET = auto()
    BRIGHTNESS = auto()
    LEAD = auto()
    """Lead the class, or let go."""
    MENU = auto()
    """Open or close this tab's menu."""
    SURROUNDINGS = auto()
    ALL_STEPS = auto()


@dataclass(frozen=True)
class LookFrom:
    """View the scene from here."""

    viewpoint: Viewpoint | None
    """None: the next one."""


@dataclass(frozen=True)
class Arrange:
    """Show this arrangement; again: back to the steps in place."""

    arrangement: Arrangement


@dataclass(frozen=True)
class Answer:
    """Answer the page's question."""

    number: int
    """1 ...: number of the answer."""


@dataclass(frozen=True)
class Save:
    """Save the lesson or the pose as a file."""

    kind: FileKind


Action = PageAction | LookFrom | Arrange | Answer | Save


@dataclass(frozen=True)
class SetPose:
    """Set the target's six numbers."""

    vector: Vector


@dataclass(frozen=True)
class OpenLesson:
    """Open this lesson; None: free."""

    number: int | None


@dataclass(frozen=True)
class CarryTo:
    """Carry the board to this share of its way, 0 ... 1."""

    share: float


Request = Action | SetPose | OpenLesson | CarryTo
_CHANGES: dict[PageAction, Callable[[TeachState], TeachState]] = {
    PageAction.PLAY: lambda state: state.play(not state.playing),
    PageAction.NEXT_STEP: TeachState.step_on,
    PageAction.PREVIOUS_STEP: TeachState.step_back,
    PageAction.SPEED: TeachState.next_speed,
    PageAction.LOOP: lambda state: replace(state, loop=not state.loop),
    PageAction.NEXT_ORDER: TeachState.next_order,
    PageAction.NEXT_PAGE: lambda state: state.page_turned(1),
    PageAction.PREVIOUS_PAGE: lambda state: state.page_turned(-1),
    PageAction.NEXT_LESSON: TeachState.next_lesson,
    PageAction.FREE: lambda state: state.opened(None),
    PageAction.RESET: TeachState.reset,
    PageAction.BRIGHTNESS: lambda state: replace(state, dark=not state.dark),
    PageAction.LEAD: lambda state: state,
    PageAction.MENU: lambda state: state,
    PageAction.SURROUNDINGS: lambda state: replace(state, surroundings=not state.surroundings),
    PageAction.ALL_STEPS: lambda state: replace(state, all_steps=not state.all_steps),
}


def after_action(state: TeachState, request: Request) -> TeachState:
    """The state after the request. Menu, saving and leading change nothing in it."""
    match request:
        case PageAction():
            return _CHANGES[request](state)
        case LookFrom(None):
            number = VIEWPOINTS.index(state.viewpoint) + 1
            return replace(state, viewpoint=VIEWPOINTS[number % len(VIEWPOINTS)])
        case LookFrom(viewpoint):
            return replace(state, viewpoint=viewpoint)
        case Arrange(arrangement):
            return state.with_arrangement(arrangement)
        case Answer(number):
            return state.answered(number)
        case SetPose(vector):
            return state.with_vector(vector)
        case OpenLesson(number):
            return state.opened(number)
        case CarryTo(share):
            return state.carried_to(share)
        case Save():
            return state
