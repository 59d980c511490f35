"""Runs a guided calibration from its options: opens source and viewer, runs, closes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.diagnosis import joined
from venus3d.engine.errors import SourceError, VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.known_camera import KnownCamera
from venus3d.engine.guidance.record import Recorder, SessionState
from venus3d.engine.guidance.session import KNOWN_IS_ANOTHER, Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.sentences import after_each_other
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.guide import terminal_texts, texts
from venus3d.scene.pages.guide.headless import run_headless
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.pages.guide.result_saver import ResultSaver
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.monitor import SecondMonitor
from venus3d.scene.web.page import announce_page
from venus3d.sources.board_tracker import BoardTracker, Tracker
from venus3d.sources.camera_settings import CameraSettings
from venus3d.sources.detection_process import DetectionProcess
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Source
from venus3d.sources.interactive import open_interactive
from venus3d.sources.live import Live
from venus3d.sources.sim import Simulation
from venus3d.sources.source_news import tell_of_trouble
from venus3d.sources.watched_folder import WatchedFolder

# Recordings ignore targets: a view counts if it lowers the expected uncertainty this much.
_USEFUL_DROP = 0.1


@dataclass(frozen=True, eq=False)
class GuideResult:
    """The result of a guided calibration."""

    snapshot: Snapshot
    warnings: tuple[str, ...]
    truth: Camera | None
    """The simulated camera; None for a real one."""
    broke_off: bool = False
    """Without a viewer: whether it ended neither converged nor as it was asked to."""
    shown: tuple[int, int] | None = None
    """Of a recording without a viewer: pictures that show the board, and all."""


def run_guide(
    options: GuideOptions,
    keep: Callable[[GuideResult], str] = lambda _: "",
    *,
    monitors: Sequence[SecondMonitor] = (),
    on_open: Callable[[], None] = lambda: None,
    on_viewer: Callable[[Viewer], None] = lambda _: None,
    on_camera: Callable[[CameraSettings], None] = lambda _: None,
    recorder: Recorder | None = None,
    state: SessionState | None = None,
    known: KnownCamera | None = None,
    pictures: Iterable[tuple[int, NDArray[np.uint8]]] = (),
    verifies: bool = False,
) -> GuideResult:
    """Run one guided calibration, until it ends (headless) or is stopped (viewer).

    `keep` is called after every view, on its own thread; the newest view wins, and the last is
    always kept. What it returns is printed at the end, what it raises at once.

    Args:
        monitors: are shown what the viewer is shown; the caller closes them.
        on_open: called once the source is open and goes with the rest.
        on_viewer: called with the open viewer, to add to its page.
        on_camera: called with what is set on the camera, when that changes.
        recorder: keeps the session as it goes on.
        state: of a session to go on with, and the `pictures` of its views by their numbers.
        known: a camera to start from.
        verifies: say on the page that the views are to check a calibration.

    Raises `VenusError` for whatever the user can fix.
    """
    board = options.board.board() if state is None else state.board
    options = _possible(options)
    with ExitStack() as stack:
        source = stack.enter_context(closing(_opened(options, board)))
        tell_of_trouble(source)
        tracker = stack.enter_context(closing(_tracker(options, source, board)))
        session = _session(options, source, board, recorder, known, state)
        run = _Run(session, source, tracker, known)
        on_open()
        if options.headless:
            if isinstance(source, Live) and source.controls is not None:
                on_camera(source.controls.settings)
            return run.without_viewer(keep)
        viewer = _viewer(options, source, stack)
        for number, picture in pictures:
            viewer.keep_view(number, picture)
        announce_page(terminal_texts.VIEWER_TITLE, viewer.server, *viewer.notes)
        on_viewer(viewer)
        # What is said from here on is for the page.
        stack.enter_context(viewer.language.spoken())
        _say_first(viewer, _first_words(options, source, known, state, verifies), source)
        saver = ResultSaver(run.kept_by(keep), viewer.saved, viewer.warn)
        live = LiveGuide(
            session,
            source,
            tracker,
            viewer,
            stack.enter_context(closing(saver)).put,
            lambda: _opened(options, board),
            monitors,
            stats=options.stats,
            on_camera=on_camera,
        )
        return run.result(live.run(), viewer.notes)


@dataclass(frozen=True, eq=False)
class _Run:
    """What one guided calibration is made of, and its result."""

    session: Session
    source: Source
    tracker: Tracker
    known: KnownCamera | None

    def without_viewer(self, keep: Callable[[GuideResult], str]) -> GuideResult:
        """Guide to the end on this thread."""
        with closing(ResultSaver(self.kept_by(keep))) as saver:
            end = run_headless(self.session, self.source, self.tracker, saver.put)
            last = self.session.snapshot()
            told = end.told(last)
            return replace(self.result(last, (told,) if told else ()), broke_off=end.broke_off)

    def kept_by(self, keep: Callable[[GuideResult], str]) -> Callable[[Snapshot], str]:
        """Keeps the result as it is at a moment."""
        return lambda snapshot: keep(self.result(snapshot))

    def result(self, snapshot: Snapshot, notes: tuple[str, ...] = ()) -> GuideResult:
        """The result as if no more views came."""
        said = (*self.source.notes, *self.tracker.notes, *snapshot.warnings, *notes)
        if self.known is not None and self.session.state.known is None:
            said = (*said, KNOWN_IS_ANOTHER)
        found = (
            self.tracker.explain_misses()
            if snapshot.calibration is None
            else snapshot.final_diagnoses
        )
        final = replace(snapshot, diagnoses=joined(self.tracker.diagnoses, found))
        return GuideResult(
            final, tuple(dict.fromkeys(said)), _truth(self.source), shown=self._shown()
        )

    def _shown(self) -> tuple[int, int] | None:
        recorded = not isinstance(self.source, (Simulation, Live))
        if recorded and isinstance(self.tracker, BoardTracker):
            return self.tracker.shown, self.tracker.looked
        return None


def _truth(source: Source) -> Camera | None:
    return source.truth if isinstance(source, Simulation) else None


def _tracker(options: GuideOptions, source: Source, board: Board) -> Tracker:
    real = _truth(source) is None
    detector = Detector(board, find_layout=real)
    if options.headless:
        return BoardTracker(detector)
    return DetectionProcess(detector, source.image_size, look_beside=real)


def _session(
    options: GuideOptions,
    source: Source,
    board: Board,
    recorder: Recorder | None,
    known: KnownCamera | None,
    state: SessionState | None,
) -> Session:
    """A new session, or the one to go on with."""
    if known is not None:
        _check_known(known, source)
    session = Session(board, source.image_size, _settings(options, source), recorder, known)
    if state is not None:
        _check_size(state, source)
        session.restore(state)
    elif recorder is not None:
        recorder.changed(session.state)
    return session


def _viewer(options: GuideOptions, source: Source, stack: ExitStack) -> Viewer:
    offscreen = stack.enter_context(closing(Offscreen()))
    viewer = Viewer(
        options.host,
        options.port,
        projections=Projections(offscreen),
        draggable_board=_truth(source) is not None,
        autopilot=options.autopilot,
        tour=options.tour,
        wording=options.wording,
        language=options.language,
        explain=options.explain,
    )
    return stack.enter_context(closing(viewer))


def _say_first(viewer: Viewer, said: Sequence[str], source: Source) -> None:
    if said:
        # In the language of the first browser, which has not come yet.
        viewer.say(after_each_other(said), seconds=60)
    for warning in source.notes if isinstance(source, Live) else ():
        viewer.warn(warning, seconds=60)


def _first_words(
    options: GuideOptions,
    source: Source,
    known: KnownCamera | None,
    state: SessionState | None,
    verifies: bool,
) -> list[str]:
    """What a session is for and begins from, and how the simulated board is moved."""
    said: list[str] = [texts.VERIFYING] if verifies else []
    if known is not None:
        said.append(texts.FROM_CAMERA if known.has_uncertainty else texts.FROM_CAMERA_ALONE)
    elif options.known_camera is not None and options.resume is None and state is not None:
        said.append(texts.GOING_ON_FROM.format(count=len(state.views)))
    if _truth(source) is not None and not options.autopilot:
        said.append(texts.DRAG_HINT)
    return said


def _possible(options: GuideOptions) -> GuideOptions:
    """The options, adjusted. Raises `VenusError` for those that would never end."""
    if not options.headless:
        return options
    if not options.auto_capture:
        raise VenusError(
            "Without a viewer nobody can press the key, so --headless goes with --auto-capture."
        )
    # Nobody could drag the simulated board.
    return replace(options, autopilot=True)


def _opened(options: GuideOptions, board: Board) -> Source:
    return open_interactive(
        options.source,
        board,
        size=options.image_size,
        camera=options.sim.camera,
        settings=options.camera,
        seed=options.seed,
        headless=options.headless,
        autopilot=options.autopilot,
        speed=options.speed,
        bow=options.sim.bow_mm / 1000,
        view_errors=options.sim.view_errors,
        flip=options.flip,
    )


def _check_size(state: SessionState, source: Source) -> None:
    before, now = state.views[0].observation.image_size, source.image_size
    if before != now:
        raise SourceError(
            f"The views of this session are {before[0]} x {before[1]} px, and the source gives "
            f"{now[0]} x {now[1]}; ask for --camera-size {before[0]}x{before[1]}, or "
            "begin a new session."
        )


def _check_known(known: KnownCamera, source: Source) -> None:
    before, now = known.camera.image_size, source.image_size
    if before != now:
        raise SourceError(
            f"The camera of --from has {before[0]} x {before[1]} px, and the source gives "
            f"{now[0]} x {now[1]}; ask for --camera-size {before[0]}x{before[1]}, or convert the "
            f"file (venus3d export FILE --size {now[0]}x{now[1]})."
        )


def _settings(options: GuideOptions, source: Source) -> Settings:
    return replace(
        settings_of(options),
        useful_drop=None if source.is_live or options.source == "sim" else _USEFUL_DROP,
        still_px=float("inf") if isinstance(source, (Folder, WatchedFolder)) else 2.0,
    )


def settings_of(options: GuideOptions) -> Settings:
    """A session's settings, but for what depends on the source."""
    return Settings(
        method=options.method,
        cost=options.cost,
        strategy=options.search,
        wanted_uncertainty_px=options.wanted_error,
        limits=options.limits.chosen(),
        keep_best=options.keep_best,
        lens=options.lens,
        seed=options.seed,
        max_views=options.max_views,
        auto_capture=options.auto_capture,
        overlap_needed=options.overlap,
        rule=options.convergence,
    )
