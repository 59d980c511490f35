"""The four steps of one pose on a sheet to print: A4, landscape, light."""

from __future__ import annotations

import io
from typing import Any

from PIL import Image, ImageDraw

from venus3d.engine.decomposition import HOME_DISTANCE
from venus3d.scene.export.pose_line import pose_line
from venus3d.scene.offscreen import Offscreen
from venus3d.scene.palette import ground, step_style, text_on
from venus3d.scene.projections import Picture, Projections
from venus3d.scene.teach.moment import TeachMoment
from venus3d.scene.teach.state import Vector
from venus3d.scene.text import font, wrapped
from venus3d.scene.texts import export as texts

DPI = 300
SIZE_PX = (3508, 2480)
_MARGIN, _GAP = 150, 70
_TITLE, _LINE, _WORDS = 110, 58, 52
_TOP = 430


def sheet(
    moment: TeachMoment,
    vector: Vector,
    title: str,
    offscreen: Offscreen,
) -> bytes:
    """The sheet as PNG: title, the pose's six numbers, the steps with words for both sides.

    Args:
        vector: the pose in degrees and millimetres, as a person typed it.
    """
    colours = ground(False)
    image = Image.new("RGB", SIZE_PX, (255, 255, 255))
    draw = ImageDraw.Draw(image)
    room = SIZE_PX[0] - 2 * _MARGIN
    heading = font(_TITLE, bold=True)
    if heading.getlength(title) > room:
        heading = font(int(_TITLE * room / heading.getlength(title)), bold=True)
    draw.text((_MARGIN, _MARGIN - 30), title, fill=colours.text, font=heading)
    line = font(_LINE)
    if line.getlength(pose_line(vector)) > room:
        line = font(int(_LINE * room / line.getlength(pose_line(vector))))
    draw.text((_MARGIN, 265), pose_line(vector), fill=colours.text, font=line)
    # Whoever reads that a pose is refused need not be told how it is reached.
    lowest = texts.SHEET_START.format(millimetres=round(1000 * HOME_DISTANCE))
    if moment.refusals:
        lowest = texts.SHEET_REFUSED.format(why=moment.refusals[0].text)
    colour = colours.warning if moment.refusals else colours.quiet_text
    draw.text((_MARGIN, 340), lowest, fill=colour, font=font(_WORDS))
    width = (room - _GAP) // 2
    height = (SIZE_PX[1] - _TOP - _MARGIN - _GAP) // 2
    words_tall = 3 * round(1.3 * _WORDS) + 140
    camera = moment.camera
    picture_height = min(height - words_tall, round(width * camera.height / camera.width))
    size = (round(picture_height * camera.width / camera.height), picture_height)
    projections = Projections(offscreen)
    pictures = [
        projections.of_step(
            step, camera, moment.board, size=size, dark=False, supersample=1, header=False
        )
        for step in moment.steps
    ]
    for step, picture in zip(moment.steps, pictures, strict=True):
        row, column = divmod(step.number - 1, 2)
        corner = (_MARGIN + column * (width + _GAP), _TOP + row * (height + _GAP))
        words = (step.words.camera, texts.HOLDER.format(words=step.words.holder))
        if step.words.camera == step.words.holder:
            words = words[:1]
        _cell(draw, image, corner, (width, height), step.number, words, picture.result())
    foot = (SIZE_PX[0] - _MARGIN, SIZE_PX[1] - 60)
    draw.text(foot, texts.MADE_WITH, fill=colours.quiet_text, font=font(40), anchor="rs")
    buffer = io.BytesIO()
    image.save(buffer, "PNG", dpi=(DPI, DPI))
    return buffer.getvalue()


def _cell(
    draw: Any,
    image: Image.Image,
    corner: tuple[int, int],
    size: tuple[int, int],
    number: int,
    words: tuple[str, ...],
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
    face, line = font(_WORDS), round(1.3 * _WORDS)
    lines = [part for text in words for part in wrapped(text, face, size[0] - 60)]
    for i, text in enumerate(lines[:3]):
        draw.text((x + 30, y + 112 + i * line), text, fill=colours.text, font=face)
    left = x + (size[0] - picture.shape[1]) // 2
    image.paste(Image.fromarray(picture), (left, y + size[1] - picture.shape[0] - 8))
