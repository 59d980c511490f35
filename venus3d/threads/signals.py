"""Signals that ask a program to end: Ctrl-C, kill, a closed terminal."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager


@contextmanager
def on_stop_signal(act: Callable[[], None], *, ctrl_c: bool = True) -> Generator[None, None, None]:
    """Context in which each of these signals calls `act` on the main thread.

    SIGHUP is unchanged if it is ignored on purpose (nohup) or does not exist (Windows). No effect
    on other threads: Python delivers signals to the main thread only.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def obey(number: int, _: object) -> None:
        if number not in (signal.SIGINT, signal.SIGTERM):
            # Kernel and shell both signal a closed terminal; the second one would interrupt the
            # clean end requested by the first.
            signal.signal(number, signal.SIG_IGN)
        act()

    before = {number: signal.getsignal(number) for number in _numbers(ctrl_c)}
    for number in before:
        signal.signal(number, obey)
    try:
        yield
    finally:
        for number, handler in before.items():
            if signal.getsignal(number) is obey:
                signal.signal(number, handler)


def _numbers(ctrl_c: bool) -> list[signal.Signals]:
    numbers = [signal.SIGINT, signal.SIGTERM] if ctrl_c else [signal.SIGTERM]
    if sys.platform != "win32" and signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        numbers.append(signal.SIGHUP)
    return numbers
