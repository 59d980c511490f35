"""Many frames of the simulator through the live guide: memory, threads and handles stay flat.

    python -m tests.soak --frames 100000

Calibration after calibration, each recorded in a folder, with a browser's place that reads along.
The frames come as fast as they are drawn. Prints the figures as it goes; the exit code is 1 if
something grows from the first tenth to the end.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import sys
import tempfile
import threading
import time
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from typing import NamedTuple

import psutil

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.guide.intents import Intent, PageAction
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.sim import Simulation
from venus3d.storage.session_folder import SessionFolder

_PARTS = 10


class Figures(NamedTuple):
    """What the program holds."""

    memory_mib: float
    """Memory that is free, but not given back, does not count."""
    threads: int
    handles: int
    beside_mib: float
    """Memory of the processes that it has started."""
    beside: int
    """The number of them."""


MOST_GROWTH = Figures(60, 2, 10, 60, 0)


class Counted(Simulation):
    """Counts its frames."""

    frames = 0

    def read(self) -> Frame | None:
        self.frames += 1
        return super().read()


class Again(Viewer):
    """Asks for a new calibration when one is over."""

    over = False
    sessions = 1

    def drain_intents(self) -> list[Intent]:
        asked = super().drain_intents()
        if self.over:
            self.over, self.sessions = False, self.sessions + 1
            asked.append(PageAction.NEW_SESSION)
        return asked


def figures(process: psutil.Process) -> Figures:
    gc.collect()
    if sys.platform == "linux":
        ctypes.CDLL("libc.so.6").malloc_trim(0)
    beside = process.children(recursive=True)
    return Figures(
        process.memory_info().rss / 2**20,
        process.num_threads(),
        process.num_fds(),
        sum(one.memory_info().rss for one in beside) / 2**20,
        len(beside),
    )


def soak(frames: int) -> bool:
    """Whether everything stays flat."""
    with ExitStack() as stack:
        directory = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        # Small pictures of a board with large squares take half the time of the usual ones.
        board, port = Board(5, 4, 0.05, 0.0375, "DICT_4X4_50"), free_port()
        source = Counted(PAPER_CAMERA.scaled((320, 180)), board, speed=3.0, autopilot=True)
        offscreen = stack.enter_context(closing(Offscreen()))
        viewer = stack.enter_context(
            closing(Again(port=port, projections=Projections(offscreen), autopilot=True))
        )
        folder = stack.enter_context(
            closing(SessionFolder.create(directory / "session", {"options": {}}, lambda _: None))
        )
        session = Session(board, source.image_size, Settings(max_views=8), folder)

        def keep(snapshot: Snapshot) -> None:
            viewer.over = snapshot.phase in ("converged", "finished")

        tracker = BoardTracker(Detector(board, find_layout=False))
        live = LiveGuide(session, source, tracker, viewer, keep, lambda: source)
        measured: list[Figures] = []
        ended = threading.Event()
        watcher = threading.Thread(
            target=_watch, args=(live, source, viewer, frames, measured, ended), daemon=True
        )
        reader = threading.Thread(target=_read, args=(port,), daemon=True)
        reader.start()
        watcher.start()
        try:
            live.run()
        finally:
            ended.set()
        watcher.join()
    if len(measured) <= _PARTS:
        print("Ended before all frames.")
        return False
    first, last = measured[1], measured[-1]
    grown = Figures(*(after - before for before, after in zip(first, last, strict=True)))
    print(
        f"From the first tenth to the end: {grown.memory_mib:+.1f} MiB, {grown.threads:+} threads, "
        f"{grown.handles:+} handles; the processes beside it {grown.beside_mib:+.1f} MiB."
    )
    return all(growth <= most for growth, most in zip(grown, MOST_GROWTH, strict=True))


def _read(port: int) -> None:
    with suppress(Exception), RawClient(port) as browser:
        browser.look()
        while True:
            browser.window()


def _watch(
    live: LiveGuide,
    source: Counted,
    viewer: Again,
    frames: int,
    measured: list[Figures],
    ended: threading.Event,
) -> None:
    process, began = psutil.Process(), time.monotonic()
    for part in range(_PARTS + 1):
        while source.frames < frames * part / _PARTS:
            if ended.wait(0.2):
                return
        measured.append(figures(process))
        now = measured[-1]
        print(
            f"{source.frames:7} frames, {time.monotonic() - began:5.0f} s, {viewer.sessions:3} "
            f"calibrations: {now.memory_mib:6.1f} MiB, {now.threads} threads, "
            f"{now.handles} handles, {now.beside} processes beside of {now.beside_mib:.1f} MiB",
            flush=True,
        )
    live.stop()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=100_000)
    sys.exit(0 if soak(parser.parse_args().frames) else 1)


if __name__ == "__main__":
    main()
