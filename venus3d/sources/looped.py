"""A source that begins again when it ends, as a recording does until the user ends it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress

from venus3d.sources.frame import Source
from venus3d.sources.video import Video


class Looped:
    """Reopens a source that has ended. Used by one thread but for `close`."""

    def __init__(self, reopen: Callable[[], Source]) -> None:
        self._reopen = reopen
        self._opener = ThreadPoolExecutor(1, thread_name_prefix="reopen")
        self._opened: Future[Source] | None = None

    def open_ahead(self, source: Source) -> None:
        """Open a recording on the disk once more before it ends: that takes some tenths of a
        second. One on a server would be fetched twice at once."""
        on_disk = isinstance(source, Video) and not source.is_served
        if on_disk and self._opened is None:
            with suppress(RuntimeError):  # closed: no more are opened
                self._opened = self._opener.submit(self._reopen)

    def again(self, source: Source) -> Source:
        """Close the source, which has ended; what goes on in its place."""
        source.close()
        opened, self._opened = self._opened, None
        return self._reopen() if opened is None else opened.result()

    def close(self) -> None:
        """Close what was opened ahead."""
        self._opener.shutdown(wait=True, cancel_futures=True)
        if self._opened is not None and not self._opened.cancelled():
            with suppress(Exception):
                self._opened.result().close()
