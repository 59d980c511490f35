"""Labels in the scene: pictures of dark pills that face the person.

viser's own labels are black on white and only stand in where tabs look from different points, since
a pill can face only one, and in a recording. (Its HTML in the scene, which would do better, raises
an error in the browser in viser 1.1.)
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.label_places import PILL_PX, places_apart
from venus3d.render.shapes import LabelShape
from venus3d.render.text_drawing import pill_picture
from venus3d.render.viewpoints import SceneCamera

_PLAIN_SCALE = 1.25
_UNIT_M = 7e-5
"""Size in the scene of a pixel of a pill's picture, metres. It never changes: a pill is as large as
on paper at one distance from the eye, 0.2 m in a window of 1080 px, before everything else. A
browser comes to a node's scale later than to its position, on a slow machine by seconds: a pill
that was scaled was too large until then."""
_NOWHERE = np.full(7, np.nan)
_FINE = 2
"""Pixels of a pill's picture for one on the screen."""
_STAYS_S, _ARRIVES_S = 0.25, 0.15
"""A browser shows a new picture later than what comes with it, and a white card before the first.
So an amount is not shown while it changes: its picture is sent once it has stayed, and shown when
that has come."""


class SceneLabel:
    """A label at a point in space."""

    def __init__(self, host: viser.ViserServer | viser.ClientHandle, shape: LabelShape) -> None:
        """A label that is not visible yet."""
        self._scene, self._name = host.scene, shape.name
        self._shape, self._visible = shape, False
        self._plain: Any = None
        self._pill: Any = None
        self._word: Any = None
        """The pill that stands in while the text changes."""
        self._looks: dict[str, tuple[str, tuple[int, int, int], int]] = {}
        self._placed: dict[str, Array] = {}
        """(7,) where the two are: quaternion, position."""
        self._sent_s: dict[str, float] = {}
        """What the pictures of the two show, and when they were sent."""
        self._changed_s = -np.inf
        self._is_changing = False

    def show(self, shape: LabelShape) -> None:
        """Show another text or colour."""
        if self._plain is not None and shape.text != self._shape.text:
            self._plain.text = shape.text
        if shape.in_motion and shape.text != self._shape.text:
            self._changed_s = time.monotonic()
        self._shape = shape

    @property
    def text(self) -> str:
        """What it says."""
        return self._shape.text

    @property
    def visible(self) -> bool:
        """Whether it is shown."""
        return self._visible

    @visible.setter
    def visible(self, on: bool) -> None:
        self._visible = on
        if not on:
            self._show_only(None)

    @property
    def is_changing(self) -> bool:
        """Whether its pill does not say the text yet."""
        return self._visible and self._is_changing

    @property
    def is_due(self) -> bool:
        """Whether the text has stayed, so that the pill is to be placed again."""
        return self.is_changing and time.monotonic() - self._changed_s >= _STAYS_S

    def put_plain(self) -> None:
        """Show viser's own label, which all tabs can see."""
        if self._plain is None:
            self._plain = self._scene.add_label(
                self._name,
                self._shape.text,
                font_screen_scale=_PLAIN_SCALE,
                anchor="center-center",
            )
        self._plain.position = tuple(self._shape.position)
        self._is_changing = False
        self._show_only(self._plain)

    def put_pill(
        self, place: Array, view: SceneCamera, facing: Array, metres_per_px: float
    ) -> None:
        """Show the pill at `place` (3,), camera frame, as large in this view as on paper.

        Args:
            facing: (4,) quaternion, scalar first, of what faces the view.
            metres_per_px: a pixel's size one metre before the eye.
        """
        depth = float(view.axes[2] @ (place - view.position))
        share = _FINE * _UNIT_M / metres_per_px / depth if depth > 0 else 1.0
        stays = time.monotonic() - self._changed_s >= _STAYS_S
        if self._pill is None or stays:
            self._pill = self._pictured(self._pill, "pill", self._shape.text)
        else:  # a browser that loads the next amount late shows the word, not the last amount
            self._pictured(self._pill, "pill", self._shape.in_motion)
        said = self._looks["pill"][0] == self._shape.text and self._has_come("pill")
        self._is_changing, node, kind = not said, self._pill, "pill"
        if not said and self._shape.in_motion:
            kind = "word"
            node = self._word = self._pictured(self._word, kind, self._shape.in_motion)
        where = np.array([*facing, *(view.position + share * (place - view.position))])
        if not np.array_equal(self._placed.get(kind, _NOWHERE), where):
            # Finding out that nothing has changed takes viser a hundred times as long.
            self._placed[kind] = where
            node.wxyz, node.position = where[:4], where[4:]
        self._show_only(node if said or self._has_come("word") else None)

    def _has_come(self, kind: str) -> bool:
        """Whether the browser has had the time to load this pill's picture."""
        return time.monotonic() - self._sent_s.get(kind, np.inf) >= _ARRIVES_S

    def _pictured(self, node: Any, kind: str, text: str) -> Any:
        """The pill, made if there is none, with this text in the shape's colour."""
        look = text, self._shape.colour, round(_FINE * PILL_PX)
        if self._looks.get(kind) == look:
            return node
        self._looks[kind] = look
        if node is None or self._shape.in_motion:
            self._sent_s[kind] = time.monotonic()
        picture = pill_picture(*look)
        height, width = (side * _UNIT_M for side in picture.shape[:2])
        if node is None:
            name = f"{self._name}_{kind}"
            return self._scene.add_image(
                name, picture, width, height, cast_shadow=False, visible=False
            )
        node.image, node.render_width = picture, width
        return node

    def _show_only(self, shown: Any) -> None:
        for node in (self._plain, self._pill, self._word):
            if node is not None:
                node.visible = node is shown

    def remove(self) -> None:
        """Take it out of the scene."""
        for node in (self._plain, self._pill, self._word):
            if node is not None:
                node.remove()


def put_labels(
    labels: Sequence[tuple[LabelShape, SceneLabel]],
    view: SceneCamera | None,
    window_px: tuple[int, int],
    tips: Sequence[Array] = (),
    shafts: Array | None = None,
) -> None:
    """Place these labels: pills that face this view and cover neither each other nor the arrows
    (`places_apart`); viser's own without a view."""
    if view is None:
        for _, label in labels:
            label.put_plain()
        return
    metres_per_px = 2 * float(np.tan(view.fov_rad / 2)) / max(window_px[1], 1)
    facing = Pose(view.axes.T, view.position).wxyz
    places = places_apart([shape for shape, _ in labels], view, window_px, tips, shafts)
    for (_, label), place in zip(labels, places, strict=True):
        label.put_pill(place, view, facing, metres_per_px)
