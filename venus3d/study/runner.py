"""Runs trials on all cores or a cluster, and journals their rows.
An interrupted run continues where it stopped. The rows of a finished run do not depend on the
number of cores."""

from __future__ import annotations

import csv
import io
import json
import logging
import threading
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, closing, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, TypeVar

import cv2

from venus3d.engine.errors import StorageError, VenusError
from venus3d.regular_file import read_regular
from venus3d.storage.folder import write_bytes
from venus3d.threads.signals import on_stop_signal

Value = str | int | float
Row = dict[str, Value]
_BEGINNING = b'{"setup": '
"""Of a journal."""
REACH_S = 15.0
"""Timeout for a Dask scheduler, seconds."""


class StudyTrial(Protocol):
    """One piece of work, small enough to be lost and repeated."""

    @property
    def key(self) -> str:
        """Unique among the trials and the same in every run."""
        ...


T = TypeVar("T", bound=StudyTrial)


def run_trials(
    function: Callable[[T], Sequence[Row]],
    trials: Sequence[T],
    rows_file: Path,
    *,
    setup: str = "",
    jobs: int | None = None,
    dask: str | None = None,
    label: str = "trials",
) -> list[Row]:
    """Run `function` on every trial; its rows in the trials' order, each with a column `trial`.

    Each trial's rows are appended to a journal beside `rows_file` at once, so that an interrupted
    run continues where it stopped. At the end `rows_file` (CSV) is written from it.

    Args:
        function: at a module's top level, so that other processes can import it. It seeds itself
            from the trial and returns no timings, or rows would differ from run to run.
        setup: everything besides the trial's key that decides the rows; the journal of another
            one is refused.
        jobs: processes; None for one per core.
        dask: address of a Dask scheduler, such as tcp://host:8786, to use instead.

    Raises `VenusError` for missing packages, a scheduler that does not answer and a journal of
    another set-up, `StorageError` for a file that cannot be read or written.
    """
    keys = [trial.key for trial in trials]
    if len(set(keys)) < len(keys):
        raise ValueError("two trials have the same key")
    journal = journal_of(rows_file)
    done = _opened(journal, setup)
    missing = [trial for trial in trials if trial.key not in done]
    tqdm: Any = needed("tqdm", "study").tqdm
    with ExitStack() as things:
        finished = (
            _on_cores(function, missing, jobs)
            if dask is None
            else _on_cluster(function, missing, dask, things)
        )
        bar = things.enter_context(
            closing(tqdm(total=len(keys), initial=len(keys) - len(missing), desc=label))
        )
        asked = things.enter_context(_asked_to_stop())
        try:
            for key, rows in finished:
                _append(journal, {"trial": key, "rows": list(rows)})
                done[key] = list(rows)
                bar.update()
                if asked.is_set():
                    raise KeyboardInterrupt
        except KeyboardInterrupt as stop:
            raise KeyboardInterrupt(
                f"{len(done)} of {len(keys)} trials are kept; the same command goes on from there"
            ) from stop
    table = [{"trial": key, **row} for key in keys for row in done[key]]
    write_bytes(rows_file, csv_of(table))
    return table


@contextmanager
def _asked_to_stop() -> Generator[threading.Event]:
    """An event set by a signal that asks to end. The `KeyboardInterrupt` raised as well may be lost
    where joblib collects garbage."""
    asked = threading.Event()

    def stop() -> None:
        asked.set()
        raise KeyboardInterrupt

    with on_stop_signal(stop):
        yield asked


def needed(module: str, extra: str) -> Any:
    """An optional package. Raises `VenusError` naming the extra if it is not installed."""
    try:
        return import_module(module)
    except ImportError as error:
        raise VenusError(
            f"This needs the package {module}; install it with: pip install 'venus3d[{extra}]'."
        ) from error


def _on_cores(
    function: Callable[[T], Sequence[Row]], trials: Sequence[T], jobs: int | None
) -> Iterator[tuple[str, Sequence[Row]]]:
    joblib: Any = needed("joblib", "study")
    count = max(1, min(joblib.cpu_count() if jobs is None else jobs, len(trials)))
    # The trials fill the cores; threads within them would only compete.
    with joblib.parallel_config("loky", n_jobs=count, inner_max_num_threads=1):
        parallel = joblib.Parallel(return_as="generator_unordered", batch_size=1)
        try:
            yield from parallel(joblib.delayed(_one)(function, trial) for trial in trials)
        except BrokenProcessPool as error:
            raise VenusError(
                "A worker process was killed, perhaps for want of memory; what is done is kept: "
                "run the same command again, with fewer --jobs."
            ) from error


def _on_cluster(
    function: Callable[[T], Sequence[Row]], trials: Sequence[T], address: str, things: ExitStack
) -> Iterator[tuple[str, Sequence[Row]]]:
    distributed: Any = needed("distributed", "cluster")
    # Its log messages about a lost cluster are replaced by the sentence below.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        client = things.enter_context(distributed.Client(address, timeout=REACH_S))
    except (OSError, TimeoutError, ValueError) as error:
        raise VenusError(
            f"No Dask scheduler answers at {address}; start one with `dask scheduler` and give its "
            "address, such as tcp://host:8786."
        ) from error
    if not client.scheduler_info()["workers"]:
        raise VenusError(
            f"The Dask scheduler at {address} has no workers; start one with "
            f"`dask worker {address}` where venus3d is installed."
        )
    return _gathered(distributed, client, function, trials)


def _gathered(
    distributed: Any, client: Any, function: Callable[[T], Sequence[Row]], trials: Sequence[T]
) -> Iterator[tuple[str, Sequence[Row]]]:
    futures = [client.submit(_one, function, trial, pure=False) for trial in trials]
    try:
        for future in distributed.as_completed(futures):
            yield future.result()
    except (distributed.KilledWorker, CancelledError, OSError) as error:
        raise VenusError(
            "The Dask cluster was lost on the way; what is done is kept: run the same command "
            "again once it is up."
        ) from error


def _one(function: Callable[[T], Sequence[Row]], trial: T) -> tuple[str, Sequence[Row]]:
    # OpenCV's threads sum in no fixed order, and the trials fill the cores anyway.
    with opencv_threads(1):
        return trial.key, function(trial)


@contextmanager
def opencv_threads(count: int) -> Generator[None]:
    """OpenCV works with so many threads in here."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(count)
    try:
        yield
    finally:
        cv2.setNumThreads(before)


def journal_of(rows_file: Path) -> Path:
    """The journal beside a file of rows."""
    return rows_file.with_suffix(".journal.jsonl")


def is_journal(path: Path) -> bool:
    """Whether a file begins as a study's journal does."""
    with suppress(OSError):
        return read_regular(path, len(_BEGINNING)) == _BEGINNING
    return False


def _opened(journal: Path, setup: str) -> dict[str, list[Row]]:
    """The finished trials of an earlier run of this set-up; starts a journal if there is none."""
    try:
        text = read_regular(journal).decode() if journal.exists() else ""
    except (OSError, UnicodeError) as error:
        raise StorageError(f"{journal} cannot be read ({error}); name another output.") from error
    anew = "name another output, or delete it and the rows beside it to begin anew."
    if text and not is_journal(journal):
        raise StorageError(f"{journal} is no journal of a study; {anew}")
    try:
        # Anything after the last newline was truncated.
        first, *rest = [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()] or [
            {"setup": setup}
        ]
        before = first["setup"]
        done = {line["trial"]: line["rows"] for line in rest}
    except (ValueError, TypeError, LookupError) as error:
        raise StorageError(f"{journal} is damaged; {anew}") from error
    if before != setup:
        raise VenusError(f"{journal} belongs to another run ({before}); {anew}")
    write_bytes(journal, "".join(json.dumps(line) + "\n" for line in [first, *rest]).encode())
    return done


def _append(journal: Path, line: Mapping[str, Any]) -> None:
    try:
        with journal.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
    except OSError as error:
        raise StorageError(
            f"{journal} cannot be written ({error}); what is there is kept."
        ) from error


def csv_of(table: Sequence[Row]) -> bytes:
    """Rows as CSV; a column that a row lacks is empty there."""
    columns = list(dict.fromkeys(name for row in table for name in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n", restval="")
    writer.writeheader()
    writer.writerows(table)
    return text.getvalue().encode()
