"""The server of a trial: all tabs show the one trial at the camera."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path

import viser

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.limits import Limits
from venus3d.render.annotated_picture import LivePicture
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.exercise.exercise import Exercise
from venus3d.scene.pages.exercise.options import TrialOptions
from venus3d.scene.pages.exercise.page import Picture
from venus3d.scene.pages.exercise.server import ExerciseServer, Tab
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_page import TrialPage, layout_of, live_picture
from venus3d.scene.pages.exercise.trial_plan import Plan, plan_of, targets_of
from venus3d.scene.pages.exercise.trial_texts import DRAG_HINT, SERVING, TAB
from venus3d.scene.pages.exercise.view_model import MoveBoard, Request, TrialViewModel
from venus3d.scene.web.page import announce_page
from venus3d.scene.web.projections_panel import RemainingTiles
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Source
from venus3d.sources.interactive import open_interactive
from venus3d.sources.observation_stream import ObservationStream
from venus3d.sources.sim import Simulation
from venus3d.storage.camera_yaml import read_camera_yaml
from venus3d.storage.exercise import ExerciseFile, ExerciseRow

FILE = "trial.csv"
# Headless, the simulated hand gives up a pose after this long, seconds.
_PATIENCE_S = 120.0
_PICTURE_PERIOD_S = 1 / 15
_HINT_S = 60.0


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


class TrialServer(ExerciseServer[TrialViewModel]):
    """The trial's page in every tab."""

    _title = TAB

    def __init__(
        self,
        server: LocalServer,
        trial: Trial,
        *,
        projections: Projections | None = None,
        simulation: Simulation | None = None,
    ) -> None:
        """Accept visitors.

        Args:
            server: closed by the caller, after this.
            projections: draws the four steps as the camera sees them; the caller closes it.
            simulation: the source, if its board can be moved on the page.
        """
        super().__init__(server)
        self._trial, self._projections, self._simulation = trial, projections, simulation
        self._tiles = RemainingTiles(projections, lambda: None)  # every frame looks for them
        self._view = trial.view()
        self._image: LivePicture | None = None
        self._drawn: tuple[object, object, tuple[Picture, Picture]] | None = None
        self._picture_due_s = 0.0
        self._open()

    def show_picture(self, image: LivePicture) -> None:
        """Show this live picture (BGR or grey); from any thread, the newest wins."""
        self._image = image

    def refresh(self) -> None:
        """Show the changes in the trial."""
        self._view = self._trial.view()
        self._order_steps()
        if self._simulation is not None:
            self._simulation.follow(self._view.snapshot.target, self._view.pose)

    def obey(self) -> bool:
        """Carry out requests from any tab; whether there were any."""
        asked = [request for tab in self.tabs for request in tab.drain()]
        for request in asked:
            self._trial.handle(request)
            if self._simulation is not None:
                if isinstance(request, MoveBoard):
                    self._simulation.move_to(request.pose)
                self._simulation.autopilot_on = self._trial.autopilot
        return bool(asked)

    def step(self) -> bool:
        """Update every tab."""
        now = time.monotonic()
        if self._image is not None and now >= self._picture_due_s:
            self._picture_due_s = now + _PICTURE_PERIOD_S
            for tab in self.tabs:
                self._order_picture(tab)
        return super().step()

    def _exercise_of(self, number: int) -> Trial:
        return self._trial

    def _make_page(
        self,
        client: viser.ClientHandle,
        exercise: Exercise[TrialViewModel],
        ask: Callable[[Request], None],
    ) -> TrialPage:
        projections = self._projections
        return TrialPage(
            client,
            ask,
            self._view,
            simulated=self._simulation is not None,
            shown_steps=self._tiles.shown,
            drawn_by=lambda: "" if projections is None else projections.note,
        )

    def _next_view(self, tab: Tab[TrialViewModel]) -> TrialViewModel | None:
        return None if tab.shown is self._view else self._view

    def _order_pictures(
        self, tab: Tab[TrialViewModel], view: TrialViewModel, before: TrialViewModel | None
    ) -> None:
        if before is None:
            self._order_picture(tab)

    def _order_picture(self, tab: Tab[TrialViewModel]) -> None:
        page = tab.page
        assert isinstance(page, TrialPage)

        def draw() -> None:
            image, view = self._image, self._view
            if image is None:
                return
            # For all tabs together.
            drawn = self._drawn
            if drawn is None or drawn[0] is not image or drawn[1] is not view:
                drawn = self._drawn = (image, view, live_picture(image, view))
            page.show_picture(*drawn[2])

        self._turns.ask(tab.client.client_id, "live", draw)

    def _order_steps(self) -> None:
        """Request the pictures of the target's four steps, unless they are drawn."""
        view, target = self._view, self._view.snapshot.target
        if layout_of(view) != "steps" or target is None:
            self._tiles.forget()
        else:
            self._tiles.order(view.snapshot, dark=view.dark)


def run_trial(options: TrialOptions) -> TrialResult:
    """Run one participant's trial, until it is finished (headless) or stopped (page). Raises
    `VenusError` for whatever the user can fix."""
    options.check()
    if options.headless:
        options = replace(options, autopilot=True)  # nobody could drag the simulated board
    board = options.board.board()
    with ExitStack() as stack:
        file = stack.enter_context(closing(ExerciseFile(options.output / FILE, "trial")))
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
        if not (source.is_live or isinstance(source, Simulation)):
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
        )
        trial.autopilot = options.autopilot
        tracker = BoardTracker(Detector(board, find_layout=not isinstance(source, Simulation)))
        if options.headless:
            _run_headless(trial, source, tracker)
        else:
            _run_on_a_page(trial, source, tracker, options, stack)
        complete = trial.stage == "over"
        return TrialResult(plan, (*trial.rows,), file.path, complete, (*file.rows,))


def _run_on_a_page(
    trial: Trial, source: Source, tracker: BoardTracker, options: TrialOptions, stack: ExitStack
) -> None:
    """Run until Ctrl-C or a termination signal; the page stays open until then. Raises the source's
    error; everything measured is on disk."""
    simulation = source if isinstance(source, Simulation) else None
    offscreen = stack.enter_context(closing(Offscreen()))
    web, note = start_server(options.host, options.port)
    stack.callback(web.stop)
    server = TrialServer(web, trial, projections=Projections(offscreen), simulation=simulation)
    stack.enter_context(closing(server))
    announce_page(SERVING, web.url, note)
    if simulation is not None and not options.autopilot:
        trial.say(DRAG_HINT, _HINT_S)
    stream = ObservationStream(
        source, tracker, on_picture=lambda frame: server.show_picture(frame.image)
    )

    def step() -> None:
        observation = stream.take(timeout=0.05)
        asked = server.obey()
        if observation is not None:
            trial.observe(observation, by_machine=trial.autopilot and simulation is not None)
        if asked or observation is not None:
            server.refresh()
        server.step()

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
        snapshot = trial.snapshot()
        source.follow(snapshot.target, snapshot.pose)


def _camera(options: TrialOptions, source: Source) -> Camera:
    """The known camera. Raises `VenusError` if the source's pictures have another aspect."""
    if options.camera is None:
        assert isinstance(source, Simulation)
        return source.truth
    camera = read_camera_yaml(options.camera)
    width, height = source.image_size
    if camera.width * height != camera.height * width:
        raise VenusError(
            f"{options.camera} is for pictures of {camera.width} x {camera.height} px, but "
            f"the source gives {width} x {height} px; calibrate it at this size, or ask for the "
            "other one with --camera-size."
        )
    return camera.scaled(source.image_size)
