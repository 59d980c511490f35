"""The maps of the camera's uncertainty: title, picture, numbers on it, legend.
`render.map_pictures` draws the pictures; the panel chooses the map."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import get_args

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.uncertainty import ProjectionUncertainty
from venus3d.languages import number
from venus3d.render.colour_scale import round_down, round_up
from venus3d.render.map_pictures import (
    Picture,
    coverage,
    coverage_picture,
    distortion_magnification,
    distortion_picture,
    largest_shift_px,
    residual_magnification,
    residual_picture,
    uncertainty_picture,
)
from venus3d.scene.pages.guide.uncertainty import texts
from venus3d.scene.pages.guide.uncertainty.texts import MapKind
from venus3d.scene.web.legend import scale_html
from venus3d.scene.web.projections_panel import encoded

MAP_KINDS: tuple[MapKind, ...] = get_args(MapKind)
WIDTH = 640
"""Width of the pictures, pixels."""


@dataclass(frozen=True, eq=False)
class ShownMap:
    """One map on the page."""

    title: str
    sentence: str
    picture: Picture | None = None
    """None where there is nothing to draw yet."""
    ticks: tuple[float, ...] = ()
    """The legend's numbers, evenly spaced from the lower end to the upper; may be empty."""
    unit: str = ""
    """Of the ticks; pixels if empty."""
    figures: Array | None = None
    """(rows, columns) values of the picture, to be written at its middle and corners."""


def map_of(snapshot: Snapshot, kind: MapKind, *, dark: bool, chosen: int | None = None) -> ShownMap:
    """The map at this moment; `chosen` is the number of a view to emphasise."""
    width, height = snapshot.camera.image_size
    size = (WIDTH, round(WIDTH * height / width))
    if kind == "corners":
        return _corners(snapshot, size, dark)
    if kind == "lens":
        return _lens(snapshot, size, dark)
    if kind == "misfit":
        return _misfit(snapshot, size, dark, chosen)
    if snapshot.uncertainty is None:
        return ShownMap(texts.NOW_TITLE, texts.NOTHING_YET)
    if kind == "after":
        return _after(snapshot, snapshot.uncertainty, size, dark)
    known, ticks = snapshot.uncertainty, error_ticks(snapshot)
    return ShownMap(
        texts.NOW_TITLE,
        texts.NOW_TEXT.format(error=figure(known.uncertainty_px)),
        uncertainty_picture(known.uncertainty_map, (ticks[0], ticks[-1]), size, dark=dark),
        ticks,
        figures=known.uncertainty_map,
    )


def map_html(shown: ShownMap) -> str:
    """The map as HTML."""
    title = f"<h3>{escape(shown.title)}</h3>"
    sentence = f"<div class='v-line'>{escape(shown.sentence)}</div>"
    if shown.picture is None:
        return f"<div class='v-progress' data-panel='uncertainty'>{title}{sentence}</div>"
    alt = escape(texts.PICTURE_ALT.format(title=shown.title))
    image = f"<img alt='{alt}' src='{encoded(shown.picture)}'>"
    legend = scale_html(shown.ticks, shown.unit or texts.PIXELS) if shown.ticks else ""
    return (
        f"<div class='v-progress' data-panel='uncertainty'>{title}<div class='v-map'>{image}"
        f"{_figures(shown)}</div>{legend}{sentence}</div>"
    )


def even_ticks(high: float) -> tuple[float, ...]:
    """Numbers for a scale from 0."""
    return (0.0, high / 2, high)


def error_ticks(snapshot: Snapshot) -> tuple[float, ...]:
    """Numbers of the logarithmic scale that the maps “now” and “next” share, pixels."""
    known, target = snapshot.uncertainty, snapshot.target
    if known is None:
        return ()
    after = None if target is None else known.predicted_at(target.pose)
    every = known.uncertainty_map if after is None else np.stack([known.uncertainty_map, after])
    low, high = round_down(float(np.nanmin(every))), round_up(float(np.nanmax(every)))
    return (low, float(np.sqrt(low * high)), high)


def _after(
    snapshot: Snapshot, known: ProjectionUncertainty, size: tuple[int, int], dark: bool
) -> ShownMap:
    target = snapshot.target
    if target is None:
        return ShownMap(texts.AFTER_TITLE, texts.AFTER_NONE)
    title = texts.AFTER_TITLE
    errors = known.predicted_at(target.pose)
    if errors is None:
        return ShownMap(title, texts.AFTER_UNKNOWN)
    sentence = texts.AFTER_TEXT.format(
        before=figure(known.uncertainty_px),
        after=figure(target.predicted_uncertainty_px),
    )
    ticks = error_ticks(snapshot)
    picture = uncertainty_picture(errors, (ticks[0], ticks[-1]), size, dark=dark)
    return ShownMap(title, sentence, picture, ticks, figures=errors)


def _corners(snapshot: Snapshot, size: tuple[int, int], dark: bool) -> ShownMap:
    views, image_size = snapshot.views, snapshot.camera.image_size
    if not views:
        return ShownMap(texts.CORNERS_TITLE, texts.NOTHING_YET)
    counts = coverage(views, image_size)
    return ShownMap(
        texts.CORNERS_TITLE,
        texts.CORNERS_TEXT if (counts == 0).any() else texts.CORNERS_FULL,
        coverage_picture(views, image_size, size, dark=dark),
        even_ticks(round_up(float(counts.max()))),
        texts.CORNERS_UNIT,
    )


def _lens(snapshot: Snapshot, size: tuple[int, int], dark: bool) -> ShownMap:
    calibration = snapshot.calibration
    if calibration is None or calibration.camera.is_pinhole:
        return ShownMap(texts.LENS_TITLE, texts.LENS_NONE)
    camera = calibration.camera
    factor, largest = distortion_magnification(camera), largest_shift_px(camera)
    magnified = texts.MAGNIFIED.format(factor=f"{factor:g}") if factor > 1 else ""
    return ShownMap(
        texts.LENS_TITLE,
        texts.LENS_TEXT.format(magnified=magnified, largest=figure(largest)),
        distortion_picture(camera, size, dark),
        even_ticks(round_up(largest)),
    )


def _misfit(snapshot: Snapshot, size: tuple[int, int], dark: bool, chosen: int | None) -> ShownMap:
    views, image_size = snapshot.views, snapshot.camera.image_size
    if not views:
        return ShownMap(texts.MISFIT_TITLE, texts.NOTHING_YET)
    among = chosen if any(view.number == chosen for view in views) else None
    factor = residual_magnification(views, image_size)
    sentence = texts.MISFIT_TEXT.format(magnified=f"{factor:g}")
    if among is not None:
        sentence += texts.MISFIT_CHOSEN.format(number=among)
    picture = residual_picture(views, image_size, size, dark=dark, chosen=among)
    return ShownMap(texts.MISFIT_TITLE, sentence, picture)


def _figures(shown: ShownMap) -> str:
    """The values at the picture's middle and four corners."""
    if shown.figures is None:
        return ""
    rows, columns = (n - 1 for n in shown.figures.shape)
    spots = ((0, 0, "tl"), (0, columns, "tr"), (rows // 2, columns // 2, "mid"))
    spots = (*spots, (rows, 0, "bl"), (rows, columns, "br"))
    return "".join(
        f"<b data-at='{place}'>{number(figure(float(shown.figures[row, column])))}</b>"
        for row, column, place in spots
    )
