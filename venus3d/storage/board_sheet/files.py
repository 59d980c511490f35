"""Writes a `Sheet` as PDF, SVG or PNG, at true scale."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from fpdf import FPDF
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from venus3d.engine.errors import StorageError
from venus3d.storage.board_sheet.sheet import TEXT_MM, Sheet, Tile

MM_PER_INCH = 25.4
_MOST_PIXELS = 400_000_000


def pdf_of(sheet: Sheet, pages: Sequence[Tile], title: str) -> bytes:
    """A PDF of one page, or of several with marks to cut by."""
    pdf: Any = FPDF(unit="mm")
    pdf.set_title(title)
    pdf.set_auto_page_break(False)
    pdf.set_margin(0)
    for number, tile in enumerate(pages, start=1):
        pdf.add_page(format=tile.page)
        left, top = (tile.page[0] - tile.width) / 2, (tile.page[1] - tile.height) / 2
        with pdf.rect_clip(left, top, tile.width, tile.height):
            _draw(pdf, sheet, left - tile.left, top - tile.top)
        if len(pages) > 1:
            _cut_marks(pdf, left, top, tile)
            place = f"sheet {number} of {len(pages)}: row {tile.row + 1}, column {tile.column + 1}"
            pdf.set_font("helvetica", size=TEXT_MM / MM_PER_INCH * 72)
            pdf.text(left + 6, top - 4, f"{place}; cut along the marks, put edge to edge")
    return bytes(pdf.output())


def _draw(pdf: Any, sheet: Sheet, dx: float, dy: float) -> None:
    # One path for all shapes: no hairline of white between two that touch.
    with pdf.new_path() as path:
        path.style.fill_color, path.style.stroke_color = "#000000", None
        path.style.intersection_rule = "evenodd"
        for x, y, width, height in sheet.rectangles:
            path.rectangle(dx + x, dy + y, width, height)
        for x, y, radius in sheet.discs:
            path.circle(dx + x, dy + y, radius)
        for polygon in sheet.polygons:
            path.move_to(dx + polygon[0, 0], dy + polygon[0, 1])
            for x, y in polygon[1:]:
                path.line_to(dx + x, dy + y)
            path.close()
    pdf.set_font("helvetica", size=TEXT_MM / MM_PER_INCH * 72)
    for text in sheet.texts:
        pdf.text(dx + text.x, dy + text.baseline, text.words)


def _cut_marks(pdf: Any, left: float, top: float, tile: Tile) -> None:
    pdf.set_line_width(0.1)
    for x in (left, left + tile.width):
        for y, outwards in ((top, -1), (top + tile.height, 1)):
            pdf.line(x, y + outwards, x, y + 6 * outwards)
    for y in (top, top + tile.height):
        for x, outwards in ((left, -1), (left + tile.width, 1)):
            pdf.line(x + outwards, y, x + 6 * outwards, y)


def svg_of(sheet: Sheet, title: str) -> str:
    """An SVG in millimetres."""
    path = [f"M{x:.4f} {y:.4f}h{w:.4f}v{h:.4f}h{-w:.4f}z" for x, y, w, h in sheet.rectangles]
    path += [
        f"M{x - r:.4f} {y:.4f}a{r:.4f} {r:.4f} 0 1 0 {2 * r:.4f} 0"
        f"a{r:.4f} {r:.4f} 0 1 0 {-2 * r:.4f} 0z"
        for x, y, r in sheet.discs
    ]
    for polygon in sheet.polygons:
        path.append("M" + "L".join(f"{x:.4f} {y:.4f}" for x, y in polygon) + "z")
    texts = "".join(
        f"<text x='{text.x:.3f}' y='{text.baseline:.3f}'>{escape(text.words)}</text>"
        for text in sheet.texts
    )
    return (
        f"<svg xmlns='http://www.w3.org/2000/svg' width='{sheet.width:.4f}mm' "
        f"height='{sheet.height:.4f}mm' viewBox='0 0 {sheet.width:.4f} {sheet.height:.4f}' "
        f"font-family='Helvetica, Arial, sans-serif' font-size='{TEXT_MM}'>"
        f"<title>{escape(title)}</title><rect width='100%' height='100%' fill='#fff'/>"
        f"<path fill-rule='evenodd' d='{''.join(path)}'/>{texts}</svg>\n"
    )


def picture_of_sheet(sheet: Sheet, dpi: float, square_mm: float) -> tuple[NDArray[np.uint8], float]:
    """Grey image of a sheet and its resolution in dots per inch: the one nearest to `dpi` at which
    a square is a whole number of pixels, or its edges blur. Raises `StorageError`."""
    if not 1 <= dpi <= 1e6:
        raise StorageError(f"--dpi must be a number from 1 to 1000000, not {dpi:g}.")
    square_px = round(square_mm * dpi / MM_PER_INCH)
    # A marker of 8 cells in two thirds of a square still has two pixels a cell.
    if square_px < 24:
        raise StorageError(
            f"At {dpi:g} dpi a square of {square_mm:g} mm is {square_px} px wide, too coarse for "
            "the markers; use a higher --dpi."
        )
    scale = square_px / square_mm
    width, height = round(sheet.width * scale), round(sheet.height * scale)
    if width * height > _MOST_PIXELS:
        raise StorageError("This picture would have over 400 million pixels; use a lower --dpi.")
    black = np.zeros((height, width), dtype=bool)
    # The board's corners fall on edges of pixels.
    first = sheet.rectangles[0, :2] * scale if len(sheet.rectangles) else np.zeros(2)
    dx, dy = np.round(first) - first
    for x, y, w, h in sheet.rectangles * scale:
        x0, x1, y0, y1 = (int(np.rint(v)) for v in (x + dx, x + w + dx, y + dy, y + h + dy))
        black[max(y0, 0) : y1, max(x0, 0) : x1] ^= True
    for x, y, radius in sheet.discs * scale:
        _disc(black, np.array([x + dx - 0.5, y + dy - 0.5]), radius)
    picture = Image.fromarray(np.where(black, 0, 255).astype(np.uint8))
    pen: Any = ImageDraw.Draw(picture)
    for polygon in sheet.polygons:
        pen.polygon([tuple(corner) for corner in polygon * scale], fill=0)
    font = ImageFont.load_default(max(TEXT_MM * scale, 1.0)) if sheet.texts else None
    for text in sheet.texts:
        at = (text.x * scale, text.baseline * scale)
        pen.text(at, text.words, fill=0, font=font, anchor="ls")
    return np.asarray(picture, dtype=np.uint8), scale * MM_PER_INCH


def _disc(black: NDArray[np.bool_], centre: NDArray[np.float64], radius: float) -> None:
    x0, y0 = np.maximum(np.floor(centre - radius), 0).astype(int)
    x1, y1 = np.ceil(centre + radius).astype(int) + 1
    part = black[y0:y1, x0:x1]
    y, x = np.ogrid[y0 : y0 + part.shape[0], x0 : x0 + part.shape[1]]
    part ^= (x - centre[0]) ** 2 + (y - centre[1]) ** 2 <= radius**2


def png_of(picture: NDArray[np.uint8], dpi: float) -> bytes:
    """PNG stores the resolution (pHYs) in whole dots per metre, within 0.003 % of 300 dpi."""
    buffer = io.BytesIO()
    Image.fromarray(picture).convert("1", dither=Image.Dither.NONE).save(
        buffer, "PNG", dpi=(dpi, dpi)
    )
    return buffer.getvalue()
