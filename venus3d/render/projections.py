"""Four steps as the camera would see them. Rendered on the first request for these steps and this
camera, then cached (the paper's lazy loading)."""

from __future__ import annotations

from collections import OrderedDict
from concurrent.futures import Future
from functools import lru_cache, partial
from threading import Lock

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step, Steps
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.languages import current_language, translated
from venus3d.render import texts
from venus3d.render.describe import describe_step
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, picture_background, step_style, text_on
from venus3d.render.shapes import Colour, LabelShape, Shape
from venus3d.render.text_drawing import fitting_font, font, wrapped_lines

Picture = NDArray[np.uint8]
Pictures = tuple[Future[Picture], Future[Picture], Future[Picture], Future[Picture]]
KEPT = 6
"""Sets of four pictures that are kept."""
HEADER_SHARE = 0.26
"""Height of a picture's header, in heights of the picture."""


class Projections:
    """The pictures of the steps; thread-safe."""

    def __init__(self, offscreen: Offscreen) -> None:
        """`offscreen` renders the pictures."""
        self._offscreen = offscreen
        self._kept: OrderedDict[tuple[object, ...], Pictures] = OrderedDict()
        self._lock = Lock()

    @property
    def note(self) -> str:
        """Why the painter draws; empty when OpenGL does."""
        return self._offscreen.note

    def of(
        self,
        steps: Steps,
        camera: Camera,
        board: Board,
        *,
        done: tuple[bool, ...] = (False,) * 4,
        size: tuple[int, int] = (480, 270),
        dark: bool = True,
        header: bool = True,
        letters: bool = True,
    ) -> Pictures:
        """Futures of the RGB pictures of steps 1 ... 4, each of `size` plus a `header` above;
        returns at once. The arguments are those of `of_step`."""
        key = (current_language(), steps, camera, board, done, size, dark, header, letters)
        with self._lock:
            if key not in self._kept:
                one, two, three, four = (
                    self.of_step(
                        step,
                        camera,
                        board,
                        done=is_done,
                        size=size,
                        dark=dark,
                        header=header,
                        letters=letters,
                    )
                    for step, is_done in zip(steps, done, strict=True)
                )
                self._kept[key] = (one, two, three, four)
            self._kept.move_to_end(key)
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
            return self._kept[key]

    def of_step(
        self,
        step: Step,
        camera: Camera,
        board: Board,
        *,
        done: bool = False,
        size: tuple[int, int] = (480, 270),
        dark: bool = True,
        supersample: int = 2,
        header: bool = True,
        letters: bool = True,
    ) -> Future[Picture]:
        """The picture of one step; not cached. Drawn `supersample` times as large and shrunk.

        Args:
            done: no arrow, since nothing is to be done.
            header: the step's number, title and words above.
            letters: amount, axis and a warning of corners outside; without, the picture stays true
                while the amount falls. In a tile, a third as large, they could not be read.
        """

        def shapes() -> tuple[Shape, ...]:
            described = describe_step(board, camera, step, dark=dark, instruct=not done)
            if letters:
                return described
            return tuple(shape for shape in described if not isinstance(shape, LabelShape))

        return self._offscreen.submit(
            camera,
            shapes,
            background=picture_background(dark),
            size=size,
            supersample=supersample,
            finish=partial(with_step_header, step=step, dark=dark)
            if header
            else partial(_alone, step=step if letters and not done else None, dark=dark),
        )


def _alone(picture: Picture, step: Step | None, dark: bool) -> Picture:
    """The picture in its frame, with a warning if corners of this step are outside."""
    told = picture if step is None else with_corner_banner(picture, step, dark)
    return _framed(told, ground(dark).camera)


def with_step_header(picture: Picture, step: Step, dark: bool) -> Picture:
    """The picture under a header with the step's number, title and words."""
    style = step_style(step.number)
    colour = style.colour(dark)
    picture = with_header(
        picture, str(step.number), colour, style.title, translated(step_prompt(step).camera), dark
    )
    return with_corner_banner(picture, step, dark)


def with_header(
    picture: Picture, badge: str, colour: Colour, title: str, sentence: str, dark: bool
) -> Picture:
    """The picture in a frame of this colour, under a header with a badge and words."""
    height, width = picture.shape[:2]
    head = _header((width, round(height * HEADER_SHARE)), badge, colour, title, sentence, dark)
    return np.concatenate([head, _framed(picture, colour)])


def _framed(picture: Picture, colour: Colour) -> Picture:
    """The picture with its border drawn: where the camera's image ends."""
    framed = np.array(picture)
    framed[:2] = framed[-2:] = colour
    framed[:, :2] = framed[:, -2:] = colour
    return framed


@lru_cache(maxsize=32)
def _header(
    size: tuple[int, int], badge: str, colour: Colour, title: str, sentence: str, dark: bool
) -> Picture:
    """The header; cached, since its words change less often than the picture below."""
    colours = ground(dark)
    width, header = size
    image = Image.new("RGB", size, colours.background)
    draw = ImageDraw.Draw(image)
    side = round(header * 0.72)
    draw.rectangle((0, 0, side, header - 1), fill=colour)
    draw.text(
        (side / 2, header / 2),
        badge,
        fill=text_on(colour),
        font=font(round(header * 0.6), bold=True),
        anchor="mm",
    )
    left, room = side + round(0.02 * width), width - side - round(0.035 * width)
    face = fitting_font(title, round(header * 0.31), room, bold=True)
    draw.text((left, header * 0.01), title, fill=colour, font=face)
    words = font(round(header * 0.225))
    for i, line in enumerate(wrapped_lines(sentence, words, room)[:2]):
        draw.text((left, header * (0.41 + 0.27 * i)), line, fill=colours.text, font=words)
    return np.asarray(image)


def with_corner_banner(picture: Picture, step: Step, dark: bool) -> Picture:
    """The picture, with a banner if corners lie outside it that says how many."""
    if step.is_visible:
        return picture
    image = Image.fromarray(picture)
    _banner(ImageDraw.Draw(image), image.size, len(step.corners_outside), dark)
    return np.asarray(image)


def corners_outside_text(corners: int) -> str:
    """That so many corners are outside the image; empty for none."""
    if not corners:
        return ""
    return texts.ONE_CORNER_OUTSIDE if corners == 1 else texts.CORNERS_OUTSIDE.format(count=corners)


def _banner(draw: ImageDraw.ImageDraw, size: tuple[int, int], corners: int, dark: bool) -> None:
    colours, text = ground(dark), corners_outside_text(corners)
    face = fitting_font(text, round(size[0] * 0.08), 0.95 * size[0], bold=True)
    half, tall = face.getlength(text) / 2 + 8, round(size[0] * 0.07)
    middle, bottom = size[0] / 2, size[1] - 5
    draw.rectangle((middle - half, bottom - tall, middle + half, bottom), fill=colours.warning)
    draw.text(
        (middle, bottom - tall / 2), text, fill=text_on(colours.warning), font=face, anchor="mm"
    )
