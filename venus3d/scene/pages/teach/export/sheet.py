"""The four steps of one pose on a printable sheet: A4, landscape, light."""

from __future__ import annotations

import io
from typing import Any

from PIL import Image, ImageDraw

from venus3d.engine.geometry.decomposition import HOME_DISTANCE, Step
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.languages import translated
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, step_style, text_on
from venus3d.render.projections import Picture, Projections
from venus3d.render.text_drawing import fitting_font, font, wrapped_lines
from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.export.sentences import pose_sentence
from venus3d.scene.pages.teach.lesson_html import holder_sentence
from venus3d.scene.pages.teach.state import Vector
from venus3d.scene.pages.teach.view_model import TaughtPose
from venus3d.scene.web import offline_texts

DPI = 300
SIZE_PX = (3508, 2480)
_MARGIN, _GAP = 150, 70
_TITLE, _LINE, _WORDS = 110, 50, 46
_LINE_TALL = round(1.3 * _WORDS)
_TOP = 430
_ROOM = SIZE_PX[0] - 2 * _MARGIN


def sheet(
    taught: TaughtPose,
    vector: Vector,
    title: str,
    offscreen: Offscreen,
) -> bytes:
    """The sheet as PNG: title, the six numbers of `vector` (degrees and millimetres, as typed), the
    steps with words for both sides."""
    image = Image.new("RGB", SIZE_PX, (255, 255, 255))
    draw = ImageDraw.Draw(image)
    _heading(draw, taught, vector, title)
    width = (_ROOM - _GAP) // 2
    height = (SIZE_PX[1] - _TOP - _MARGIN - _GAP) // 2
    lines = [_lines(step, width) for step in taught.steps]
    words_tall = max(map(len, lines)) * _LINE_TALL + 130
    camera = taught.camera
    picture_height = min(height - words_tall, round(width * camera.height / camera.width))
    size = (round(picture_height * camera.width / camera.height), picture_height)
    projections = Projections(offscreen)
    pictures = [
        projections.of_step(
            step, camera, taught.board, size=size, dark=False, supersample=1, header=False
        )
        for step in taught.steps
    ]
    for step, words, picture in zip(taught.steps, lines, pictures, strict=True):
        row, column = divmod(step.number - 1, 2)
        corner = (_MARGIN + column * (width + _GAP), _TOP + row * (height + _GAP))
        _cell(draw, image, corner, (width, height), step.number, words, picture.result())
    foot = (SIZE_PX[0] - _MARGIN, SIZE_PX[1] - 60)
    draw.text(
        foot, offline_texts.MADE_WITH, fill=ground(False).quiet_text, font=font(40), anchor="rs"
    )
    buffer = io.BytesIO()
    image.save(buffer, "PNG", dpi=(DPI, DPI))
    return buffer.getvalue()


def _lines(step: Step, width: int) -> tuple[str, ...]:
    """The step's instruction, for the picture and for the hands, as lines of a cell."""
    words = (translated(step_prompt(step).camera), holder_sentence(step_prompt(step)))
    return tuple(line for text in words for line in wrapped_lines(text, font(_WORDS), width - 60))


def _heading(draw: Any, taught: TaughtPose, vector: Vector, title: str) -> None:
    colours, line = ground(False), pose_sentence(vector)
    face = fitting_font(title, _TITLE, _ROOM, bold=True)
    draw.text((_MARGIN, _MARGIN - 30), title, fill=colours.text, font=face)
    face = fitting_font(line, _LINE, _ROOM)
    draw.text((_MARGIN, 270), line, fill=colours.text, font=face)
    line, colour = texts.SHEET_START, colours.quiet_text
    if taught.refusals:
        # For a refused pose the way to it does not matter.
        line, colour = texts.SHEET_REFUSED, colours.warning
    why = translated(taught.refusals[0].text) if taught.refusals else ""
    line = line.format(millimetres=round(1000 * HOME_DISTANCE), why=why)
    draw.text((_MARGIN, 345), line, fill=colour, font=fitting_font(line, _WORDS, _ROOM))


def _cell(
    draw: Any,
    image: Image.Image,
    corner: tuple[int, int],
    size: tuple[int, int],
    number: int,
    lines: tuple[str, ...],
    picture: Picture,
) -> None:
    style, colours = step_style(number), ground(False)
    x, y = corner
    draw.rectangle((x, y, x + size[0], y + size[1]), outline=style.on_light, width=6)
    draw.rectangle((x, y, x + 100, y + 100), fill=style.on_light)
    badge = font(80, bold=True)
    fill = text_on(style.on_light)
    draw.text((x + 50, y + 50), str(number), fill=fill, font=badge, anchor="mm")
    title = font(66, bold=True)
    draw.text((x + 130, y + 50), style.title, fill=style.on_light, font=title, anchor="lm")
    for i, text in enumerate(lines):
        at = (x + 30, y + 110 + i * _LINE_TALL)
        draw.text(at, text, fill=colours.text, font=font(_WORDS))
    left = x + (size[0] - picture.shape[1]) // 2
    image.paste(Image.fromarray(picture), (left, y + size[1] - picture.shape[0] - 8))
