"""The path through the four steps as a film: the camera's view under the step's words; for a page
that compares two readings, both boards. The offscreen renderer draws; PyAV writes MP4 (its wheels
include the encoder, imageio would download one), Pillow writes GIF. Returns bytes, not files."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np
from PIL import Image, ImageDraw

from venus3d.lessons.lesson import Lesson
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, picture_background
from venus3d.render.projections import Picture, with_header, with_step_header
from venus3d.render.text_drawing import font, wrapped_lines
from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.export.animation import ExportedPage, animation_states
from venus3d.scene.pages.teach.export.comparison_picture import comparison_picture
from venus3d.scene.pages.teach.pictures import with_refusal
from venus3d.scene.pages.teach.scene_shapes import camera_shapes_at, shown_step
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose

MP4_FPS, GIF_FPS = 25, 10
MP4_WIDTH, GIF_WIDTH = 1280, 640
_TITLE_S = 1.6
_AHEAD = 4  # frames rendered ahead of the encoder


def film(
    lesson: Lesson, pages: Sequence[ExportedPage], offscreen: Offscreen, *, fps: int, width: int
) -> Iterator[Picture]:
    """RGB frames of one size with even sides; a title card before each page."""
    for page in pages:
        camera, states = page.taught.camera, animation_states(page, fps)
        size = (width, round(width * camera.height / camera.width))
        first = _even(_picture(page.taught, states[0], offscreen, size)())
        if lesson.title:
            card = _title_card(lesson.title, page.page.title, first.shape, page.state.dark)
            yield from [card] * round(_TITLE_S * fps)
        waiting: list[Callable[[], Picture]] = []
        for before, state in zip((None, *states[:-1]), states, strict=True):
            # A board at rest is drawn once.
            same = before is not None and waiting and before.step_and_share == state.step_and_share
            waiting.append(waiting[-1] if same else _picture(page.taught, state, offscreen, size))
            if len(waiting) > _AHEAD:
                yield _even(waiting.pop(0)())
        yield from (_even(finished()) for finished in waiting)


def _picture(
    taught: TaughtPose, state: TeachState, offscreen: Offscreen, size: tuple[int, int]
) -> Callable[[], Picture]:
    if state.compares:
        return comparison_picture(taught, state, offscreen, size)
    return offscreen.submit(
        taught.camera,
        camera_shapes_at(taught, state),
        background=picture_background(state.dark),
        size=size,
        supersample=1,
        finish=lambda picture: _with_header(picture, taught, state),
    ).result


def _with_header(picture: Picture, taught: TaughtPose, state: TeachState) -> Picture:
    """The frame under its header. An idle step shows the next step's words."""
    busy = [step for step in taught.steps if not step.is_idle]
    if not busy:
        text = ground(state.dark).text
        return with_header(picture, "0", text, texts.UPRIGHT, texts.UPRIGHT_WHERE, state.dark)
    if state.progress >= 4:
        # The reason for a refused pose is given once the board has reached it.
        picture = with_refusal(picture, taught, state.dark)
    now = shown_step(taught, state)
    step = next((step for step in busy if step.number >= now), busy[-1])
    return with_step_header(picture, step, state.dark)


def _even(picture: Picture) -> Picture:
    # Video stores colours for blocks of two by two pixels.
    height, width = (side // 2 * 2 for side in picture.shape[:2])
    return picture[:height, :width]


def _title_card(lesson: str, page: str, shape: tuple[int, ...], dark: bool) -> Picture:
    colours = ground(dark)
    image = Image.new("RGB", (shape[1], shape[0]), colours.background)
    draw = ImageDraw.Draw(image)
    large, small = font(shape[1] // 18, bold=True), font(shape[1] // 36)
    lines = wrapped_lines(page, large, 0.86 * shape[1])
    middle, line = shape[0] / 2, shape[1] / 15
    draw.text(
        (shape[1] / 2, middle - (len(lines) / 2 + 0.8) * line),
        lesson,
        fill=colours.quiet_text,
        font=small,
        anchor="mm",
    )
    for i, text in enumerate(lines):
        at = (shape[1] / 2, middle + (i - (len(lines) - 1) / 2) * line)
        draw.text(at, text, fill=colours.text, font=large, anchor="mm")
    return np.asarray(image)


def gif(pictures: Iterable[Picture], fps: int) -> bytes:
    """A looping GIF with one palette per frame. Raises `ValueError` without frames."""
    images = [
        Image.fromarray(picture).quantize(64, dither=Image.Dither.NONE) for picture in pictures
    ]
    if not images:
        raise ValueError("a film needs a picture")
    buffer = io.BytesIO()
    images[0].save(
        buffer,
        "GIF",
        save_all=True,
        append_images=images[1:],
        duration=round(1000 / fps),
        loop=0,
        optimize=False,
    )
    return buffer.getvalue()
