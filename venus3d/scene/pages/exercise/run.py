"""Practice and trial from options to the end.

Practice: every tab is a trainee with their own board, scene and panels; only the file and the
server are shared. Trial: all tabs show the one trial at the camera.
"""

from __future__ import annotations

import sys
import traceback
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.errors import StorageError, VenusError
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.limits import Limits
from venus3d.engine.printable import printable
from venus3d.languages import translated_error
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.options import PracticeOptions, TrialOptions
from venus3d.scene.pages.exercise.practice import Practice, PracticeSettings
from venus3d.scene.pages.exercise.practice_page import PracticePage
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_page import TrialPage
from venus3d.scene.pages.exercise.trial_pictures import TrialPictures
from venus3d.scene.pages.exercise.trial_plan import Plan, plan_of, targets_of
from venus3d.scene.web.page import announce_page
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.scene.web.tabs import TabServer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Source
from venus3d.sources.interactive import open_interactive
from venus3d.sources.observation_stream import ObservationStream
from venus3d.sources.sim import Simulation
from venus3d.sources.source_news import tell_of_trouble
from venus3d.storage.exercise import ExerciseFile, ExerciseRow
from venus3d.storage.formats import camera_in
from venus3d.threads.latency import low_latency

PRACTICE_FILE, TRIAL_FILE = "practice.csv", "trial.csv"
# Headless, the simulated hand gives up a pose after this long, seconds.
_PATIENCE_S = 120.0
_HINT_S = 60.0


def run_practice(options: PracticeOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can fix,
    `KeyboardInterrupt` if nothing was written."""
    options.check()
    camera = PAPER_CAMERA if options.camera is None else camera_in(options.camera).camera
    path = options.output / PRACTICE_FILE
    settings = PracticeSettings.of(camera, options.board.board(), options.seed, str(path))
    with ExitStack() as stack:
        file = stack.enter_context(closing(ExerciseFile(path, "practice")))
        before = len(file.rows)
        offscreen = stack.enter_context(closing(Offscreen()))
        server, note = start_server(
            options.host, options.port, options.language, asks_token=options.token
        )
        stack.callback(server.stop)
        practice = stack.enter_context(closing(PracticeServer(server, settings, file, offscreen)))
        announce_page(say.PRACTICE, server, note, offscreen.note)
        with suppress(KeyboardInterrupt), low_latency():
            practice.run()
    if len(file.rows) == before:
        raise KeyboardInterrupt
    print(printable(say.WRITTEN.format(path=path)))


class PracticeServer(TabServer[Practice]):
    """All trainees of one server, and the file of their times."""

    def __init__(
        self,
        server: LocalServer,
        settings: PracticeSettings,
        file: ExerciseFile,
        offscreen: Offscreen,
    ) -> None:
        """Accept trainees. The caller closes server, file and renderer afterwards."""
        self._file = file
        # So that a slow disk blocks nobody.
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="rows")
        super().__init__(
            server,
            say.PRACTICE,
            lambda number: Practice(settings, number + 1, self._write, file.rows),
            partial(PracticePage, reach=settings.reach, offscreen=offscreen),
        )

    def close(self) -> None:
        """Disconnect everybody and finish writing. May be called twice."""
        self._stop.set()
        self._wake.set()
        self._writer.shutdown(wait=True)
        super().close()

    def _write(self, row: ExerciseRow) -> None:
        self._writer.submit(self._file.append, row).add_done_callback(self._written)

    def _written(self, future: Future[None]) -> None:
        error = future.exception()
        if isinstance(error, StorageError):
            print(printable(f"venus3d: {error}"), file=sys.stderr, flush=True)
            for tab in self.tabs:
                with tab.language.spoken():
                    tab.page.warn(translated_error(error))
        elif error is not None:
            traceback.print_exception(error, file=sys.stderr)


@dataclass(frozen=True)
class TrialResult:
    """The result of one participant's trial."""

    plan: Plan
    run: tuple[ExerciseRow, ...]
    """Rows of this run."""
    path: Path
    complete: bool
    rows: tuple[ExerciseRow, ...]
    """All rows of the file, including other participants'."""


def run_trial(options: TrialOptions) -> TrialResult:
    """Run one participant's trial, until it is finished (headless) or stopped (page). Raises
    `VenusError` for whatever the user can fix."""
    options.check()
    if options.headless:
        options = replace(options, autopilot=True)  # nobody could drag the simulated board
    board = options.board.board()
    with ExitStack() as stack:
        file = stack.enter_context(closing(ExerciseFile(options.output / TRIAL_FILE, "trial")))
        plan = plan_of(options.participant, file.rows)
        source = open_interactive(
            options.source,
            board,
            size=options.image_size,
            seed=options.seed,
            headless=options.headless,
            autopilot=options.autopilot,
            speed=options.speed,
        )
        stack.enter_context(closing(source))
        tell_of_trouble(source)
        simulation = source if isinstance(source, Simulation) else None
        if simulation is None and not source.is_live:
            raise VenusError(
                f"Nobody can move the board in the recording {options.source}; name a camera, a "
                "stream, or sim."
            )
        camera = _camera(options, source)
        limits = replace(Limits.for_board(board, camera), **options.limits.chosen())
        trial = Trial(
            board,
            camera,
            plan,
            targets_of(options.seed, camera, board, limits, options.poses),
            file.append,
            settings=Settings(overlap_needed=options.overlap),
            written=str(file.path),
            source=options.source,
            seed=options.seed,
            move_board=lambda pose: None if simulation is None else simulation.move_to(pose),
        )
        trial.autopilot = options.autopilot
        tracker = BoardTracker(Detector(board, find_layout=simulation is None))
        if options.headless:
            _run_headless(trial, source, tracker)
        else:
            _run_on_a_page(trial, source, tracker, options, stack)
        complete = trial.stage == "over"
        return TrialResult(plan, (*trial.rows,), file.path, complete, (*file.rows,))


def trial_server(
    server: LocalServer, trial: Trial, pictures: TrialPictures, *, simulated: bool = False
) -> TabServer[Trial]:
    """Accept visitors of this trial; the caller closes the server afterwards."""
    trial.view()
    make_page = partial(TrialPage, pictures=pictures, simulated=simulated)
    return TabServer(server, say.TRIAL, lambda _: trial, make_page)


def _run_on_a_page(
    trial: Trial, source: Source, tracker: BoardTracker, options: TrialOptions, stack: ExitStack
) -> None:
    """Run until Ctrl-C or a termination signal; the page stays open until then. Raises the source's
    error; everything measured is on disk."""
    offscreen = stack.enter_context(closing(Offscreen()))
    web, note = start_server(options.host, options.port, options.language)
    stack.callback(web.stop)
    pictures = TrialPictures(Projections(offscreen))
    simulation = source if isinstance(source, Simulation) else None
    server = trial_server(web, trial, pictures, simulated=simulation is not None)
    stack.enter_context(closing(server))
    announce_page(say.TRIAL, web, note)
    if simulation is not None and not options.autopilot:
        trial.say(say.DRAG_HINT, _HINT_S)
    stream = ObservationStream(source, tracker, on_picture=lambda frame: pictures.put(frame.image))

    def step() -> None:
        observation = stream.take(timeout=0.05)
        if observation is not None:
            trial.observe(observation, by_machine=trial.autopilot and simulation is not None)
        server.step()
        if simulation is not None:
            seen = trial.view().snapshot
            simulation.autopilot_on = trial.autopilot
            simulation.follow(seen.target, seen.pose)

    stream.run(step)
    stream.check()


def _run_headless(trial: Trial, source: Source, tracker: BoardTracker) -> None:
    """A rehearsal: the simulated hand does everything, in simulated time."""
    assert isinstance(source, Simulation)
    since_s, done = 0.0, 0
    while trial.stage != "over":
        frame = source.read()
        if frame is None:
            return
        trial.observe(tracker.track(frame), by_machine=True)
        if trial.stage == "ready":
            trial.begin()
        if len(trial.rows) != done:
            since_s, done = frame.time_s, len(trial.rows)
        if frame.time_s - since_s > _PATIENCE_S:
            trial.give_up()
        seen = trial.view().snapshot
        source.follow(seen.target, seen.pose)


def _camera(options: TrialOptions, source: Source) -> Camera:
    """The known camera. Raises `VenusError` if the source's pictures have another aspect."""
    if options.camera is None:
        assert isinstance(source, Simulation)
        return source.truth
    camera = camera_in(options.camera).camera
    width, height = source.image_size
    if camera.width * height != camera.height * width:
        raise VenusError(
            f"{options.camera} is for pictures of {camera.width} x {camera.height} px, but "
            f"the source gives {width} x {height} px; calibrate it at this size, or ask for the "
            "other one with --camera-size."
        )
    return camera.scaled(source.image_size)
