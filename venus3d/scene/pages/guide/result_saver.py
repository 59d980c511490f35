"""The newest calibration on its way to the disk, on a thread of its own."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable

from venus3d.engine.calibration.result import Calibration
from venus3d.engine.errors import VenusError
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import texts
from venus3d.threads.latest import Latest

_LOG = logging.getLogger(__name__)


def is_over(snapshot: Snapshot) -> bool:
    """Whether no more views are asked for."""
    return snapshot.phase in ("converged", "finished")


class ResultSaver:
    """Has every new calibration written; the newest wins, and nobody waits for the disk."""

    def __init__(
        self,
        write: Callable[[Snapshot], str],
        saved: Callable[[str], None] = lambda _: None,
        failed: Callable[[str], None] = lambda _: None,
    ) -> None:
        """Nothing runs until there is something to write.

        Args:
            write: writes one moment's calibration; gives back a sentence that says where.
            saved: hears that sentence when the calibration is over.
            failed: hears why something could not be written; the next view is tried again.
        """
        self._write, self._saved, self._failed = write, saved, failed
        self._box: Latest[Snapshot] = Latest()
        self._known: Calibration | None = None
        self._was_over = False
        # No daemon: what is in the box is written even if whoever closes this is interrupted.
        self._thread = threading.Thread(target=self._run, name="keep", daemon=False)
        self._started = False

    def put(self, snapshot: Snapshot) -> None:
        """Have this moment written if there is a new calibration in it, or it is over; never waits.

        Where no view is left, what was written last stays.
        """
        known, over = snapshot.calibration, is_over(snapshot)
        if known is not None and (known is not self._known or (over and not self._was_over)):
            self._box.put(snapshot)
            if not self._started:
                self._thread.start()
                self._started = True
        self._known, self._was_over = known, over

    def close(self) -> None:
        """Write what is still to be written. May be called twice."""
        self._box.close()
        if self._started:
            self._thread.join()

    def _run(self) -> None:
        while (snapshot := self._box.take()) is not None:
            try:
                sentence = self._write(snapshot)
            except VenusError as error:
                self._failed(texts.NOT_SAVED.format(error=error))
            except Exception:  # a mistake of ours: the next view is worth trying
                _LOG.exception(texts.NOT_SAVED_LOG)
                self._failed(texts.NOT_SAVED_MISTAKE)
            else:
                if is_over(snapshot):
                    self._saved(sentence)
