"""The way of a board from the upright one to a page's pose, as the moments of a film.

The same states that the teaching page plays; how they are drawn is `film`'s and `scene3d`'s.
"""

from __future__ import annotations

from dataclasses import replace

from venus3d.lessons.lesson import Lesson
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TeachMoment

_BEFORE_S, _AFTER_S = 0.6, 1.4
"""How long the upright board and the target are looked at."""


def opened(lesson: Lesson, page: int, *, dark: bool) -> TeachState:
    """The teaching page's state when this page of the lesson is opened."""
    return TeachState(lessons=(lesson,), dark=dark).opened(0, page)


def journey(moment: TeachMoment, state: TeachState, fps: float) -> tuple[TeachState, ...]:
    """One state for each picture: upright, through the steps at the page's own pace, target.

    A pose with nothing to do stands still.
    """
    idle = moment.idle(state.arrangement)
    start = replace(state, way=0.0, focus=None, speed=1.0, loop=False)
    states = [start] * round(_BEFORE_S * fps)
    if not all(idle):
        now = start.play(True)
        while now.playing:
            now = now.after(1 / fps, idle)
            states.append(now)
    return (*states, *([replace(states[-1], way=4.0, until=None)] * round(_AFTER_S * fps)))
