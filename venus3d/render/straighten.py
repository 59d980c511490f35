"""The live picture without lens distortion."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.undistortion import undistortion_maps
from venus3d.render.annotated_picture import CASING

_LINE = (255, 255, 255)


class Straightener:
    """Removes a camera's distortion from pictures. The map is made once for each camera and size of
    picture. Used by one thread."""

    def __init__(self) -> None:
        self._key: tuple[object, ...] = ()
        self._maps: tuple[NDArray[Any], NDArray[Any]] | None = None

    def straighten(self, rgb: NDArray[np.uint8], camera: Camera, share: float) -> None:
        """Show the left `share` of a picture (H, W, 3) as a lens without distortion would, in
        place, with a line where it ends. The camera matrix stays, so the middle keeps its scale."""
        height, width = rgb.shape[:2]
        end = round(width * min(max(share, 0.0), 1.0))
        if not end:
            return
        one, two = self._maps_for(camera, (width, height))
        rgb[:, :end] = cv2.remap(rgb, one, two, cv2.INTER_LINEAR, borderValue=CASING)[:, :end]
        if end < width:
            cv2.line(rgb, (end, 0), (end, height), CASING, 4)
            cv2.line(rgb, (end, 0), (end, height), _LINE, 2)

    def _maps_for(self, camera: Camera, size: tuple[int, int]) -> tuple[NDArray[Any], NDArray[Any]]:
        key = (camera, size)
        if self._maps is None or key != self._key:
            seen = camera.scaled(size)
            self._maps = undistortion_maps(seen, seen.K, size)
            self._key = key
        return self._maps
