"""The two pictures of a teaching page: the camera's view, and the four steps on one sheet. Small
pictures while somebody drags, large ones once it is quiet; `viewer` decides when."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PIL import Image, ImageDraw

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Array
from venus3d.render.annotated_picture import draw_line
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, picture_background, step_colour, text_on
from venus3d.render.projections import Picture, Projections
from venus3d.render.shapes import Colour
from venus3d.render.text_drawing import font, wrapped_lines
from venus3d.scene.pages.teach.scene_shapes import camera_shapes_at
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose

_QUICK, _FINE = (400, 1), (640, 2)  # width of the camera picture, supersampling
_QUICK_TILE, _FINE_TILE = (240, 1), (480, 2)
_FRAME = 5
_GAP = 6


class TeachPictures:
    """Requests pictures from the offscreen renderer and waits for them."""

    def __init__(self, offscreen: Offscreen) -> None:
        """`offscreen` renders the pictures; the caller closes it."""
        self._offscreen = offscreen
        self._projections = Projections(offscreen)
        self._tiles: dict[tuple[object, ...], Picture] = {}

    def camera_picture(self, taught: TaughtPose, state: TeachState, *, fine: bool) -> Picture:
        """The camera's current view, RGB; a refused pose is marked."""
        width, supersample = _FINE if fine else _QUICK
        camera = taught.camera
        size = (width, round(width * camera.height / camera.width))
        return self._offscreen.submit(
            camera,
            camera_shapes_at(taught, state),
            background=picture_background(state.dark),
            size=size,
            supersample=supersample,
            finish=lambda picture: with_refusal(picture, taught, state.dark),
        ).result()

    def steps_picture(
        self,
        taught: TaughtPose,
        state: TeachState,
        *,
        fine: bool,
        wanted: Callable[[], bool] = lambda: True,
    ) -> Picture | None:
        """The four steps two by two, RGB, the current one framed; tiles are cached. None if, after
        one of the tiles, the sheet is no longer `wanted`."""
        places = [(step.number, *_places(step), state.dark) for step in taught.steps]
        # Fine tiles are not replaced by coarse ones because another step is framed.
        fine = fine or all((*place, True) in self._tiles for place in places)
        width, supersample = _FINE_TILE if fine else _QUICK_TILE
        camera = taught.camera
        size = (width, round(width * camera.height / camera.width))
        tiles: dict[tuple[object, ...], Picture] = {}
        for step, place in zip(taught.steps, places, strict=True):
            key = (*place, fine)
            # A slider leaves the steps before its own unchanged.
            if key in self._tiles:
                tiles[key] = self._tiles[key]
            elif not wanted():
                return None
            else:
                tiles[key] = self._projections.of_step(
                    step, camera, taught.board, size=size, dark=state.dark, supersample=supersample
                ).result()
        self._tiles = tiles
        return _two_by_two(list(tiles.values()), 0 if state.at_rest else state.step, state.dark)


def _places(step: Step) -> tuple[bytes, bytes, float]:
    return step.before.matrix.tobytes(), step.after.matrix.tobytes(), step.angle_deg


def _two_by_two(tiles: list[Picture], step: int, dark: bool) -> Picture:
    """The tiles two by two; that of `step` framed (0: none)."""
    height, width = tiles[0].shape[:2]
    gap = round(_GAP * width / 320)
    sheet = np.empty((2 * height + 3 * gap, 2 * width + 3 * gap, 3), np.uint8)
    sheet[:] = ground(dark).background
    frame = round(_FRAME * width / 320)
    for number, tile in enumerate(tiles, start=1):
        row, column = divmod(number - 1, 2)
        y, x = gap + row * (height + gap), gap + column * (width + gap)
        if number == step:
            around = slice(y - frame, y + height + frame), slice(x - frame, x + width + frame)
            sheet[around] = step_colour(number, dark)
        sheet[y : y + height, x : x + width] = tile
    return sheet


def with_refusal(picture: Picture, taught: TaughtPose, dark: bool) -> Picture:
    """The picture of a refused pose with the offending corners and the main reason."""
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
    return _banner(drawn, taught.refusals[0].text, colour)


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
    size = round(image.width * 0.031)
    face = font(size, bold=True)
    lines = wrapped_lines(text, face, image.width - 2 * size)
    tall = round((len(lines) + 0.6) * 1.25 * size)
    draw.rectangle((0, image.height - tall, image.width, image.height), fill=colour)
    for i, line in enumerate(lines):
        at = (image.width / 2, image.height - tall + (i + 0.8) * 1.25 * size)
        draw.text(at, line, fill=text_on(colour), font=face, anchor="mm")
    return np.asarray(image)
