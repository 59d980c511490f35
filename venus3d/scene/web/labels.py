"""Labels in the scene: pictures of dark pills that face the person.

viser's own labels are black on white and only stand in where tabs look from different points, since
a pill can face only one, and in a recording. (Its HTML in the scene, which would do better, raises
an error in the browser in viser 1.1.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.label_places import HEIGHT_PX, places_apart
from venus3d.render.shapes import LabelShape
from venus3d.render.text_drawing import pill_picture
from venus3d.render.viewpoints import SceneCamera

_PLAIN_SCALE = 1.25
_NEARER = 0.2
"""Share of the way from the eye at which a pill is drawn, before everything else."""
_FINE = 2
"""Pixels of a pill's picture for one on the screen."""


class SceneLabel:
    """A label at a point in space."""

    def __init__(self, host: viser.ViserServer | viser.ClientHandle, shape: LabelShape) -> None:
        """A label that is not visible yet."""
        self._scene, self._name = host.scene, shape.name
        self._shape, self._visible = shape, False
        self._plain: Any = None
        self._pill: Any = None

    def show(self, shape: LabelShape) -> None:
        """Show another text or colour."""
        if self._plain is not None and shape.text != self._shape.text:
            self._plain.text = shape.text
        if self._pill is not None and _look(shape) != _look(self._shape):
            picture = pill_picture(*_look(shape))
            self._pill.image = picture
            self._pill.render_width = float(picture.shape[1])
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
            for node in (self._plain, self._pill):
                if node is not None:
                    node.visible = False

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
        self._plain.visible = True
        if self._pill is not None:
            self._pill.visible = False

    def put_pill(self, place: Array, view: SceneCamera, metres_per_px: float) -> None:
        """Show the pill at `place` (3,), camera frame, as large in this view as on paper.

        Args:
            metres_per_px: a pixel's size one metre before the eye.
        """
        if self._pill is None:
            picture = pill_picture(*_look(self._shape))
            height, width = picture.shape[:2]
            self._pill = self._scene.add_image(
                f"{self._name}_pill", picture, width, height, cast_shadow=False
            )
        depth = float(view.axes[2] @ (place - view.position))
        self._pill.wxyz = Pose(view.axes.T, place).wxyz
        self._pill.position = view.position + _NEARER * (place - view.position)
        self._pill.scale = max(_NEARER * depth, 1e-3) * metres_per_px / _FINE
        self._pill.visible = True
        if self._plain is not None:
            self._plain.visible = False

    def remove(self) -> None:
        """Take it out of the scene."""
        for node in (self._plain, self._pill):
            if node is not None:
                node.remove()


def put_labels(
    labels: Sequence[tuple[LabelShape, SceneLabel]],
    view: SceneCamera | None,
    window_px: tuple[int, int],
) -> None:
    """Place these labels: pills that face this view and do not cover each other; viser's own
    without a view."""
    if view is None:
        for _, label in labels:
            label.put_plain()
        return
    metres_per_px = 2 * float(np.tan(view.fov_rad / 2)) / max(window_px[1], 1)
    places = places_apart([shape for shape, _ in labels], view, window_px)
    for (_, label), place in zip(labels, places, strict=True):
        label.put_pill(place, view, metres_per_px)


def _look(shape: LabelShape) -> tuple[str, tuple[int, int, int], int]:
    return shape.text, shape.colour, round(_FINE * HEIGHT_PX * 0.86)
