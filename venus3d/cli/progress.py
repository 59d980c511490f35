"""How far a recording has been searched: a bar on a terminal, now and then a line elsewhere."""

from __future__ import annotations

import time
from collections.abc import Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from venus3d.cli.report import print_note
from venus3d.sources.recording import OnCount

_LINE_EVERY_S = 5.0


@contextmanager
def search_progress() -> Generator[OnCount, None, None]:
    """Tells images looked at, those that show the board, and the time left, on stderr."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _Lines()
        return
    columns = (
        TextColumn(
            "{task.completed} {task.fields[of]}looked at, {task.fields[found]} with the board"
        ),
        BarColumn(),
        TimeRemainingColumn(),
    )
    # What is printed meanwhile goes its usual way: a result is no part of the bar.
    with Progress(
        *columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False
    ) as progress:
        task = progress.add_task("", found=0, of="")

        def show(looked: int, found: int, total: int | None) -> None:
            if looked == 1:
                progress.reset(task)
            of = "" if total is None else f"of {total} "
            progress.update(task, completed=looked, total=total, found=found, of=of)

        yield show


class _Lines:
    """A line every few seconds, for a log."""

    def __init__(self) -> None:
        self._began_s = self._told_s = time.monotonic()

    def __call__(self, looked: int, found: int, total: int | None) -> None:
        now_s = time.monotonic()
        if looked == 1:
            self._began_s = now_s
        if now_s - self._told_s < _LINE_EVERY_S:
            return
        self._told_s = now_s
        of, left = "", ""
        if total is not None and total >= looked:
            of = f" of {total}"
            left = f", about {(now_s - self._began_s) / looked * (total - looked):.0f} s left"
        print_note(f"{looked}{of} pictures looked at, {found} show the board{left} ...")
