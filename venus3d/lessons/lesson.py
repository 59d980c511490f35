"""A lesson as values: pages of text, each with a pose, a viewpoint and perhaps a question.

The structs define the lesson file format, checked by msgspec, which is already a dependency and
locates the first mistake. `__post_init__` checks the rest and raises ValueError(key, sentence).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Annotated, Literal, get_args

from msgspec import Meta, Struct

from venus3d.engine.geometry.pose import Pose
from venus3d.languages import Language

Viewpoint = Literal["outside", "camera", "holder", "above"]
"""Viewpoint of the scene: from behind and beside the camera, through it, from the holder's place,
from above."""
VIEWPOINTS: tuple[Viewpoint, ...] = get_args(Viewpoint)
Arrangement = Literal["place", "strip", "axes", "order"]
"""place: the steps in place, one at a time. strip: all four side by side. axes: the same angles
about the camera's fixed axes and about the board's own, side by side. order: the same three turns
in two orders, side by side."""
Extra = Literal["sigma", "distortion"]
"""sigma: how well views like this one determine the focal length, live. distortion: the lens
distortion over the image."""
EXTRAS: tuple[Extra, ...] = get_args(Extra)
OtherOrder = Literal["xzy", "yxz", "yzx", "zxy", "zyx"]
"""An order of turns that can be shown beside "xyz"."""
Text = Annotated[str, Meta(min_length=1)]
POSE_RANGES = (
    ("xr", -180, 180, "°"),
    ("yr", -180, 180, "°"),
    ("zr", -180, 180, "°"),
    ("xt", -2000, 2000, " mm"),
    ("yt", -2000, 2000, " mm"),
    ("zt", 50, 3000, " mm"),
)
"""Name, minimum, maximum and unit of a pose's six numbers. Wide, as a lesson may show a pose that
the engine's limits refuse."""


class Question(Struct, frozen=True, forbid_unknown_fields=True):
    """A question with answers to choose from."""

    text: Text
    answers: Annotated[tuple[Text, ...], Meta(min_length=2)]
    right: int
    """1 ...: the right answer."""
    why: Text
    """Shown after an answer."""

    def __post_init__(self) -> None:
        count = len(self.answers)
        if not 1 <= self.right <= count:
            raise ValueError(
                "right",
                f"right says which of the answers is right, from 1 to {count}; here it is "
                f"{self.right}",
            )


class LessonPage(Struct, frozen=True, forbid_unknown_fields=True):
    """One screen of a lesson."""

    title: Text
    text: Text
    """Markdown, short."""
    pose: tuple[float, float, float, float, float, float]
    """xr, yr, zr in degrees, xt, yt, zt in millimetres: the board's target on this page."""
    viewpoint: Viewpoint = "outside"
    arrangement: Arrangement = "place"
    order: OtherOrder | None = None
    """For the arrangement "order": the order of turns that is shown beside "xyz"."""
    show: tuple[Extra, ...] = ()
    question: Question | None = None

    def __post_init__(self) -> None:
        for value, (name, low, high, unit) in zip(self.pose, POSE_RANGES, strict=True):
            if not isfinite(value):
                raise ValueError("pose", f"{name} of the pose is a number, not {value}")
            if not low <= value <= high:
                raise ValueError(
                    "pose",
                    f"{name} of the pose is {value:g}{unit}; it must be from {low} to {high}{unit}",
                )
        if (self.arrangement == "order") != (self.order is not None):
            raise ValueError(
                "arrangement" if self.order is None else "order",
                'arrangement = "order" and order belong together: say which order of turns is '
                'shown beside xyz, such as order = "zyx"',
            )

    @property
    def target(self) -> Pose:
        """The page's pose, `T_camera_board`."""
        *angles, x, y, z = self.pose
        return Pose.from_vector([*angles, x / 1000, y / 1000, z / 1000])


class LessonFile(Struct, frozen=True, forbid_unknown_fields=True):
    """The content of a lesson file."""

    title: Text
    summary: Text
    page: Annotated[tuple[LessonPage, ...], Meta(min_length=1)]
    language: Language | None = None
    """Of its texts; the page speaks it while the lesson is open."""


@dataclass(frozen=True)
class Lesson:
    """A lesson: one file."""

    name: str
    """The file's name without suffix."""
    title: str
    summary: str
    """One sentence: what the learner understands afterwards."""
    pages: tuple[LessonPage, ...]
    language: Language | None = None
    """Of its texts, if it is stated."""
