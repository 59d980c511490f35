"""Two boards side by side in one picture: the same numbers read in two ways. Each board has its own
eye in the same relative place, so that boards with equal rotations look alike."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace

import numpy as np
from PIL import Image, ImageDraw

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, picture_background, step_colour
from venus3d.render.projections import Picture, with_header
from venus3d.render.shapes import Colour, LabelShape, Shape
from venus3d.render.strip import moved_shape
from venus3d.render.text_drawing import font
from venus3d.render.viewpoints import FOV_RAD, SceneCamera
from venus3d.scene.pages.teach.comparison import Side, board_centre, comparison_words
from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.scene_shapes import scene_shapes
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose

_DIRECTION = (0.3, 0.42, 1.0)
"""Viewing direction: from the camera's side, above and left, so that all axes are visible."""
_REACH = 0.8  # of the board's width around its centre: extent of axes and names
_LARGE = 500  # pixels: wider pictures need no smoothing
_SIDES: tuple[Side, Side] = ("left", "right")


def comparison_picture(
    taught: TaughtPose, state: TeachState, offscreen: Offscreen, size: tuple[int, int]
) -> Callable[[], Picture]:
    """Request the picture, RGB, of `size` plus a header like that of the steps' pictures; the
    returned function waits for it. `state` must be a comparison."""
    state = replace(state, viewpoint="outside")  # the left board stays on the left
    shapes, half = scene_shapes(taught, state), (size[0] // 2, size[1])
    futures = [_half(shapes, taught.board, side, offscreen, half, state.dark) for side in _SIDES]

    def finished() -> Picture:
        picture = np.hstack([future.result() for future in futures])
        picture[:, half[0] - 1 : half[0] + 1] = ground(state.dark).quiet_text
        return with_header(picture, *_words(taught, state), state.dark)

    return finished


def _words(taught: TaughtPose, state: TeachState) -> tuple[str, Colour, str, str]:
    """The header's badge, colour, title and sentence."""
    remark = comparison_words(taught, state)
    if remark.turn is not None:
        colour = step_colour(remark.axis + 2, state.dark)
        title = ", ".join(part for part in (remark.headline, remark.amount) if part)
        return str(remark.turn), colour, title, remark.sentence
    colour = ground(state.dark).text
    if state.progress <= 1:  # a film has no buttons
        return texts.ALIKE, colour, remark.headline, ""
    badge = texts.ALIKE if taught.apart_deg(state.arrangement) < 0.5 else texts.DIFFERENT
    amount = remark.amount[:1].upper() + remark.amount[1:]
    return badge, colour, remark.headline, f"{amount}. {remark.sentence}"


def _half(
    shapes: tuple[Shape, ...],
    board: Board,
    side: Side,
    offscreen: Offscreen,
    size: tuple[int, int],
    dark: bool,
) -> Future[Picture]:
    eye, place = _eye(board, side, size)
    name = f"/compare/{side}"
    mine = [moved_shape(shape, place) for shape in shapes if shape.name.startswith(f"{name}/")]
    title = next(s for s in mine if isinstance(s, LabelShape) and s.name == f"{name}/label")
    return offscreen.submit(
        eye,
        [shape for shape in mine if shape is not title],
        background=picture_background(dark),
        size=size,
        supersample=1 if size[0] > _LARGE else 2,
        finish=lambda picture: _titled(picture, title),
    )


def _eye(board: Board, side: Side, size: tuple[int, int]) -> tuple[Camera, Pose]:
    """The camera of this side's board, and the pose from the camera's frame to its own."""
    f = size[1] / 2 / np.tan(FOV_RAD / 2)
    eye = Camera(*size, f, f, (size[0] - 1) / 2, (size[1] - 1) / 2)
    centre, ahead = board_centre(board, side), np.array(_DIRECTION)
    distance = 2 * f * _REACH * board.width / min(size)
    view = SceneCamera(centre - distance * ahead / np.linalg.norm(ahead), centre, FOV_RAD)
    return eye, Pose(view.axes, -view.axes @ view.position)


def _titled(picture: Picture, title: LabelShape) -> Picture:
    image = Image.fromarray(picture)
    size = round(image.width / 19)
    at, face = (image.width / 2, 0.4 * size), font(size, bold=True)
    ImageDraw.Draw(image).text(at, title.text, fill=title.colour, font=face, anchor="ma")
    return np.asarray(image)
