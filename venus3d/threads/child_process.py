"""A process of its own with a pipe to it. It ends when this one does, even if this one is killed,
and hears nothing of the terminal: Ctrl-C and a closed terminal go to all processes of one, and the
one that starts the others decides."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
from collections.abc import Callable, Generator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from typing import Any

_LOG = logging.getLogger(__name__)
_TRIES = 2
_BLAS = "OPENBLAS_NUM_THREADS"


class ChildProcess:
    """`serve(pipe, *arguments)` in another process, until the pipe's other end is closed. Used by
    one thread."""

    def __init__(self, does: str, name: str, serve: Callable[..., None], *arguments: Any) -> None:
        """Starts the process. `does` follows "The process that" where its death is told; `serve`
        is a module's function, and all `arguments` can be pickled."""
        self._does, self._name = does, name
        self._serve, self._arguments = serve, arguments
        self._tries = 0
        self._start()

    def works(self) -> None:
        """Forget the deaths before: it has done something since."""
        self._tries = 0

    def start_again(self) -> None:
        """Another process in place of one that died; `pipe` leads to it.
        Raises `RuntimeError` if it dies again and again."""
        self._process.kill()  # if its end of the pipe alone is gone
        self._process.join()
        self._tries += 1
        told = f"The process that {self._does} ended with code {self._process.exitcode}"
        if self._tries > _TRIES:
            raise RuntimeError(f"{told}, {self._tries} times.")
        # A whole group of processes that is asked to end (a service that stops) is no fault.
        if self._process.exitcode != -signal.SIGTERM:
            _LOG.warning("%s; another one does its work.", told)
        self.pipe.close()
        self._start()

    def close(self) -> None:
        """End the process; what it was doing is lost. A thread that waits for it is woken up."""
        self._process.kill()
        self._process.join()
        self._process.close()
        self.pipe.close()

    def _start(self) -> None:
        # A copy ("fork") of a process that has threads and OpenGL may hang.
        context = multiprocessing.get_context("spawn")
        self.pipe: Connection
        self.pipe, theirs = context.Pipe()
        self._process = context.Process(
            target=self._serve, args=(theirs, *self._arguments), name=self._name, daemon=True
        )
        with _deaf_to_the_terminal(), _one_blas_thread():
            self._process.start()
        theirs.close()


@contextmanager
def _deaf_to_the_terminal() -> Generator[None, None, None]:
    """Context in which processes are started that hear neither Ctrl-C nor a terminal's end."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # starting it would undo the mask
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _one_blas_thread() -> Generator[None, None, None]:
    """Context in which processes are started whose matrices are multiplied by one thread. Where
    other processes want the cores too, several wait for each other: a search took 1.6 times as
    long. numpy reads this when it is loaded; what the user has set stays."""
    given = _BLAS in os.environ
    os.environ.setdefault(_BLAS, "1")
    try:
        yield
    finally:
        if not given:
            del os.environ[_BLAS]
