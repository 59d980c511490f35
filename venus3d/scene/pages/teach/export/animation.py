"""The exported pages of a lesson, and the board's path through the steps on each. The states are
those the teaching page plays; `film` and `files` draw them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from venus3d.lessons.lesson import Lesson, LessonPage
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import AnalysePose, TaughtPose

_BEFORE_S, _AFTER_S = 0.6, 1.4
"""Seconds for which the upright board and the target are shown."""


@dataclass(frozen=True, eq=False)
class ExportedPage:
    """A lesson's page as the teaching page opens it."""

    page: LessonPage
    state: TeachState
    taught: TaughtPose

    @property
    def is_idle(self) -> bool:
        """Whether no step has anything to do."""
        return all(step.is_idle for step in self.taught.steps)


def exported_pages(lesson: Lesson, analyse: AnalysePose, *, dark: bool) -> list[ExportedPage]:
    """All pages of a lesson, in order."""
    opened = TeachState(lessons=(lesson,), dark=dark)
    states = [opened.opened(0, number) for number in range(len(lesson.pages))]
    return [
        ExportedPage(page, state, analyse(state.vector, state.order))
        for page, state in zip(lesson.pages, states, strict=True)
    ]


def animation_states(page: ExportedPage, fps: float) -> tuple[TeachState, ...]:
    """One state per frame: upright, through the steps at the page's pace, target; a single pose if
    there is nothing to do."""
    idle = page.taught.idle(page.state.arrangement)
    start = replace(page.state, progress=0.0, focus=None, speed=1.0, loop=False)
    states = [start] * round(_BEFORE_S * fps)
    if not all(idle):
        now = start.play(True)
        while now.playing:
            now = now.after(1 / fps, idle)
            states.append(now)
    return (*states, *([replace(states[-1], progress=4.0, stop_at=None)] * round(_AFTER_S * fps)))
