"""What the commands print on stdout, made safe on the way."""

from __future__ import annotations

from typing import Any, TextIO

from venus3d.engine.printable import printable


class Printed:
    """Stands for stdout: control characters, as in the names of files, are written as text. Where
    it cannot be written, the command goes on, so that its files are written all the same."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.failure: OSError | None = None
        """Why it could not be written, the first time; nothing is written from then on."""

    def write(self, text: str) -> int:
        """Write a text as it can be shown."""
        if self.failure is None:
            try:
                self._stream.write(printable(text))
            except OSError as error:
                self.failure = error
        return len(text)

    def flush(self) -> None:
        """Write what is held back."""
        if self.failure is None:
            try:
                self._stream.flush()
            except OSError as error:
                self.failure = error

    def end(self) -> None:
        """Write what is held back. Raises the `OSError` if anything was not written."""
        self.flush()
        if self.failure is not None:
            raise self.failure

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
