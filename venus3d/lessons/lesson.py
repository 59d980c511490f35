"""A lesson as values: pages of text, each with a pose, a view and perhaps a question.

Nothing in here reads files (`reading` does) or draws.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from venus3d.engine.geometry.pose import Pose

Viewpoint = Literal["outside", "camera", "holder", "above"]
"""Where the scene is looked at from: behind and beside the camera, through it, from where the
person with the board stands, from above."""
VIEWPOINTS: tuple[Viewpoint, ...] = get_args(Viewpoint)
Arrangement = Literal["place", "strip", "axes", "order"]
"""place: the steps where they happen, one at a time. strip: all four side by side. axes: the same
numbers about the camera's fixed axes and about the board's own, side by side. order: the same three
turns in two orders, side by side."""
ARRANGEMENTS: tuple[Arrangement, ...] = get_args(Arrangement)
Extra = Literal["sigma", "distortion"]
"""sigma: how well views like this one tell the focal length, live. distortion: where the lens
bends the picture, and by how much."""
EXTRAS: tuple[Extra, ...] = get_args(Extra)


@dataclass(frozen=True)
class Question:
    """A question with answers to choose from."""

    text: str
    answers: tuple[str, ...]
    right: int
    """1 ...: which answer is right."""
    why: str
    """Told once an answer was given."""


@dataclass(frozen=True)
class LessonPage:
    """One screen of a lesson."""

    title: str
    text: str
    """Markdown, short."""
    pose: tuple[float, float, float, float, float, float]
    """xr, yr, zr in degrees, xt, yt, zt in millimetres: the board's target on this page."""
    viewpoint: Viewpoint = "outside"
    arrangement: Arrangement = "place"
    order: str = "xyz"
    """For the arrangement "order": the order of turns that is shown beside "xyz"."""
    show: tuple[Extra, ...] = ()
    question: Question | None = None

    @property
    def target(self) -> Pose:
        """The page's pose, `T_camera_board`."""
        *angles, x, y, z = self.pose
        return Pose.from_vector([*angles, x / 1000, y / 1000, z / 1000])


@dataclass(frozen=True)
class Lesson:
    """A lesson: one file."""

    name: str
    """The file's name without its ending."""
    title: str
    summary: str
    """One sentence: what is understood afterwards."""
    pages: tuple[LessonPage, ...]
