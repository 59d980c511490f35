"""The signals that ask a program to end: Ctrl-C, a plain kill, a terminal that was closed."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager


@contextmanager
def on_stop_signal(act: Callable[[], None], *, ctrl_c: bool = True) -> Generator[None, None, None]:
    """Meanwhile call `act`, on the main thread, for each of these signals.

    SIGHUP stays as it is where it is ignored on purpose (nohup) and where there is none (Windows).
    On another thread nothing changes: Python lets only the main thread take signals.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def obey(number: int, _: object) -> None:
        if number not in (signal.SIGINT, signal.SIGTERM):
            # The kernel and the shell both tell of a closed terminal. The second time would break
            # off what the first has asked to be ended well.
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
