"""Writes the newest calibration to disk on its own thread."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from contextvars import copy_context

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.errors import VenusError
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import translated_error
from venus3d.scene.pages.guide import terminal_texts, texts
from venus3d.threads.latest import Latest

_LOG = logging.getLogger(__name__)

RETRY_S = 2.0
"""Seconds after which a failed write is tried again."""


def is_over(snapshot: Snapshot) -> bool:
    """Whether no more views are requested."""
    return snapshot.phase in ("converged", "finished")


class ResultSaver:
    """Writes every new calibration, the newest first; callers never wait for the disk."""

    def __init__(
        self,
        write: Callable[[Snapshot], str],
        saved: Callable[[str], None] = lambda _: None,
        failed: Callable[[str], None] = lambda _: None,
    ) -> None:
        """No thread runs until there is something to write.

        Args:
            write: writes one moment's calibration; returns a sentence that says where.
            saved: called with that sentence when the calibration is over.
            failed: called with the reason of a failed write, which is tried again.
        """
        self._write, self._saved, self._failed = write, saved, failed
        self._box: Latest[Snapshot] = Latest()
        self._known: Calibration | None = None
        self._was_over = False
        # Not a daemon: the pending result is written even if the closing thread is interrupted.
        self._thread = threading.Thread(
            target=copy_context().run, args=(self._run,), name="keep", daemon=False
        )
        self._started = False

    def put(self, snapshot: Snapshot) -> None:
        """Queue this moment if it has a new calibration or is the last; never waits. If no view is
        left, the last file stays."""
        known, over = snapshot.calibration, is_over(snapshot)
        if known is not None and (known is not self._known or (over and not self._was_over)):
            self._box.put(snapshot)
            if not self._started:
                self._thread.start()
                self._started = True
        self._known, self._was_over = known, over

    def close(self) -> None:
        """Write what is pending. May be called twice."""
        self._box.close()
        if self._started:
            self._thread.join()

    def _run(self) -> None:
        failed: Snapshot | None = None
        while True:
            newest = self._box.take(None if failed is None else RETRY_S)
            snapshot = failed if newest is None else newest
            if snapshot is None:
                return  # closed
            failed = None if self._is_written(snapshot, told=newest is None) else snapshot
            if newest is None and self._box.closed:
                return  # the last chance

    def _is_written(self, snapshot: Snapshot, *, told: bool) -> bool:
        """Write; False if it is worth another try. `told`: a failure is known already."""
        try:
            sentence = self._write(snapshot)
        except VenusError as error:
            if not told:
                self._failed(texts.NOT_SAVED.format(error=translated_error(error)))
            return False
        except Exception:  # our error: the next view is worth trying
            _LOG.exception(terminal_texts.NOT_SAVED_LOG)
            self._failed(texts.NOT_SAVED_MISTAKE)
            return True
        if is_over(snapshot):
            self._saved(sentence)
        return True
