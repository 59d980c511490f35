"""The pictures of a teaching page: the camera's view, and each of the four steps. Small while
somebody drags, large once it is quiet; `page` decides when. What one tab has seen, another gets at
once."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from threading import Lock

import numpy as np
from PIL import Image, ImageDraw

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Array
from venus3d.render.annotated_picture import draw_line
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, picture_background, text_on
from venus3d.render.projections import Picture, Projections
from venus3d.render.shapes import Colour, LabelShape
from venus3d.render.text_drawing import fitting_font
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.scene_shapes import camera_shapes_at
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose

_QUICK, _FINE = (400, 1), (640, 2)  # width of the camera's view, supersampling
_QUICK_STEP, _FINE_STEP = (240, 1), (480, 2)
_KEPT = 48


class TeachPictures:
    """All tabs' pictures; thread-safe. The newest are kept."""

    def __init__(self, offscreen: Offscreen) -> None:
        """`offscreen` renders the pictures; the caller closes it."""
        self._offscreen = offscreen
        self._projections = Projections(offscreen)
        self._kept: OrderedDict[tuple[object, ...], Picture] = OrderedDict()
        self._lock = Lock()

    def camera_picture(self, taught: TaughtPose, state: TeachState, *, fine: bool) -> Picture:
        """The camera's current view, RGB; a refused pose is marked. Without letters, which nobody
        could read in so small a picture: the scene has them."""
        width, supersample = _FINE if fine else _QUICK
        shapes = camera_shapes_at(taught, state)
        return self._kept_or(
            (*camera_key(state), fine),
            lambda: self._offscreen.submit(
                taught.camera,
                tuple(shape for shape in shapes if not isinstance(shape, LabelShape)),
                background=picture_background(state.dark),
                size=_size(taught.camera, width),
                supersample=supersample,
                finish=lambda picture: with_refusal(picture, taught, state.dark),
            ),
        )

    def step_picture(self, taught: TaughtPose, step: Step, dark: bool, *, fine: bool) -> Picture:
        """One of the steps as the camera sees it, RGB."""
        width, supersample = _FINE_STEP if fine else _QUICK_STEP
        return self._kept_or(
            (*step_key(step, dark), fine),
            lambda: self._projections.of_step(
                step,
                taught.camera,
                taught.board,
                size=_size(taught.camera, width),
                dark=dark,
                supersample=supersample,
                header=False,
                letters=False,
            ),
        )

    def _kept_or(self, key: tuple[object, ...], request: Callable[[], Future[Picture]]) -> Picture:
        with self._lock:
            kept = self._kept.get(key)
        if kept is None:
            kept = request().result()
        with self._lock:
            self._kept[key] = kept
            self._kept.move_to_end(key)
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return kept


def camera_key(state: TeachState) -> tuple[object, ...]:
    """Equal for two states in which the camera sees the same."""
    return (state.vector, state.step_and_share, state.focus, state.at_rest, state.dark)


def step_key(step: Step, dark: bool) -> tuple[object, ...]:
    """Equal for two steps that look alike."""
    places = step.before.matrix.tobytes(), step.after.matrix.tobytes()
    return (step.number, *places, step.angle_deg, dark)


def _size(camera: Camera, width: int) -> tuple[int, int]:
    return width, round(width * camera.height / camera.width)


def with_refusal(picture: Picture, taught: TaughtPose, dark: bool) -> Picture:
    """The picture of a refused pose with the offending corners. The page says why."""
    if not taught.refusals:
        return picture
    colour = ground(dark).warning
    height, width = picture.shape[:2]
    blamed = sorted({corner for refusal in taught.refusals for corner in refusal.corners})
    camera = taught.camera.scaled((width, height))
    places = camera.project(taught.pose.apply(taught.board.outline[blamed]))
    drawn = np.array(picture)
    for place in places[np.isfinite(places).all(axis=1)]:
        _mark(drawn, place, colour)
    return _banner(drawn, texts.REFUSED_LABEL, colour)


def _mark(picture: Picture, place: Array, colour: Colour) -> None:
    """A cross at a corner; for one outside, an arrow head at the border pointing to it."""
    size = np.array([picture.shape[1], picture.shape[0]])
    arm = 0.022 * size[0]
    inside = np.clip(place, 2 * arm, size - 1 - 2 * arm)
    along = place - inside
    if np.linalg.norm(along) < 1.5 * arm:
        for sign in (1, -1):
            ends = np.array([[-arm, -sign * arm], [arm, sign * arm]]) + place
            draw_line(picture, ends, colour, 3, closed=False)
        return
    ahead = along / np.linalg.norm(along)
    aside = np.array([-ahead[1], ahead[0]])
    tip = inside + 1.6 * arm * ahead
    head = np.array([tip - arm * (ahead - aside), tip, tip - arm * (ahead + aside)])
    draw_line(picture, np.array([inside - arm * ahead, tip]), colour, 3, closed=False)
    draw_line(picture, head, colour, 3, closed=False)


def _banner(picture: Picture, text: str, colour: Colour) -> Picture:
    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image)
    # Where the page is low, it shows the picture at a third of its size.
    face = fitting_font(text, round(image.width * 0.06), 0.95 * image.width, bold=True)
    top = image.height - round(image.width * 0.09)
    draw.rectangle((0, top, image.width, image.height), fill=colour)
    at = (image.width / 2, (top + image.height) / 2)
    draw.text(at, text, fill=text_on(colour), font=face, anchor="mm")
    return np.asarray(image)
