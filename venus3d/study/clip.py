"""Frames of a recording in memory, all at 720p and with the board, for timing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.board_reader import Region
from venus3d.engine.calibration.detection import Detector, search_region
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.recording import OnCount, observe_recording
from venus3d.study.pool import frames_with_board

Image = NDArray[np.uint8]
PIXELS = 1280 * 720
MOST_PICTURES = 60
"""Kept in memory, 2.8 MB each, and reused cyclically."""


@dataclass(frozen=True, eq=False)
class Clip:
    """Frames in memory that all show the board, with a first detection in each."""

    name: str
    images: tuple[Image, ...]
    observations: tuple[Observation, ...]
    board: Board
    camera: Camera
    is_video: bool
    notes: tuple[str, ...]

    def region(self, index: int) -> Region | None:
        """Where the board was in the frame before or, for stills, where it is held."""
        last = self.observations[index - 1 if self.is_video and index else index]
        return search_region(last, self.camera.image_size)


def load_clip(
    spec: str,
    board: Board,
    *,
    most: int = MOST_PICTURES,
    on_count: OnCount | None = None,
) -> Clip:
    """Up to `most` frames, evenly spread over those that show the board, at about 1280 x 720.

    Frames of another size are scaled to as many pixels, keeping the aspect ratio. Raises
    `SourceError` and `CalibrationError` as `pool_of` does.
    """
    detector = Detector(board)
    recording = observe_recording(spec, detector, on_count)
    seen = frames_with_board(recording, spec)
    chosen = set(np.array(seen)[np.linspace(0, len(seen) - 1, min(most, len(seen))).astype(int)])
    images = [_as_720p(image) for image in _frames(spec, chosen)]
    size = (images[0].shape[1], images[0].shape[0])
    original = recording.observations[0].image_size
    notes = (*recording.notes, *detector.notes)
    if size != original:
        notes += (
            f"The frames of {original[0]} x {original[1]} px were scaled to "
            f"{size[0]} x {size[1]} px.",
        )
    settled = Detector(detector.board, find_layout=False)
    found = [(image, settled.detect(image)) for image in images]
    usable = [(image, o) for image, o in found if o.count]
    observations = tuple(o for _, o in usable)
    camera = _camera_of(detector.board, observations, size)
    pictures = tuple(image for image, _ in usable)
    return Clip(spec, pictures, observations, detector.board, camera, recording.is_video, notes)


def _frames(spec: str, chosen: set[int]) -> Iterator[Image]:
    with closing(open_frame_source(spec)) as source:
        number = 0
        while (frame := source.read()) is not None:
            if number in chosen:
                yield frame.image
            number += 1


def _as_720p(image: Image) -> Image:
    """BGR, 8 bit, at 1280 x 720 px or as many pixels with the image's aspect ratio."""
    if image.dtype != np.uint8:
        image = cv2.convertScaleAbs(image, alpha=255 / max(1, int(image.max()))).astype(np.uint8)
    if image.ndim == 2:
        image = np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), dtype=np.uint8)
    height, width = image.shape[:2]
    scale = np.sqrt(PIXELS / (width * height))
    if abs(scale - 1) < 0.01:
        return image
    size = (round(width * scale), round(height * scale))
    smaller = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, size, interpolation=smaller), dtype=np.uint8)


def _camera_of(board: Board, observations: Sequence[Observation], size: tuple[int, int]) -> Camera:
    """A camera good enough for drawing: only time is measured."""
    if len(observations) < 3:
        return Camera.guess(size)
    places = np.linspace(0, len(observations) - 1, min(20, len(observations))).astype(int)
    try:
        return calibrate(board, [observations[i] for i in np.unique(places)]).camera
    except CalibrationError:
        return Camera.guess(size)
