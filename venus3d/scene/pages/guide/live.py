"""Guiding with the viewer: observations and intents go to the session, snapshots to the viewer.

The caller's thread does that. Two more read frames and detect boards
(`sources.observation_stream`); calibration and search run in a process of their own
(`threads.work_process`), so that nothing that moves waits for them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from datetime import datetime, timedelta

from venus3d.engine.errors import VenusError
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.guidance.work import Outcome
from venus3d.languages import translated_error
from venus3d.scene.pages.guide import intents, texts
from venus3d.scene.pages.guide.flow_news import FlowNews
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.board_keys import KeyMoves
from venus3d.scene.web.monitor import SecondMonitor
from venus3d.sources.board_tracker import Tracker
from venus3d.sources.camera_settings import CameraSetting, CameraSettings, SettingName
from venus3d.sources.frame import Frame, Source
from venus3d.sources.live import Live, OtherSize, Trouble
from venus3d.sources.observation_stream import ObservationStream
from venus3d.sources.reconnection import Outage
from venus3d.sources.sim import Simulation
from venus3d.sources.watched_folder import WatchedFolder
from venus3d.threads.flow import Flow
from venus3d.threads.work_process import WorkProcess

_SILENT_S = 2.0
"""Seconds without a picture after which that is said; a folder shows each for one second."""
_DRAWN_S = 0.5
"""Time for the last words to reach the browsers."""


class LiveGuide:
    """One session with its viewer. `run` returns after `stop` or a failure of the source."""

    def __init__(
        self,
        session: Session,
        source: Source,
        tracker: Tracker,
        viewer: Viewer,
        keep: Callable[[Snapshot], None],
        again: Callable[[], Source],
        monitors: Sequence[SecondMonitor] = (),
        *,
        stats: bool = False,
        on_camera: Callable[[CameraSettings], None] = lambda _: None,
    ) -> None:
        """`keep` is called with every moment that may hold a new result, and must not block;
        `again` reopens a recording that has ended; `run` closes `source`. `stats`: tell how the
        pictures flow; `on_camera` is called with what is set on the camera, when that changes."""
        self._session, self._keep = session, keep
        self._viewer, self._monitors = viewer, tuple(monitors)
        self._flow = Flow()
        self._stream = ObservationStream(
            source,
            tracker,
            on_picture=self._show_picture,
            reopen=again,
            flow=self._flow,
        )
        self._stats = FlowNews(self._flow, viewer) if stats else None
        self._silent_since = self._said = ""
        self._remarks = 0
        self._by_keys = KeyMoves()
        self._on_camera, self._camera = on_camera, CameraSettings()
        self._thinking = WorkProcess(session.note_calibrated)

    def stop(self) -> None:
        """Ask `run` to end; from any thread."""
        self._stream.stop()

    def run(self) -> Snapshot:
        """Guide until `stop`, Ctrl-C or a termination signal. Raises the source's or any other
        error, after all captured views were passed on."""
        try:
            self._stream.run(self._guide, self._end)
        except BaseException:
            with suppress(Exception):  # the first error is the one to report
                self._concluded()
            raise
        snapshot = self._concluded()
        if self._stream.failed:
            self._tell_of_the_end()
        self._stream.check()
        return snapshot

    def _tell_of_silence(self) -> None:
        """Say that pictures have stopped and what is done, that they cannot be used, or nothing
        once they come again."""
        silent_s, source = self._stream.silent_s, self._stream.source
        trouble = source.trouble if isinstance(source, (Live, WatchedFolder)) else None
        if isinstance(source, WatchedFolder) and trouble is None:
            silent_s = 0.0  # nobody knows when the next picture is taken
        since = ""
        if silent_s > _SILENT_S or isinstance(trouble, OtherSize):
            since = self._silent_since or f"{datetime.now() - timedelta(seconds=silent_s):%H:%M:%S}"
        said = _silence_text(trouble, since)
        if said != self._said:
            self._said = said
            self._viewer.no_pictures(said, other_size=isinstance(trouble, OtherSize))
        if since != self._silent_since:
            self._silent_since = since
            for monitor in self._monitors:
                monitor.no_pictures(since)

    def _tell_of_camera(self) -> None:
        """Show a camera's settings when they have changed, and why one was not set."""
        source = self._stream.source
        if not isinstance(source, Live) or source.controls is None:
            return
        before, now = self._viewer.state.camera, source.controls.present
        if now != before:
            self._viewer.show_camera(now)
            if _focuses(before) and not _focuses(now):
                self._viewer.say(texts.FOCUS_LOCKED)  # in the place of the warning
        if source.controls.settings != self._camera:
            self._camera = source.controls.settings
            self._on_camera(self._camera)
        refusal = source.controls.refusal()
        if refusal is not None:
            self._viewer.warn(translated_error(refusal))

    def _tell_of_remarks(self) -> None:
        """Point to what was printed of a recording; a camera's is on the page."""
        if self._stream.remarks > self._remarks and not self._stream.source.is_live:
            self._viewer.warn(texts.SOURCE_REMARK)
        self._remarks = self._stream.remarks

    def _tell_of_the_end(self) -> None:
        """Leave the reason on the page, whose server ends with the source."""
        since = self._silent_since or f"{datetime.now():%H:%M:%S}"
        self._viewer.no_pictures(texts.NO_PICTURES_END.format(since=since))
        time.sleep(_DRAWN_S)

    def _concluded(self) -> Snapshot:
        # A view captured just now counts; no next pose is searched.
        snapshot = self._session.run_pending(stop=lambda: True)
        self._keep(snapshot)
        return snapshot

    def _end(self) -> None:
        self._thinking.close()

    def _show_picture(self, frame: Frame) -> None:
        self._viewer.show_picture(frame.image, came_s=frame.came_s)
        for monitor in self._monitors:
            monitor.show_picture(frame.image)

    # -- the guiding thread ----------------------------------------------------------------------

    def _guide(self) -> None:
        session = self._session
        observation = self._stream.take(timeout=0.05)
        self._tell_of_silence()
        self._tell_of_camera()
        self._tell_of_remarks()
        if self._stats is not None:
            self._stats.tell(self._stream.source)
        asked = self._viewer.drain_intents()
        for intent in asked:
            self._obey(intent)
        # One that was on its way may be of the size before.
        if observation is not None and observation.image_size == session.image_size:
            session.observe(observation)
        session.count_kept()
        if self._keep_picture() or asked or observation is not None:
            self._show()
        # Only now: the moved board is shown before the search's result.
        if self._think():
            self._show()

    def _show(self) -> None:
        snapshot = self._session.snapshot()
        source = self._stream.source
        if isinstance(source, Simulation):
            source.follow(
                snapshot.target,
                snapshot.pose,
                begins=not snapshot.captured,
                taken_back=snapshot.taken_back,
            )
        self._viewer.show(snapshot)
        for monitor in self._monitors:
            monitor.show(snapshot)
        self._keep(snapshot)

    def _keep_picture(self) -> bool:
        """Pass on the picture of a view captured just now; whether there was one."""
        view = self._session.take_new_view()
        if view is not None and view.observation.image is not None:
            self._viewer.keep_view(view.number, view.observation.image)
        return view is not None

    def _think(self) -> bool:
        """Collect finished work, start pending work; whether anything was finished."""
        session, thinking = self._session, self._thinking
        work, answer = thinking.work, thinking.take()
        if isinstance(answer, Outcome):
            session.apply(answer)
        elif answer is not None and work is not None:
            session.fail(work, answer)
        if session.pending is not None and session.pending is not thinking.work:
            thinking.begin(session.pending)
        return answer is not None

    def _obey(self, intent: intents.Intent) -> None:
        session, source = self._session, self._stream.source
        match intent:
            case intents.PageAction.CAPTURE:
                if not session.capture():
                    self._viewer.say(
                        texts.HAS_ENDED if session.phase == "finished" else texts.NOTHING_TO_CAPTURE
                    )
            case intents.PageAction.SKIP_TARGET:
                if not session.skip_target():
                    self._viewer.say(texts.NO_POSE_TO_CHOOSE)
            case intents.PageAction.UNDO_VIEW:
                if not session.undo_view():
                    has_views = session.snapshot().captured_count > 0
                    self._viewer.say(texts.VIEWS_STAY if has_views else texts.NO_VIEW_LEFT)
            case intents.DropView(number):
                # One that is gone already is as was asked.
                if not session.drop_view(number) and number in (session.snapshot().captured or ()):
                    self._viewer.say(texts.VIEWS_STAY)
            case intents.ChooseAlternative(index, number):
                self._choose(index, number)
            case intents.ChangeMethod(method, cost):
                try:
                    session.change_method(method, cost)
                except VenusError as error:
                    self._viewer.say(translated_error(error))
            case intents.PageAction.END_NOW:
                session.finish()
            case intents.PageAction.GO_ON:
                session.resume()
            case intents.PageAction.NEW_SESSION:
                session.restart(_size_now(source))
            case intents.Toggle("paused"):
                self._stream.pause(self._viewer.state.paused)
                for monitor in self._monitors:
                    monitor.pause(self._viewer.state.paused)
            case intents.Toggle("autopilot") if isinstance(source, Simulation):
                source.autopilot_on = self._viewer.state.autopilot
            case intents.SetCamera(name, wanted) if isinstance(source, Live):
                self._set_camera(source, name, wanted)
            case intents.DragBoard(pose) if isinstance(source, Simulation):
                source.autopilot_on = False
                source.move_to(pose)
            case intents.NudgeBoard(number, sign) if isinstance(source, Simulation):
                source.autopilot_on = False
                now_s = time.monotonic()
                source.move_to(self._by_keys.moved(source.board_pose, number, sign, now_s))
            case _:
                pass

    def _set_camera(self, source: Live, name: SettingName, wanted: str) -> None:
        if source.controls is not None:
            source.controls.ask(name, wanted)
            if name == "focus" and wanted != "lock" and self._session.snapshot().captured:
                self._viewer.warn(texts.FOCUS_CHANGED, seconds=60)

    def _choose(self, index: int, number: int) -> None:
        target = self._session.snapshot().target
        if number == 0:  # none was offered
            self._viewer.say(texts.NO_POSE_TO_CHOOSE)
        elif target is not None and target.number != number:
            self._viewer.say(texts.ANOTHER_TARGET)
        elif not self._session.choose_alternative(index):
            self._viewer.say(
                texts.NO_OTHER_POSE if self._session.phase == "guiding" else texts.NO_POSE_TO_CHOOSE
            )


def _focuses(settings: Sequence[CameraSetting]) -> bool:
    """Whether the camera focuses by itself."""
    return any(one.name == "focus" and one.automatic for one in settings)


def _size_now(source: Source) -> tuple[int, int] | None:
    """The size that the pictures have now, which `source` accepts; None if it cannot change."""
    return source.accept_size() if isinstance(source, (Live, WatchedFolder)) else None


def _silence_text(trouble: Trouble | None, since: str) -> str:
    """What is said of pictures that have not come since then; nothing if they come."""
    if not since:
        return ""
    match trouble:
        case OtherSize(was, now):
            was_px, now_px = (f"{width} x {height}" for width, height in (was, now))
            return texts.OTHER_SIZE_SENTENCE.format(was=was_px, now=now_px)
        case Outage(_, tries, next_try_s):
            wait_s = math.ceil(next_try_s)
            if wait_s == 0:
                return texts.NO_PICTURES_TRY.format(since=since, number=tries)
            return texts.NO_PICTURES_WAIT.format(since=since, number=tries + 1, wait=wait_s)
        case None:
            return texts.NO_PICTURES_YET.format(since=since)
