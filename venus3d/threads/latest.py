"""A one-slot box between two threads in which the newest value wins."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Latest(Generic[T]):
    """One value passed from one thread to another: a late reader gets the newest.
    Values that nobody took are dropped. None is no value."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._value: T | None = None
        self._fresh = False
        self._closed = False

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._closed

    def put(self, value: T) -> None:
        """Replace the box's value; never waits. Ignored once the box is closed."""
        with self._changed:
            if self._closed:
                return
            self._value, self._fresh = value, True
            self._changed.notify()

    def take(self, timeout: float | None = None) -> T | None:
        """The newest value not taken yet; waits for one up to `timeout` seconds.
        None after the timeout, or when the box is closed and its last value was taken."""
        with self._changed:
            self._changed.wait_for(lambda: self._fresh or self._closed, timeout)
            if not self._fresh:
                return None
            self._fresh = False
            return self._value

    def peek(self) -> T | None:
        """The newest value, taken or not; None if there never was one. Never waits."""
        with self._changed:
            return self._value

    def close(self) -> None:
        """Wake all waiting threads; no more values are accepted. May be called twice."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
