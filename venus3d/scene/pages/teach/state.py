"""The state of a teaching page, frozen and shared by all tabs, and its changes. No drawing, threads
or geometry."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, floor

from venus3d.engine.geometry.rotation_orders import ORDERS
from venus3d.lessons.lesson import Arrangement, Lesson, LessonPage, Viewpoint

Vector = tuple[float, float, float, float, float, float]
"""xr, yr, zr in degrees, xt, yt, zt in millimetres."""
SECONDS_PER_STEP = 1.8
SPEEDS: tuple[float, ...] = (0.5, 1.0, 2.0)
FREE_VECTOR: Vector = (25.0, -30.0, 15.0, 60.0, -30.0, 520.0)
_IDLE_HASTE = 6.0  # an idle step is passed quickly
_HOLD = 0.7  # of a step: rest at the target before a loop restarts
_EPS = 1e-6


@dataclass(frozen=True)
class TeachState:
    """Frozen: every change is a new state, so that threads may share it."""

    vector: Vector = FREE_VECTOR
    """The target's pose."""
    progress: float = 4.0
    """0 ... 4 from the upright board to the target: 1.5 is half of step 2."""
    stop_at: float | None = None
    """Where the animation stops; None while it is not playing."""
    focus: int | None = None
    """The step whose number changed last: shown although the board is at the target."""
    dragged: bool = False
    """Whether a person is dragging the progress slider, which must not be moved then."""
    loop: bool = False
    speed: float = 1.0
    arrangement: Arrangement = "place"
    order: str = "zyx"
    """The order of turns compared with "xyz"."""
    viewpoint: Viewpoint = "outside"
    dark: bool = True
    surroundings: bool = True
    """Whether the floor and the figure who holds the board are drawn."""
    all_steps: bool = False
    """Whether the ends of the other steps are drawn too."""
    lessons: tuple[Lesson, ...] = ()
    lesson: int | None = None
    """Number of the lesson; None: free."""
    page: int = 0
    answer: int | None = None
    """1 ...: the answer given to this page's question."""
    pose_version: int = 0
    """Counts the poses not set with the sliders, which must follow them."""

    @property
    def playing(self) -> bool:
        """Whether the animation runs."""
        return self.stop_at is not None

    @property
    def step_and_share(self) -> tuple[int, float]:
        """The board's step, 1 ... 4, and how much of it is done, 0 ... 1; a step that has just
        ended still counts."""
        step = min(max(ceil(self.progress - _EPS), 1), 4)
        return step, min(max(self.progress - (step - 1), 0.0), 1.0)

    @property
    def step(self) -> int:
        """1 ... 4: the step shown."""
        return self.step_and_share[0] if self.focus is None else self.focus

    @property
    def sweep(self) -> float:
        """0 ... 1: how much of that step is done."""
        return self.step_and_share[1] if self.focus is None else 1.0

    @property
    def at_rest(self) -> bool:
        """Whether the board is at its target and no step is selected."""
        return self.progress >= 4.0 - _EPS and self.focus is None

    @property
    def compares(self) -> bool:
        """Whether two results are shown side by side."""
        return self.arrangement in ("axes", "order")

    @property
    def current_lesson(self) -> Lesson | None:
        """The open lesson."""
        return None if self.lesson is None else self.lessons[self.lesson]

    @property
    def current_page(self) -> LessonPage | None:
        """The open page."""
        lesson = self.current_lesson
        return None if lesson is None else lesson.pages[self.page]

    # -- the pose ---------------------------------------------------------------------------------

    def with_vector(self, vector: Vector) -> TeachState:
        """The state with another target and the board at it; shows the step whose number
        changed."""
        changed = [i for i in range(6) if vector[i] != self.vector[i]]
        focus = self.focus if not changed else (changed[0] + 2 if changed[0] < 3 else 1)
        return replace(self._at(4.0), vector=vector, focus=focus)

    def reset(self) -> TeachState:
        """The state with the page's own pose again."""
        page = self.current_page
        vector = FREE_VECTOR if page is None else page.pose
        return replace(self._at(4.0), vector=vector, pose_version=self.pose_version + 1)

    def _at(self, progress: float, stop_at: float | None = None) -> TeachState:
        return replace(self, progress=progress, stop_at=stop_at, focus=None, dragged=False)

    # -- the animation ---------------------------------------------------------------------------

    def play(self, on: bool) -> TeachState:
        """Play to the end, from the start if already there; or stop."""
        if not on:
            return replace(self, stop_at=None)
        return self._at(0.0 if self.progress >= 4.0 - _EPS else self.progress, 4.0)

    def step_on(self) -> TeachState:
        """Play the next step, then stop."""
        if self.progress >= 4.0 - _EPS:
            return self._at(0.0, 1.0)
        return self._at(self.progress, float(floor(self.progress + _EPS) + 1))

    def step_back(self) -> TeachState:
        """Back to the start of this step; from there, to that of the previous one."""
        return self._at(float(max(ceil(min(self.progress, 4.0) - _EPS) - 1, 0)))

    def carried_to(self, share: float) -> TeachState:
        """Move to a `share` (0 ... 1) of the whole path."""
        return replace(self._at(4.0 * min(max(share, 0.0), 1.0)), dragged=True)

    def after(self, seconds: float, idle: tuple[bool, ...]) -> TeachState:
        """The state `seconds` later. `idle`: which steps have nothing to do."""
        if self.stop_at is None:
            return self
        haste = (
            _IDLE_HASTE if self.progress < 4 - _EPS and idle[floor(self.progress + _EPS)] else 1.0
        )
        progress = self.progress + seconds * self.speed * haste / SECONDS_PER_STEP
        if self.loop and self.stop_at == 4.0:
            # Beyond 4 the board rests at the target.
            return replace(self, progress=progress if progress < 4.0 + _HOLD else 0.0)
        if haste > 1:
            progress = min(progress, floor(self.progress + _EPS) + 1.0)
        if progress >= self.stop_at:
            return replace(self, progress=self.stop_at, stop_at=None)
        return replace(self, progress=progress)

    def next_speed(self) -> TeachState:
        """The next speed, cyclically."""
        return replace(self, speed=SPEEDS[(SPEEDS.index(self.speed) + 1) % len(SPEEDS)])

    # -- what is shown ----------------------------------------------------------------------------

    def with_arrangement(self, arrangement: Arrangement) -> TeachState:
        """Show this arrangement; again: back to the steps in place."""
        wanted = "place" if arrangement == self.arrangement else arrangement
        return replace(self, arrangement=wanted)

    def next_order(self) -> TeachState:
        """The next order of turns compared with "xyz"; without a comparison, show it first."""
        if self.arrangement != "order":
            return self.with_arrangement("order")
        others = ORDERS[1:]
        return replace(self, order=others[(others.index(self.order) + 1) % len(others)])

    # -- lessons ----------------------------------------------------------------------------------

    def opened(self, lesson: int | None, page: int = 0) -> TeachState:
        """A page of a lesson, as its author set it; None: free, with a pose of its own."""
        if lesson is None:
            free = replace(self, lesson=None, page=0, answer=None, arrangement="place")
            return replace(free, viewpoint="outside").reset()
        pages = self.lessons[lesson].pages
        shown = pages[min(max(page, 0), len(pages) - 1)]
        return replace(
            self._at(4.0),
            lesson=lesson,
            page=pages.index(shown),
            answer=None,
            vector=shown.pose,
            pose_version=self.pose_version + 1,
            viewpoint=shown.viewpoint,
            arrangement=shown.arrangement,
            order=shown.order or self.order,
        )

    def page_turned(self, pages: int) -> TeachState:
        """Turn some pages forwards or back; past a lesson's end, the next lesson; past the last
        one's, free. From free: the first page."""
        if self.lesson is None:
            return self.opened(0) if self.lessons and pages > 0 else self
        page = self.page + pages
        if page >= len(self.lessons[self.lesson].pages):
            return self.opened(self.lesson + 1 if self.lesson + 1 < len(self.lessons) else None)
        if page < 0:
            if self.lesson == 0:
                return self
            return self.opened(self.lesson - 1, len(self.lessons[self.lesson - 1].pages) - 1)
        return self.opened(self.lesson, page)

    @property
    def ends_lesson(self) -> bool:
        """Whether the next page is another lesson's."""
        return (
            self.lesson is not None
            and self.lesson + 1 < len(self.lessons)
            and self.page + 1 == len(self.lessons[self.lesson].pages)
        )

    def next_lesson(self) -> TeachState:
        """The lesson after this one, cyclically."""
        if not self.lessons:
            return self
        return self.opened(0 if self.lesson is None else (self.lesson + 1) % len(self.lessons))

    def answered(self, number: int) -> TeachState:
        """Answer the page's question; ignored if it has no such answer."""
        page = self.current_page
        if page is None or page.question is None or number > len(page.question.answers):
            return self
        return replace(self, answer=number)
