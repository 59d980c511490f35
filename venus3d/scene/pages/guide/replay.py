"""The guide's page fed by a recorded session: moments in the place of frames, read-only."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from contextlib import ExitStack, closing
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.guidance.replay import Replay
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import Language
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.guide import terminal_texts
from venus3d.scene.pages.guide.replay_bar import ReplayBar, moment_at
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.help import Command
from venus3d.scene.web.page import announce_page
from venus3d.scene.web.server import LocalServer
from venus3d.storage.session_moments import Moment

_PERIOD_S = 0.05


def picture_of(moment: Moment) -> NDArray[np.uint8] | None:
    """The picture (BGR) of the view seen at a moment; None if it was not kept."""
    if moment.picture is None:
        return None
    picture = cv2.imread(str(moment.picture), cv2.IMREAD_COLOR)
    return None if picture is None else np.asarray(picture, dtype=np.uint8)


class Worker:
    """Works the snapshots of all moments out, one after the other, on a thread."""

    def __init__(self, moments: Sequence[Moment], settings: Settings) -> None:
        """Begin."""
        self._moments, self._replay = tuple(moments), Replay(settings)
        self.snapshots: list[Snapshot] = []
        """Those that are there already, in order; grows."""
        self.error: Exception | None = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._work, name="replay", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End after the moment at work."""
        self._stop.set()
        self._thread.join()

    def finish(self) -> tuple[Snapshot, ...]:
        """All of them, once they are there. Raises what went wrong."""
        self._thread.join()
        if self.error is not None:
            raise self.error
        return tuple(self.snapshots)

    def _work(self) -> None:
        try:
            for moment in self._moments:
                if self._stop.is_set():
                    return
                self.snapshots.append(self._replay.snapshot(moment.state, moment.seen))
        except Exception as error:  # told by whoever waits
            self.error = error


def run_replay(
    moments: Sequence[Moment],
    settings: Settings,
    *,
    host: str = "127.0.0.1",
    port: int = 8080,
    language: Language | None = None,
) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can fix."""
    with ExitStack() as stack:
        worker = stack.enter_context(closing(Worker(moments, settings)))
        offscreen = stack.enter_context(closing(Offscreen()))
        viewer = stack.enter_context(
            closing(
                Viewer(
                    host,
                    port,
                    projections=Projections(offscreen),
                    language=language,
                    recorded=True,
                )
            )
        )
        bar = ReplayBar(moments)

        def lay_out(server: LocalServer) -> Sequence[Command]:
            return bar.lay_out(server, viewer.view.left_panel)

        viewer.extend(lay_out)
        kept: set[Path] = set()
        for moment in moments:
            if moment.picture is not None and moment.picture not in kept:
                kept.add(moment.picture)
                picture = picture_of(moment)
                if picture is not None:
                    viewer.keep_view(moment.number, picture)
        announce_page(terminal_texts.REPLAY_TITLE, viewer.server, *viewer.notes)
        stack.enter_context(viewer.language.spoken())
        _play(viewer, bar, worker, moments)


def _play(viewer: Viewer, bar: ReplayBar, worker: Worker, moments: Sequence[Moment]) -> None:
    shown, before = -1, time.monotonic()
    while True:
        viewer.wait(_PERIOD_S)
        viewer.drain_intents()  # they change what is seen, and nothing else
        now = time.monotonic()
        bar.advance(now - before)
        before, done = now, len(worker.snapshots)
        if worker.error is not None:
            raise worker.error
        if not done:
            continue
        index = min(moment_at(moments, bar.place.time_s), done - 1)
        if index != shown:
            shown = index
            viewer.show(worker.snapshots[index])
            picture = picture_of(moments[index])
            if picture is not None:
                viewer.show_picture(picture, moments[index].seen)
        bar.show(moments[index], done)
