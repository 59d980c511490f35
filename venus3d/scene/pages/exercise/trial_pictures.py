"""A trial's pictures, drawn once for all tabs: the live one with its help, and the four steps."""

from __future__ import annotations

from typing import Literal

from venus3d.render.annotated_picture import PICTURE_WIDTH, LivePicture, annotate, small_picture
from venus3d.render.projections import Projections
from venus3d.render.trial_helps import draw_axes, draw_outline
from venus3d.scene.pages.exercise.page import Picture
from venus3d.scene.pages.exercise.view_model import TrialViewModel
from venus3d.scene.web.projections_panel import RemainingTiles, Sources
from venus3d.scene.web.theme import Theme

Layout = Literal["steps", "picture", "result"]
LARGE_PICTURE_WIDTH = 1280


class TrialPictures:
    """The pictures of one trial; `put` may be called from any thread, the rest from one."""

    def __init__(self, projections: Projections | None = None) -> None:
        """`projections` draws the four steps as the camera sees them; the caller closes it."""
        self._projections = projections
        self._tiles = RemainingTiles(projections, lambda: None)  # every frame looks for them
        self.image: LivePicture | None = None
        """The newest live picture, BGR or grey."""
        self._drawn: tuple[object, object, tuple[Picture, Picture]] | None = None

    def put(self, image: LivePicture) -> None:
        """Show this live picture; the newest wins."""
        self.image = image

    def live(self, view: TrialViewModel) -> tuple[Picture, Picture] | None:
        """The newest live picture as RGB: the original, and with the help drawn into it."""
        image, drawn = self.image, self._drawn
        if image is None:
            return None
        if drawn is None or drawn[0] is not image or drawn[1] is not view:
            drawn = self._drawn = (image, view, _live_picture(image, view))
        return drawn[2]

    @property
    def note(self) -> str:
        """The renderer's note, if any."""
        return "" if self._projections is None else self._projections.note

    def steps(self, view: TrialViewModel) -> Sources | None:
        """The pictures of the steps that are left, as far as they are drawn."""
        if layout_of(view) != "steps" or view.snapshot.target is None:
            self._tiles.forget()
        else:
            self._tiles.order(view.snapshot, dark=view.dark)
        return self._tiles.shown()


def layout_of(view: TrialViewModel) -> Layout:
    """The page's layout for this view."""
    if view.stage == "over":
        return "result"
    return "steps" if view.is_running and view.help == "steps" else "picture"


def _live_picture(image: LivePicture, view: TrialViewModel) -> tuple[Picture, Picture]:
    steps = layout_of(view) == "steps"
    rgb = small_picture(image, PICTURE_WIDTH if steps else LARGE_PICTURE_WIDTH)
    drawn = rgb.copy()
    if steps:
        step = view.step
        annotate(drawn, view.snapshot, None, step, Theme(True).step_colours[step - 1])
    elif view.is_running and view.target is not None:
        draw = draw_axes if view.help == "axes" else draw_outline
        draw(drawn, view.camera, view.board, view.pose, view.target)
    return rgb, drawn
