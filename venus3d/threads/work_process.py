"""Calibrates and searches in a process of its own: a thread would share the interpreter with those
that draw, and the picture would wait for it."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from dataclasses import replace
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection

from venus3d.engine.errors import CalibrationError
from venus3d.engine.guidance.loop import Calibrated
from venus3d.engine.guidance.work import Outcome, Work

_LOG = logging.getLogger(__name__)
_TRIES = 2
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
        self._tries = 0
        self._start()

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
            while self._pipe.poll():
                answer = self._receive(self._pipe.recv())
                if answer is not None:
                    return answer
        except (EOFError, OSError):
            self._start_again()
        return None

    def close(self) -> None:
        """End the process; what it was doing is lost."""
        self._pipe.close()
        self._process.kill()
        self._process.join()
        self._process.close()

    def _start(self) -> None:
        # A copy ("fork") of a process that has threads and OpenGL may hang.
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._doing: Work | None = None
        self._process = context.Process(target=_serve, args=(theirs,), name="think", daemon=True)
        self._idle = False
        with _deaf_to_the_terminal():
            self._process.start()
        theirs.close()

    def _start_again(self) -> None:
        self._process.kill()  # if its end of the pipe alone is gone
        self._process.join()
        self._tries += 1
        told = f"The process that calibrates and searches ended with code {self._process.exitcode}"
        if self._tries > _TRIES:
            raise RuntimeError(f"{told}, {self._tries} times.")
        # A whole group of processes that is asked to end (a service that stops) is no fault.
        if self._process.exitcode != -signal.SIGTERM:
            _LOG.warning("%s; another one does its work.", told)
        self._pipe.close()
        self._start()

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
        self._wanted, self._tries = None, 0
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
            self._pipe.send(message)


@contextmanager
def _deaf_to_the_terminal() -> Generator[None, None, None]:
    """Context in which processes are started that hear neither Ctrl-C nor that the terminal is
    closed, which go to all processes of a terminal: the one that starts them decides."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # starting it would undo the mask
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


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
