"""Detects the board in a process of its own: a thread would share the interpreter with those that
draw, and the scene would wait for it."""

from __future__ import annotations

import pickle
import threading
import traceback
from collections.abc import Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from multiprocessing.sharedctypes import RawArray
from typing import Any

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.opencv_log import silence_opencv
from venus3d.threads.child_process import ChildProcess
from venus3d.threads.latency import low_latency


@dataclass(frozen=True)
class _Picture:
    """A frame whose pixels lie in the shared memory."""

    shape: tuple[int, ...]
    pixel_type: str
    time_s: float
    name: str


@dataclass(frozen=True)
class _Raised:
    """What the detection raised, and where."""

    error: Exception
    traceback: str


class DetectionProcess:
    """A `BoardTracker` in another process, used in the same way. Threads take turns.

    One that dies is replaced, and so is one for whose shared memory a frame is too large; the next
    one learns the board's layout anew.
    """

    def __init__(
        self, detector: Detector, image_size: tuple[int, int], *, look_beside: bool = False
    ) -> None:
        """Starts the process; it is ready a second later. Frames of `image_size` (width, height)
        are expected. `look_beside`: see `BoardTracker`."""
        self._detector, self._look_beside = detector, look_beside
        self._turn = threading.Lock()
        self._replacing, self._closed = threading.Lock(), False
        self._board: Board | None = None
        self._notes, self._diagnoses = detector.notes, detector.diagnoses
        self._start(3 * image_size[0] * image_size[1])

    @property
    def notes(self) -> tuple[str, ...]:
        """As the detector's, after the last frame."""
        return self._notes

    @property
    def diagnoses(self) -> tuple[Diagnosis, ...]:
        """As the detector's, after the last frame."""
        return self._diagnoses

    def track(self, frame: Frame) -> Observation:
        """The board in this frame, with its image and how long it took to find it; nothing once
        closed. Raises what the detection raises, and `RuntimeError` if the process dies again and
        again."""
        pixels = frame.image
        with self._turn:
            if self._closed:
                return Observation.nothing(frame.image_size, frame.time_s, frame.name)
            if pixels.nbytes > len(self._shared):
                with self._replacing:
                    if not self._closed:
                        self._child.close()
                        self._start(pixels.nbytes)
            np.copyto(_pixels(self._shared, pixels.shape, pixels.dtype.str), pixels)
            asked = _Picture(pixels.shape, pixels.dtype.str, frame.time_s, frame.name)
            while not self._closed:
                try:
                    seen, self._notes, self._diagnoses = self._asked(asked)
                except (EOFError, OSError):
                    with self._replacing:
                        if not self._closed:
                            self._child.start_again()
                    continue
                self._child.works()
                # One object for one board, not a copy in each observation.
                if seen.board != self._board:
                    self._board = seen.board
                return replace(seen, image=frame.image, board=self._board)
        return Observation.nothing(frame.image_size, frame.time_s, frame.name)

    def explain_misses(self) -> tuple[Diagnosis, ...]:
        """As the detector's; nothing if the process that saw the images has died."""
        with self._turn, suppress(EOFError, OSError):
            return self._asked(None)
        return ()

    def close(self) -> None:
        """End the process, whatever it is doing. May be called twice."""
        with self._replacing:  # none is begun afterwards
            if not self._closed:
                self._closed = True
                self._child.close()

    def _start(self, size: int) -> None:
        self._shared = RawArray("B", size)
        self._child = ChildProcess(
            "finds the board", "detect", _serve, self._shared, self._detector, self._look_beside
        )

    def _asked(self, question: _Picture | None) -> Any:
        self._child.pipe.send(question)
        answer = self._child.pipe.recv()
        if isinstance(answer, _Raised):
            raise answer.error from RuntimeError(answer.traceback)
        return answer


def _pixels(shared: Any, shape: Sequence[int], pixel_type: str) -> NDArray[Any]:
    count = int(np.prod(shape))
    return np.frombuffer(shared, np.dtype(pixel_type), count).reshape(shape)


def _serve(pipe: Connection, shared: Any, detector: Detector, look_beside: bool) -> None:
    """The process: answers until the other end is closed."""
    silence_opencv()
    tracker = BoardTracker(detector, look_beside=look_beside)
    with suppress(EOFError, OSError), closing(tracker), low_latency():
        while True:
            question = pipe.recv()
            try:
                answer = _answered(tracker, shared, question)
            except Exception as error:
                answer = _Raised(_sendable(error), traceback.format_exc())
            pipe.send(answer)


def _answered(tracker: BoardTracker, shared: Any, question: _Picture | None) -> Any:
    if question is None:  # what the images without the board show
        return tracker.explain_misses()
    # The detector keeps images, and the memory's next one comes soon.
    image = _pixels(shared, question.shape, question.pixel_type).copy()
    seen = tracker.track(Frame(image, question.time_s, question.name))
    return seen.without_image(), tracker.notes, tracker.diagnoses


def _sendable(error: Exception) -> Exception:
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(repr(error))
    return error
