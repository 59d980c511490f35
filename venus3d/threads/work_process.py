"""Calibrates and searches in a process of its own: a thread would share the interpreter with those
that draw, and the picture would wait for it."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from multiprocessing.connection import Connection

from venus3d.engine.errors import CalibrationError
from venus3d.engine.guidance.loop import Calibrated
from venus3d.engine.guidance.work import Outcome, Work
from venus3d.threads.child_process import ChildProcess

_READY = "ready"
_STOP = "stop"


class WorkProcess:
    """Does one `Work` at a time; the newest one wins. Used by one thread, which never waits.

    The process ends when this one does, even if this one is killed.
    """

    def __init__(self, on_calibrated: Callable[[Work, Calibrated], None]) -> None:
        """Starts the process; it is ready a second later, and takes work at once.
        `on_calibrated` is called by `take` when a work has calibrated and begins to search."""
        self._on_calibrated = on_calibrated
        self._wanted: Work | None = None
        self._doing: Work | None = None
        self._idle = False
        self._child = ChildProcess("calibrates and searches", "think", _serve)

    @property
    def work(self) -> Work | None:
        """The work whose outcome has not come yet."""
        return self._wanted

    def begin(self, work: Work) -> None:
        """Have this work done. One that is going on ends early, and its outcome is dropped."""
        self._wanted = work
        if self._idle:
            self._hand_over()
        else:
            self._send(_STOP)

    def take(self) -> Outcome | CalibrationError | None:
        """The outcome of `work`, once, or why it has none; None while there is none.
        Raises `RuntimeError` if the process dies again and again."""
        try:
            while self._child.pipe.poll():
                answer = self._receive(self._child.pipe.recv())
                if answer is not None:
                    return answer
        except (EOFError, OSError):
            self._child.start_again()
            self._idle, self._doing = False, None
        return None

    def close(self) -> None:
        """End the process; what it was doing is lost."""
        self._child.close()

    def _receive(self, answer: object) -> Outcome | CalibrationError | None:
        work = self._doing if self._doing is self._wanted else None
        if isinstance(answer, Calibrated):
            if work is not None:
                self._on_calibrated(work, answer)
            return None
        self._idle, self._doing = True, None
        if work is None:
            self._hand_over()
            return None
        self._wanted = None
        self._child.works()
        if isinstance(answer, Outcome):
            return replace(answer, work=work)  # the very object, not its copy
        assert isinstance(answer, CalibrationError)
        return answer

    def _hand_over(self) -> None:
        # Only now: a process that reads does not keep the sender waiting.
        if self._wanted is not None:
            self._idle, self._doing = False, self._wanted
            self._send(self._wanted)

    def _send(self, message: object) -> None:
        with suppress(OSError):  # the process is gone: `take` starts another one
            self._child.pipe.send(message)


def _serve(pipe: Connection) -> None:
    """The process: works until the other end is closed. What comes while it searches, the end too,
    stops the search."""
    if hasattr(os, "nice"):
        os.nice(3)  # where cores are few, what moves comes first

    def calibrated(figures: Calibrated) -> None:
        pipe.send(figures)

    with suppress(EOFError, OSError):
        pipe.send(_READY)
        while True:
            message = pipe.recv()
            if isinstance(message, Work):
                try:
                    pipe.send(message.run(pipe.poll, on_calibrated=calibrated))
                except CalibrationError as error:
                    pipe.send(error)
