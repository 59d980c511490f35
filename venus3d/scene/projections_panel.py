"""The four steps as the camera itself would see them, two by two, the one shown now marked."""

from __future__ import annotations

import base64
from concurrent.futures import Future

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.scene.style import Theme

Picture = NDArray[np.uint8]


def encoded(picture: Picture) -> str:
    """An RGB picture as the source of an HTML image."""
    bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    _, buffer = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 88])
    return "data:image/jpeg;base64," + base64.b64encode(buffer.tobytes()).decode("ascii")


def projections_html(pictures: tuple[str, ...], step: int, theme: Theme, note: str = "") -> str:
    """Four tiles; an empty source is a picture that is still being drawn; none: no target."""
    if not pictures:
        return "<div class='v-steps'><h3>The four steps of the next target appear here.</h3></div>"
    tiles: list[str] = []
    for number, source in enumerate(pictures, start=1):
        shown = " v-on" if number == step else ""
        inside = (
            f"<img alt='Step {number} as the camera sees it' src='{source}'>"
            if source
            else f"<div class='v-wait'>Step {number}</div>"
        )
        tiles.append(
            f"<div class='v-tile{shown}' data-step='{number}' "
            f"style='--step:{theme.steps[number - 1]}'>{inside}</div>"
        )
    foot = f"<div class='v-legend'>{note}</div>" if note else ""
    return (
        "<div class='v-steps'><h3>The four steps from a frontal board, as the camera will see "
        f"them</h3><div class='v-grid'>{''.join(tiles)}</div>{foot}</div>"
    )


class Tiles:
    """The pictures of one target, taken over as they are finished."""

    def __init__(self) -> None:
        """No pictures yet."""
        self.key: object = None
        self._futures: tuple[Future[Picture], ...] = ()
        self._sources: tuple[str, ...] = ()

    @property
    def waiting(self) -> bool:
        """Whether pictures are being drawn."""
        return bool(self._futures)

    def expect(self, key: object, futures: tuple[Future[Picture], ...]) -> None:
        """Wait for these four; the old ones stay until then."""
        self.key, self._futures = key, futures
        self._sources = self._sources or ("",) * len(futures)

    def forget(self) -> None:
        """There is no target."""
        self.key, self._futures, self._sources = None, (), ()

    def sources(self) -> tuple[str, ...]:
        """Sources of the four images; never waits. Raises what broke the drawing of one."""
        if self._futures and all(future.done() for future in self._futures):
            self._sources = tuple(encoded(future.result()) for future in self._futures)
            self._futures = ()
        return self._sources
