"""The guidance loop: newest frame in, snapshot out.

`run_guide` drives one session from a source. Headless, everything happens in order on one thread,
so that a seed repeats a run. With the viewer, four threads hand things on through one-slot boxes
in which the newest wins:

    watch   source -> frame box, and the picture to the viewer at once
    look    frame box -> detection -> observation box
    think   the session's slow work: calibration and search
    guide   (the caller's thread) observation box and what users asked for -> session -> viewer

The picture never waits for detection, detection never for the mathematics.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import closing
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from venus3d.engine.camera import Camera
from venus3d.engine.detection import Detector, search_region
from venus3d.engine.errors import CalibrationError, SourceError
from venus3d.engine.observation import Observation
from venus3d.engine.session import Session
from venus3d.engine.snapshot import Snapshot
from venus3d.engine.work import Outcome, Work
from venus3d.scene import intents
from venus3d.scene.viewer import Viewer
from venus3d.sources.frame import Frame, Source
from venus3d.sources.latest import Latest
from venus3d.sources.sim import Simulation


PAPER_CAMERA = Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
"""The simulated camera of the paper (4.1.2), its five distortion numbers in OpenCV's order."""

# A recording does not follow a target: a view with this share of the target's gain counts as well.
_EQUIVALENT_GAIN = 0.7
# Headless, the simulated hand is looked at this often; a person's viewer gets every frame.
_HEADLESS_FPS, _LIVE_FPS = 5.0, 25.0


@dataclass(frozen=True, eq=False)
class GuideResult:
    """What a guided calibration came to."""

    snapshot: Snapshot
    warnings: tuple[str, ...]
    truth: Camera | None
    """The simulated camera; None for a real one."""


def run_guide(
    options: GuideOptions, on_result: Callable[[GuideResult], None] | None = None
) -> GuideResult:
    """Guide one calibration as the options say, until it ends (headless) or is stopped (viewer).

    `on_result` is called whenever a result is complete, while the viewer stays open. Raises
    `VenusError` for whatever the user can mend.
    """
    board = options.board.board()
    source = _opened(options, board)
    truth = source.truth if isinstance(source, Simulation) else None
    try:
        detector = Detector(board, find_layout=truth is None)
        session = Session(board, source.image_size, _settings(options, board, source))
        eyes = Eyes(detector)

        def result(snapshot: Snapshot, *more: str) -> GuideResult:
            notes = (*source.notes, *detector.notes, *snapshot.warnings, *more)
            return GuideResult(snapshot, tuple(dict.fromkeys(notes)), truth)

        if options.headless:
            return result(run_headless(session, source, eyes))
        with closing(Projections(Offscreen())) as projections, closing(
            Viewer(
                options.host,
                options.port,
                projections=projections,
                draggable_board=truth is not None,
                autopilot=options.autopilot,
            )
        ) as viewer:
            for note in viewer.notes:
                print(note, flush=True)
            print(f"Viewer: {viewer.url}   (Ctrl-C ends it)", flush=True)

            def hand_on(snapshot: Snapshot) -> None:
                if on_result is not None:
                    on_result(result(snapshot))

            return result(LiveGuide(session, source, eyes, viewer, hand_on).run(), *viewer.notes)
    finally:
        source.close()


def _opened(options: GuideOptions, board: Board) -> Source:
    if options.source != "sim":
        return open_source(
            options.source, size=options.image_size, realtime=not options.headless
        )
    camera = PAPER_CAMERA
    if options.image_size is not None:
        camera = camera.scaled(options.image_size)
    return Simulation(
        camera,
        board,
        seed=options.seed,
        fps=_HEADLESS_FPS if options.headless else _LIVE_FPS,
        realtime=not options.headless,
        autopilot=options.autopilot,
        speed=options.speed * (_LIVE_FPS / _HEADLESS_FPS / 2 if options.headless else 1),
    )


def _settings(options: GuideOptions, board: Board, source: Source) -> Settings:
    is_recording = not source.is_live
    return Settings(
        method=options.method,
        cost=options.cost,
        limits=options.limits.limits(board, Camera.guess(source.image_size)),
        seed=options.seed,
        max_views=options.max_views,
        auto_capture=options.auto_capture,
        equivalent_gain=_EQUIVALENT_GAIN if is_recording else None,
        overlap_needed=options.overlap,
        still_px=float("inf") if isinstance(source, Folder) else 2.0,
        rule=options.convergence,
    )


class Eyes:
    """Frames to observations: the detector with its memory of where the board was."""

    def __init__(self, detector: Detector) -> None:
        self.detector = detector
        self._last: Observation | None = None

    def look(self, frame: Frame) -> Observation:
        """The board in this frame; searched near its last place first, then everywhere."""
        region = None
        if self._last is not None and self.detector.settled:
            region = search_region(self._last, frame.image_size)
        seen = self._detect(frame, region)
        if region is not None and seen.count < 0.9 * (self._last.count if self._last else 0):
            seen = self._detect(frame, None)
        self._last = seen if seen.count else None
        return seen

    def _detect(self, frame: Frame, region: tuple[int, int, int, int] | None) -> Observation:
        return self.detector.detect(
            frame.image, region=region, time_s=frame.time_s, name=frame.name
        )


def run_headless(session: Session, source: Source, eyes: Eyes) -> Snapshot:
    """Guide without a screen until convergence, enough views, or the recording's end."""
    snapshot = session.snapshot()
    while snapshot.phase not in ("converged", "finished"):
        frame = source.read()
        if frame is None:
            break
        observation = eyes.look(frame)
        session.use_board(eyes.detector.board)
        snapshot = session.observe(observation)
        while session.pending is not None:
            work = session.pending
            try:
                snapshot = session.apply(work.run())
            except CalibrationError as error:
                snapshot = session.fail(work, error)
        if isinstance(source, Simulation):
            source.follow(snapshot.target)
    return snapshot


class LiveGuide:
    """One session with its viewer. `run` returns when `stop` was called or the source broke."""

    def __init__(
        self,
        session: Session,
        source: Source,
        eyes: Eyes,
        viewer: Viewer,
        on_result: Callable[[Snapshot], None],
    ) -> None:
        self._session, self._source, self._eyes, self._viewer = session, source, eyes, viewer
        self._on_result = on_result
        self._frames: Latest[Frame] = Latest()
        self._observations: Latest[Observation] = Latest()
        self._stop = threading.Event()
        self._running = threading.Event()  # cleared while paused
        self._running.set()
        self._failure: BaseException | None = None
        self._thinker = ThreadPoolExecutor(1, thread_name_prefix="think")
        self._job: tuple[Work, Future[Outcome], threading.Event] | None = None
        self._settled_at: tuple[str, int] = ("", 0)

    def stop(self) -> None:
        """Ask `run` to return; from any thread."""
        self._stop.set()

    def run(self) -> Snapshot:
        """Guide until stopped; raises what broke the source, after the result was handed on."""
        threads = [
            threading.Thread(target=self._guarded, args=(step,), name=name, daemon=True)
            for name, step in (("watch", self._watch), ("look", self._look))
        ]
        for thread in threads:
            thread.start()
        try:
            while not self._stop.is_set():
                self._guide()
        except KeyboardInterrupt:
            pass
        finally:
            self._stop.set()
            self._running.set()
            self._frames.close()
            self._observations.close()
            self._thinker.shutdown(wait=True, cancel_futures=True)
            for thread in threads:
                thread.join(timeout=2)
        if self._failure is not None:
            raise self._failure
        return self._session.snapshot()

    # -- threads ---------------------------------------------------------------------------------

    def _guarded(self, step: Callable[[], None]) -> None:
        try:
            while not self._stop.is_set():
                step()
        except BaseException as error:  # handed to the thread that called run()
            self._failure = error
            self._stop.set()

    def _watch(self) -> None:
        self._running.wait()
        frame = self._source.read()
        if frame is None:
            self._viewer.say("The recording has ended. Press Finish, or stop the program.")
            self._stop.wait()
            return
        self._viewer.show_picture(frame.image)
        self._frames.put(frame)

    def _look(self) -> None:
        frame = self._frames.take(timeout=0.2)
        if frame is not None:
            self._observations.put(self._eyes.look(frame))

    # -- the guiding thread ----------------------------------------------------------------------

    def _guide(self) -> None:
        session = self._session
        observation = self._observations.take(timeout=0.05)
        for intent in self._viewer.drain_intents():
            self._obey(intent)
        if observation is not None:
            session.use_board(self._eyes.detector.board)
            session.observe(observation)
        self._think()
        snapshot = session.snapshot()
        if isinstance(self._source, Simulation):
            self._source.follow(snapshot.target)
        self._viewer.show(snapshot)
        state = (snapshot.phase, len(snapshot.views))
        if state != self._settled_at and snapshot.phase in ("converged", "finished"):
            self._on_result(snapshot)
        self._settled_at = state

    def _think(self) -> None:
        pending = self._session.pending
        if self._job is not None:
            work, future, halt = self._job
            if work is not pending:
                halt.set()
            if not future.done():
                return
            self._job = None
            try:
                self._session.apply(future.result())
            except CalibrationError as error:
                self._session.fail(work, error)
            pending = self._session.pending
        if pending is not None:
            halt = threading.Event()
            self._job = (pending, self._thinker.submit(pending.run, halt.is_set), halt)

    def _obey(self, intent: intents.Intent) -> None:
        session, source = self._session, self._source
        match intent:
            case intents.Capture():
                if not session.capture():
                    self._viewer.say("Nothing to capture yet: the board must be seen and tilted.")
            case intents.SkipTarget():
                session.skip()
            case intents.UndoView():
                session.undo()
            case intents.DropView(number):
                session.drop(number)
            case intents.Finish():
                session.finish()
            case intents.Pause(on):
                (self._running.clear if on else self._running.set)()
            case intents.DragBoard(pose) if isinstance(source, Simulation):
                source.move_to(pose)
            case intents.Autopilot(on) if isinstance(source, Simulation):
                source.autopilot_on = on
            case _:
                pass
