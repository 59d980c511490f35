"""One HTML document with its style and pictures in it, and the parts that documents are made of."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from importlib.metadata import version

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.scene.web.theme import Theme, style_sheet

PICTURE_WIDTH = 900
"""Width of a map in a document, pixels: two stand side by side on paper at 250 dots an inch."""


def document(title: str, subtitle: str, body: Sequence[str]) -> str:
    """The whole page; `body` holds HTML."""
    style = f"{Theme(dark=False).variables}{style_sheet('style')}{style_sheet('report')}"
    return (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>"
        "<meta http-equiv='Content-Security-Policy' content=\"default-src 'none'; "
        "img-src data:; style-src 'unsafe-inline'\">"
        f"<title>{escape(title)}</title><style>{style}</style></head><body><header>"
        f"<h1>{escape(title)}</h1><p>{escape(subtitle)}</p></header><main>{''.join(body)}</main>"
        f"<footer>venus3d {version('venus3d')}</footer></body></html>\n"
    )


def section(title: str, *parts: str) -> str:
    """A heading and what stands under it, as HTML."""
    return f"<section><h2>{escape(title)}</h2>{''.join(parts)}</section>"


def paragraph(text: str) -> str:
    """Plain text."""
    return f"<p>{escape(text)}</p>"


def code(title: str, text: str) -> str:
    """Lines to copy."""
    return f"<h3>{escape(title)}</h3><pre>{escape(text)}</pre>"


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, numbers: Sequence[int]) -> str:
    """Plain texts in rows; `numbers` are the columns that stand to the right."""

    right = "v-report-number"

    def row(cells: Sequence[str], tag: str) -> str:
        return "".join(
            f"<{tag} class='{right if column in numbers else ''}'>{escape(cell)}</{tag}>"
            for column, cell in enumerate(cells)
        )

    body = "".join(f"<tr>{row(cells, 'td')}</tr>" for cells in rows)
    return f"<table><thead><tr>{row(head, 'th')}</tr></thead><tbody>{body}</tbody></table>"


def picture(caption: str, rgb: NDArray[np.uint8], legend: str = "") -> str:
    """A picture (H, W, 3) with a caption, and HTML for its legend."""
    return (
        f"<figure><img alt='{escape(caption)}' src='{_png(rgb)}'>{legend}"
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def photograph(caption: str, bgr: NDArray[np.uint8]) -> str:
    """A small picture (H, W, 3) as the camera gives it, with a caption."""
    _, content = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 80])
    encoded = base64.b64encode(content.tobytes()).decode()
    return (
        f"<figure><img alt='{escape(caption)}' src='data:image/jpeg;base64,{encoded}'>"
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def side_by_side(*figures: str) -> str:
    """Figures in a row."""
    return f"<div class='v-report-figures'>{''.join(figures)}</div>"


def _png(rgb: NDArray[np.uint8]) -> str:
    _, content = cv2.imencode(".png", np.ascontiguousarray(rgb[..., ::-1]))
    return f"data:image/png;base64,{base64.b64encode(content.tobytes()).decode()}"
