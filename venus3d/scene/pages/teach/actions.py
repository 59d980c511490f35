"""What a person can ask of a teaching page, by button, key or palette, and what it changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum, auto
from typing import Literal, get_args

from venus3d.lessons.lesson import Arrangement, Viewpoint
from venus3d.scene.pages.teach.state import TeachState

FileKind = Literal["html", "png", "mp4", "gif"]
"""What a lesson can be saved as."""
FILE_KINDS: tuple[FileKind, ...] = get_args(FileKind)


class PageAction(Enum):
    """Actions that need no value."""

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


@dataclass(frozen=True)
class LookFrom:
    """Look at the scene from here."""

    viewpoint: Viewpoint


@dataclass(frozen=True)
class Arrange:
    """Show this arrangement; once more: the steps in place again."""

    arrangement: Arrangement


@dataclass(frozen=True)
class Answer:
    """Answer the page's question."""

    number: int
    """1 ...: which answer."""


@dataclass(frozen=True)
class Save:
    """Save the lesson, or the pose, as a file."""

    kind: FileKind


Action = PageAction | LookFrom | Arrange | Answer | Save
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
}


def after_action(state: TeachState, action: Action) -> TeachState:
    """What is shown then; saving a file changes nothing on the page."""
    match action:
        case PageAction():
            return _CHANGES[action](state)
        case LookFrom(viewpoint):
            return replace(state, viewpoint=viewpoint)
        case Arrange(arrangement):
            return state.with_arrangement(arrangement)
        case Answer(number):
            return state.answered(number)
        case Save():
            return state
