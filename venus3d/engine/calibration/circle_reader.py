"""Reads grids of circles: blobs that lie in a grid of the board's size (`circle_grids`), which are
then followed from image to image by optical flow. Each circle's place is the centroid of its
darkness (`disc_centroids`), from which its centre is worked out (`discs`).

A grid of circles does not say which way up it is, unless every second row is shifted and the rows
are odd in number. Else the reading nearest to the last image's is taken, at first the upright one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import cv2
import numpy as np

from venus3d.engine.calibration.board_reader import NOTHING, Grey, Read, Region, WholeBoardReader
from venus3d.engine.calibration.circle_grids import alike_blobs, grids_of
from venus3d.engine.calibration.corner_grids import is_even, numbered, row_direction
from venus3d.engine.calibration.disc_centroids import disc_centroids
from venus3d.engine.calibration.following import flowed
from venus3d.engine.calibration.refinement import local_scales
from venus3d.engine.geometry.discs import centres_of_discs
from venus3d.engine.geometry.pose import Array

_LEAST_AREA, _MOST_AREA = 12.0, 0.05
"""Of a circle: pixels, and a share of the picture."""
_ROUND = 0.5
"""Circularity of a blob: a disc under 60 degrees has 0.84, and less where it is a few pixels; at a
wide lens's border one may be three times as long as wide."""

_SPREAD = 3.0
"""Of the circles' sizes, as a factor either way: a wide lens shows those before it five times as
large as those at its border."""
_REACH = 2.0
"""Radii of a disc around its centre that are looked at: up to half of the way to the next one, in
an asymmetric grid 2.8, a wide lens bends the board, and errors were three times as large."""
_FLOWN_PX, _FLOW_LEVELS = 14.0, 2
"""Diameter of the circles in the pictures in which they are followed, and how often these are
halved: within a large circle there is nothing to follow, and of many small ones each is like the
next."""
_LEAST_APART = 3.0
_BLUR_PX, _THRESHOLDS = 1.0, (20, 250, 15)
"""Noise makes blobs, which take time: with this blur and half of OpenCV's thresholds the search
takes a third."""


class CircleReader(WholeBoardReader):
    """The whole board, or nothing."""

    def read(self, grey: Grey, region: Region, quick: int) -> Read:
        """All circles' centres or none; `quick` only follows those of the last image."""
        picture = np.asarray(255 - grey if self.board.inverted else grey, dtype=np.uint8)
        grids = self._followed(picture, region) if quick else self._found(picture, region)
        for found in grids:
            seen = self._measured(picture, found)
            if seen is not None:
                break
        else:
            self._last = None
            return NOTHING
        if not self.is_copy:
            self._last, self._across = (picture, seen.reshape(found.shape)), row_direction(found)
        ids, _ = numbered(found)
        points = self.board.of_kind.points(self.board)
        self.centroids = seen
        return ids, centres_of_discs(points, seen, self.board.of_kind.radius(self.board))

    def _measured(self, grey: Grey, grid: Array) -> Array | None:
        """(N, 2) the circles' centroids; None if one is no circle."""
        ids, places = numbered(grid)
        scales, kind = local_scales(self.board, ids, places), self.board.of_kind
        radius = kind.radius(self.board)
        reach = min(kind.clearance(self.board), _REACH * radius)
        return disc_centroids(grey, places, scales, radius, reach)

    def _found(self, grey: Grey, region: Region) -> Iterator[Array]:
        x0, y0, x1, y1 = region
        blurred: Any = cv2.GaussianBlur(grey[y0:y1, x0:x1], (0, 0), _BLUR_PX)
        blobs = _blobs(blurred, _MOST_AREA * blurred.size)
        yield from self._grids_in(blobs, region)
        if len(blobs) >= self.board.corner_count:
            # The whole sheet is a blob at some thresholds if its middle lies in a circle, and its
            # place goes into that one's.
            largest = _SPREAD * float(np.median([blob.size for blob in blobs]))
            yield from self._grids_in(_blobs(blurred, largest**2), region)

    def _grids_in(self, blobs: Sequence[Any], region: Region) -> Iterator[Array]:
        board = self.board
        for centres in alike_blobs(blobs, _SPREAD):
            if len(centres) < board.corner_count:
                continue
            grids = grids_of(
                centres + np.array(region[:2]), board.columns, board.rows, board.of_kind.stride
            )
            if grids:
                yield max(grids, key=lambda one: float(row_direction(one) @ self._across))

    def _followed(self, grey: Grey, region: Region) -> Iterator[Array]:
        if self._last is None:
            return
        before, grid = self._last
        steps = np.linalg.norm(np.diff(grid, axis=1), axis=2).max()
        board = self.board
        diameter = steps * board.marker / (board.square * board.of_kind.stride)
        shrink = max(1, round(float(diameter) / _FLOWN_PX))
        now = flowed(before, grey, grid, region, shrink=shrink, levels=_FLOW_LEVELS)
        if now is None:
            return
        rows = (now[::2], now[1::2]) if board.of_kind.stride == 2 else (now,)
        if all(map(is_even, rows)):
            yield now


def _blobs(grey: Grey, most_area: float) -> Sequence[Any]:
    """Dark circles in an image (H, W) of up to this area, pixels."""
    wanted = cv2.SimpleBlobDetector.Params()
    wanted.filterByCircularity, wanted.minCircularity = True, _ROUND
    wanted.minArea, wanted.maxArea = _LEAST_AREA, most_area
    wanted.minDistBetweenBlobs = _LEAST_APART
    wanted.minThreshold, wanted.maxThreshold, wanted.thresholdStep = _THRESHOLDS
    return cv2.SimpleBlobDetector.create(wanted).detect(grey)
