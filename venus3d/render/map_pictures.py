"""Maps over the camera's image as RGB pictures: uncertainty, coverage, distortion, residuals. They
hold no text: numbers and legends stand beside them."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.observation import View
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.render.colour_scale import colours_of, magnification, round_up
from venus3d.render.palette import ground, mixed
from venus3d.render.shapes import Colour

Picture = NDArray[np.uint8]
CELLS = (12, 8)
"""Columns and rows of the image in which corners are counted."""
_ARROWS = (16, 9)
_INK: Colour = (255, 255, 255)
_CASING: Colour = (16, 20, 28)
_SHIFT = 4  # cv2 draws at 1/16 px
_FIELD = (64, 36)
# Longest arrow, in distances between arrows.
_REACH = 1.5


def uncertainty_picture(
    uncertainty_px: Array, ends_px: tuple[float, float], size: tuple[int, int], *, dark: bool
) -> Picture:
    """Projection uncertainty (rows, columns), pixels, over the image: `size` (width, height). The
    colour scale is logarithmic: at the border the values are often a hundred times those in the
    middle. NaN (no ray reaches that pixel) is hatched."""
    low, high = np.log(ends_px)
    return _heat(np.log(np.maximum(uncertainty_px, 1e-12)), low, high, size, dark)


def difference_picture(
    diff_px: Array, high_px: float, size: tuple[int, int], *, dark: bool
) -> Picture:
    """Projection difference of two cameras (rows, columns), pixels, over the image, coloured from 0
    to `high_px`. NaN is hatched."""
    return _heat(diff_px, 0.0, high_px, size, dark)


def coverage(views: Sequence[View], image_size: tuple[int, int]) -> NDArray[np.intp]:
    """(rows, columns) number of captured corners in each of the `CELLS`."""
    counts = np.zeros(CELLS[::-1], np.intp)
    for view in views:
        place = (view.observation.corners + 0.5) / image_size * CELLS
        column, row = np.clip(place.astype(np.intp), 0, np.array(CELLS) - 1).T
        np.add.at(counts, (row, column), 1)
    return counts


def coverage_picture(
    views: Sequence[View], image_size: tuple[int, int], size: tuple[int, int], *, dark: bool
) -> Picture:
    """Where corners were: cells coloured by their number, hatched if empty; each corner a dot."""
    counts = coverage(views, image_size)
    high = round_up(float(counts.max()))
    picture = np.repeat(np.repeat(colours_of(counts, 0, high), 64, axis=0), 64, axis=1)
    picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)
    empty = cv2.resize((counts == 0).astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)
    _hatch(picture, np.asarray(empty) > 0, dark)
    scale = np.array(size) / image_size
    for view in views:
        for spot in (view.observation.corners + 0.5) * scale - 0.5:
            _dot(picture, spot, size[0] / 320)
    return picture


def distorted_grid(camera: Camera, grid: tuple[int, int] = _ARROWS) -> tuple[Array, Array]:
    """Pixels (N, 2) of an ideal lens over the image, and where this lens puts them (N, 2); NaN
    where the lens model ends."""
    across, down = grid
    u = (np.arange(across) + 0.5) * camera.width / across - 0.5
    v = (np.arange(down) + 0.5) * camera.height / down - 0.5
    ideal = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    rays = (ideal - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    return ideal, camera.project(np.concatenate([rays, np.ones((len(rays), 1))], axis=1))


def largest_shift_px(camera: Camera) -> float:
    """The largest shift of a pixel that `distortion_picture` shows; 0 for none."""
    return _longest(*distorted_grid(camera, _FIELD))


def distortion_magnification(camera: Camera) -> float:
    """Factor by which `distortion_picture` lengthens the shifts."""
    return magnification(_longest(*distorted_grid(camera)), _REACH * camera.width / _ARROWS[0])


def _longest(ideal: Array, seen: Array) -> float:
    shifts = np.linalg.norm(seen - ideal, axis=1)
    return float(np.nanmax(shifts)) if np.isfinite(shifts).any() else 0.0


def distortion_picture(camera: Camera, size: tuple[int, int], dark: bool) -> Picture:
    """RGB picture of `size` (width, height): where the lens moves each point of an ideal picture.

    Arrows lead from a point's ideal to its real place, lengthened by `distortion_magnification`.
    The background is coloured by the distance, 0 to `round_up(largest_shift_px(camera))` pixels,
    and hatched where the lens model ends.
    """
    ideal, seen = distorted_grid(camera, _FIELD)
    shifts = np.linalg.norm(seen - ideal, axis=1).reshape(_FIELD[::-1])
    picture = _heat(shifts, 0.0, round_up(largest_shift_px(camera)), size, dark)
    start, end = distorted_grid(camera)
    end = start + (end - start) * distortion_magnification(camera)
    _arrows(picture, start, end, camera.image_size)
    return picture


def residual_magnification(views: Sequence[View], image_size: tuple[int, int]) -> float:
    """Factor by which `residual_picture` lengthens the residuals, so that 98 % of them stay shorter
    than a twentieth of the image's width."""
    lengths = np.concatenate([np.linalg.norm(view.errors, axis=1) for view in views])
    return magnification(float(np.percentile(lengths, 98)), image_size[0] / 20)


def residual_picture(
    views: Sequence[View],
    image_size: tuple[int, int],
    size: tuple[int, int],
    *,
    dark: bool,
    chosen: int | None = None,
) -> Picture:
    """Observed minus calculated corners as lines, lengthened by `residual_magnification` and
    coloured by length, 0 to the longest. With `chosen`, the number of a view, the others are
    faint."""
    paper = ground(dark).background
    picture = np.empty((size[1], size[0], 3), np.uint8)
    picture[:] = mixed(paper, ground(dark).text, 0.07)
    scale = np.array(size) / image_size
    stretch = residual_magnification(views, image_size)
    # Yellow is lost on white: use the scale only as far as it is visible.
    quiet = mixed(paper, ground(dark).text, 0.3)
    ink, mark = ground(dark).text, ground(dark).warning
    for view in sorted(views, key=lambda v: v.number == chosen):
        start = (view.observation.corners + 0.5) * scale - 0.5
        end = start + view.errors * stretch * scale
        loud = chosen is None or view.number == chosen
        colour = (mark if chosen is not None else ink) if loud else quiet
        for a, b in zip(start, end, strict=True):
            _line(picture, a, b, colour, 2 if loud else 1)
            _dot(picture, a, size[0] / 360, colour)
    return picture


def _heat(values: Array, low: float, high: float, size: tuple[int, int], dark: bool) -> Picture:
    """Values (rows, columns) at cell centres, interpolated to smooth colours; NaN is hatched."""
    known = np.isfinite(values)
    filled = np.where(known, values, high).astype(np.float32)
    smooth = cv2.resize(filled, size, interpolation=cv2.INTER_CUBIC)
    picture = colours_of(smooth, low, high)
    if not known.all():
        gaps = cv2.resize((~known).astype(np.uint8), size, interpolation=cv2.INTER_NEAREST)
        _hatch(picture, np.asarray(gaps) > 0, dark)
    return picture


def _hatch(picture: Picture, where: NDArray[np.bool_], dark: bool) -> None:
    """Stripes in neutral colours where nothing is known."""
    paper, ink = ground(dark).background, ground(dark).text
    rows, columns = np.indices(where.shape)
    stripe = (rows + columns) % 14 < 3
    picture[where & ~stripe] = mixed(paper, ink, 0.1)
    picture[where & stripe] = mixed(paper, ink, 0.3)


def _arrows(picture: Picture, start: Array, end: Array, image_size: tuple[int, int]) -> None:
    scale = np.array([picture.shape[1], picture.shape[0]]) / image_size
    width = max(1, round(picture.shape[1] / 400))
    seen = np.isfinite(end).all(axis=1)
    tails, tips = ((points[seen] + 0.5) * scale - 0.5 for points in (start, end))
    for ink, extra in ((_CASING, 2), (_INK, 0)):
        for tail, tip in zip(tails, tips, strict=True):
            along = tip - tail
            length = float(np.linalg.norm(along))
            if length < 1.5:
                _dot(picture, tail, width, ink)
                continue
            _line(picture, tail, tip, ink, width + extra)
            back = -along / length * min(0.4 * length, 4.0 * width + 2)
            for aside in (np.array([-back[1], back[0]]), np.array([back[1], -back[0]])):
                _line(picture, tip, tip + back + 0.6 * aside, ink, width + extra)


def _line(picture: Picture, a: Array, b: Array, colour: Colour, width: int) -> None:
    if np.isfinite([a, b]).all() and (np.abs([a, b]) < 1e4).all():
        one, other = (np.round(p * 16).astype(int).tolist() for p in (a, b))
        cv2.line(picture, one, other, colour, width, cv2.LINE_AA, _SHIFT)


def _dot(picture: Picture, at: Array, radius: float, colour: Colour = _INK) -> None:
    x, y = np.round(at * 16).astype(int).tolist()
    cv2.circle(picture, (x, y), round(radius * 16), colour, -1, cv2.LINE_AA, _SHIFT)
