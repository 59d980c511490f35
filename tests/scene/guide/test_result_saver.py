"""Nobody waits for the disk, the newest wins, and nothing pending is left behind."""

from __future__ import annotations

import threading
import time
from dataclasses import replace

import pytest

from tests.waiting import wait_until
from venus3d.engine.errors import StorageError
from venus3d.engine.guidance.prompts import Phase
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.result_saver import ResultSaver


def anew(snapshot: Snapshot, phase: Phase = "guiding") -> Snapshot:
    """The same after another calibration."""
    assert snapshot.calibration is not None
    return replace(snapshot, calibration=replace(snapshot.calibration), phase=phase)


class Disk:
    """Takes what is written, as slowly as it is told to."""

    def __init__(self) -> None:
        self.written: list[Snapshot] = []
        self.threads: set[str] = set()
        self.free = threading.Event()
        self.free.set()
        self.error: Exception | None = None

    def write(self, snapshot: Snapshot) -> str:
        self.threads.add(threading.current_thread().name)
        assert self.free.wait(30)
        if self.error is not None:
            raise self.error
        self.written.append(snapshot)
        return f"{len(self.written)} written"

    def wait_for(self, count: int) -> None:
        wait_until(lambda: len(self.written) >= count)


def test_every_calibration_is_written_once(guided: Snapshot) -> None:
    disk = Disk()
    keeper = ResultSaver(disk.write)
    views = [anew(guided) for _ in range(3)]
    for count, view in enumerate(views, start=1):
        for _ in range(5):  # a frame each
            keeper.put(replace(view, number=count))
        disk.wait_for(count)
    keeper.put(replace(views[-1], calibration=None))  # all views were taken back
    keeper.close()
    assert [w.calibration for w in disk.written] == [v.calibration for v in views]
    assert disk.threads == {"keep"}


def test_nobody_waits_for_a_slow_disk_and_the_newest_wins(guided: Snapshot) -> None:
    disk = Disk()
    disk.free.clear()
    keeper = ResultSaver(disk.write)
    views = [anew(guided) for _ in range(6)]
    keeper.put(views[0])
    wait_until(lambda: disk.threads)
    started = time.perf_counter()
    for view in views[1:]:
        keeper.put(view)
    assert time.perf_counter() - started < 2 and not disk.written
    disk.free.set()
    keeper.close()
    assert disk.written == [views[0], views[-1]]
    keeper.put(anew(guided))  # too late
    keeper.close()


def test_the_place_is_said_when_it_is_over(guided: Snapshot) -> None:
    disk, said = Disk(), list[str]()
    keeper = ResultSaver(disk.write, said.append)
    view = anew(guided)
    keeper.put(view)
    disk.wait_for(1)
    assert not said
    keeper.put(replace(view, phase="finished"))  # by the user, without another view
    disk.wait_for(2)
    keeper.put(replace(view, phase="finished", number=9))
    keeper.put(anew(guided))  # one more view after all
    disk.wait_for(3)
    keeper.put(anew(guided, "converged"))
    keeper.close()
    assert said == ["2 written", "4 written"]


@pytest.mark.parametrize("error", [StorageError("The disk is full."), ValueError("Odd.")])
def test_what_fails_is_told_and_the_next_view_is_tried(
    guided: Snapshot, error: Exception, caplog: pytest.LogCaptureFixture
) -> None:
    disk, told = Disk(), list[str]()
    disk.error = error
    keeper = ResultSaver(disk.write, failed=told.append)
    keeper.put(anew(guided))
    wait_until(lambda: told)
    why = ": The disk is full." if isinstance(error, StorageError) else "; the terminal says why."
    again = "It is tried again every two seconds."
    again = again if isinstance(error, StorageError) else "The next view is tried again."
    assert told == [f"Not saved{why} {again}"]
    assert ("Odd." in caplog.text) == isinstance(error, ValueError)  # a mistake of ours, in full
    disk.error = None
    keeper.put(last := anew(guided))
    keeper.close()
    assert disk.written == [last] and len(told) == 1


def test_the_last_view_is_tried_again_until_the_disk_has_room(guided: Snapshot) -> None:
    """No next view comes after the end; the failure is told once."""
    disk, said, told = Disk(), list[str](), list[str]()
    disk.error = StorageError("The disk is full.")
    keeper = ResultSaver(disk.write, said.append, told.append)
    keeper.put(last := anew(guided, "converged"))
    wait_until(lambda: told)
    disk.error = None
    wait_until(lambda: said)
    assert disk.written == [last] and len(told) == 1
    keeper.close()


def test_where_nothing_was_captured_there_is_no_thread() -> None:
    before = threading.active_count()
    keeper = ResultSaver(Disk().write)
    assert threading.active_count() == before
    keeper.close()
