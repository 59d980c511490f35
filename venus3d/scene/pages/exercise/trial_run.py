"""`venus3d guide --trial`: opens the rooms for a trial, runs it, closes them."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.work import Settings
from venus3d.engine.planning.limits import Limits
from venus3d.scene.pages.exercise.trial_plan import Plan, plan_of, targets_of
from venus3d.scene.pages.exercise.trial_session import PoseTime, TrialSession
from venus3d.scene.pages.exercise.trial_view import TrialViewer
from venus3d.scene.pages.exercise.trial_view_model import HelpTimes
from venus3d.scene.pages.guide import intents
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.render.offscreen import Offscreen
from venus3d.scene.render.projections import Projections
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Source
from venus3d.sources.observation_stream import ObservationStream
from venus3d.sources.sim import Simulation
from venus3d.storage.camera_yaml import read_camera_yaml
from venus3d.storage.rows import target_columns, time_column
from venus3d.storage.trials import TrialFile, TrialRow

FILE = "trial.csv"
# Headless, the simulated hand is given up on after this long with a pose, seconds.
_PATIENCE_S = 120.0


@dataclass(frozen=True)
class TrialResult:
    """What one participant's trial came to."""

    plan: Plan
    times: tuple[HelpTimes, ...]
    path: Path
    complete: bool
    rows: tuple[TrialRow, ...]
    """Everything in the file, other participants' included."""


class TrialGuide:
    """One trial with its viewer. `run` returns when `stop` was called or the source broke."""

    def __init__(
        self, session: TrialSession, source: Source, tracker: BoardTracker, viewer: TrialViewer
    ) -> None:
        """`source` is closed by `run`."""
        self._session, self._viewer = session, viewer
        self._stream = ObservationStream(
            source, tracker, on_picture=lambda frame: viewer.show_picture(frame.image)
        )

    def stop(self) -> None:
        """Ask for the end; from any thread."""
        self._stream.stop()

    def run(self) -> None:
        """Run until stopped, by `stop`, Ctrl-C or a signal that asks to end; until then the page
        stays.

        Raises what broke the source; what was measured is on the disk.
        """
        self._stream.run(self._guide)
        self._stream.check()

    def _guide(self) -> None:
        session, source = self._session, self._stream.source
        observation = self._stream.take(timeout=0.05)
        asked = self._viewer.drain_intents()
        for intent in asked:
            self._obey(intent)
        if observation is not None:
            by_machine = isinstance(source, Simulation) and source.autopilot_on
            session.observe(observation, by_machine=by_machine)
        if not asked and observation is None:
            return
        snapshot = session.snapshot()
        if isinstance(source, Simulation):
            source.follow(snapshot.target, snapshot.pose)
        self._viewer.show(snapshot)

    def _obey(self, intent: intents.Intent) -> None:
        source = self._stream.source
        match intent:
            case intents.Begin():
                self._session.begin()
            case intents.SkipTarget():
                self._session.give_up()
            case intents.DragBoard(pose) if isinstance(source, Simulation):
                source.autopilot_on = False
                source.move_to(pose)
            case intents.Toggle("autopilot") if isinstance(source, Simulation):
                source.autopilot_on = self._viewer.state.autopilot
            case _:
                pass


def run_trial(
    options: GuideOptions, open_source: Callable[[], Source], folder: Path
) -> TrialResult:
    """Run one participant's trial, until all is done (headless) or it is stopped (viewer).

    Args:
        options: as checked.
        open_source: opens `options.source`.
        folder: where the file of times is, or will be.

    Raises `VenusError` for whatever the user can mend.
    """
    board = options.board.board()
    with ExitStack() as rooms:
        file = rooms.enter_context(closing(TrialFile(folder / FILE)))
        plan = plan_of(options.participant, file.rows)
        source = rooms.enter_context(closing(open_source()))
        if not (source.is_live or isinstance(source, Simulation)):
            raise VenusError(
                f"Nobody can move the board in the recording {options.source}; name a camera, a "
                "stream, or sim."
            )
        camera = _camera(options, source)
        limits = replace(Limits.for_board(board, camera), **options.limits.chosen())
        targets = targets_of(options.seed, camera, board, limits, options.trial_poses)

        def record(told: PoseTime) -> None:
            file.append(_row(told, plan, options))

        settings = Settings(overlap_needed=options.overlap)
        session = TrialSession(
            board, camera, plan, targets, record, settings=settings, written=str(file.path)
        )
        tracker = BoardTracker(Detector(board, find_layout=not isinstance(source, Simulation)))
        if options.headless:
            _run_headless(session, source, tracker)
        else:
            _run_on_a_page(session, source, tracker, options, rooms)
        return TrialResult(plan, session.times, file.path, session.stage == "over", (*file.rows,))


def _run_on_a_page(
    session: TrialSession,
    source: Source,
    tracker: BoardTracker,
    options: GuideOptions,
    rooms: ExitStack,
) -> None:
    offscreen = rooms.enter_context(closing(Offscreen()))
    viewer = TrialViewer(
        options.host,
        options.port,
        projections=Projections(offscreen),
        draggable_board=isinstance(source, Simulation),
        autopilot=options.autopilot,
    )
    rooms.enter_context(closing(viewer))
    for note in viewer.notes:
        print(note, flush=True)
    print(f"Viewer: {viewer.url}   (Ctrl-C ends it)", flush=True)
    if isinstance(source, Simulation) and not options.autopilot:
        hint = "Drag the board by its handles in the scene, or press O for the simulated hand."
        viewer.say(hint, seconds=60)
    TrialGuide(session, source, tracker, viewer).run()


def _run_headless(session: TrialSession, source: Source, tracker: BoardTracker) -> None:
    """The simulated hand does everything, in simulated time: a rehearsal."""
    assert isinstance(source, Simulation)
    since, done = 0.0, 0
    while session.stage != "over":
        frame = source.read()
        if frame is None:
            return
        session.observe(tracker.track(frame), by_machine=True)
        session.begin()
        count = sum(len(times.ends_s) for times in session.times)
        since, done = (frame.time_s, count) if count != done else (since, done)
        if frame.time_s - since > _PATIENCE_S:
            session.give_up()
        snapshot = session.snapshot()
        source.follow(snapshot.target, snapshot.pose)


def _camera(options: GuideOptions, source: Source) -> Camera:
    """The camera that is known. Raises `VenusError` if its pictures have another shape."""
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


def _row(told: PoseTime, plan: Plan, options: GuideOptions) -> TrialRow:
    return TrialRow(
        participant=plan.participant,
        number=plan.number,
        order=" ".join(plan.order),
        attempt=told.attempt,
        place=told.place,
        help=told.help,
        pose=told.pose,
        outcome=told.outcome,
        seconds=told.seconds,
        since_first_s=told.since_first_s,
        since_start_s=told.since_start_s,
        overlap=told.overlap,
        off_mm=told.off_mm,
        off_deg=told.off_deg,
        source=options.source,
        hand="autopilot" if told.by_machine else "person",
        seed=options.seed,
        poses=options.trial_poses,
        time=time_column(),
        **target_columns(told.target),
    )
