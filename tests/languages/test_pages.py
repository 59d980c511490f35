"""What the pages send to a German browser has no English sentence left in it.

The real pages are asked for everything that they send, by a client that states German as its
language, in as many moments as can be had without a camera. A text counts as English if it holds
one of the words below, which no German text has.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from websockets.exceptions import WebSocketException

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.scene.teach_server import served_teaching
from tests.waiting import wait_until
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.convergence import Convergence
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.snapshot import Snapshot, pose_snapshot
from venus3d.engine.sentences import after_each_other
from venus3d.lessons.lesson import Lesson, LessonPage, Question
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.controls import AudienceControls
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.practice import PracticeSettings
from venus3d.scene.pages.exercise.run import PracticeServer, trial_server
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_pictures import TrialPictures
from venus3d.scene.pages.exercise.trial_plan import plan_of
from venus3d.scene.pages.exercise.view_model import ChooseHelp, ChooseLevel, Press
from venus3d.scene.pages.guide import texts as guide_say
from venus3d.scene.pages.guide.intents import PageAction, Toggle
from venus3d.scene.pages.guide.uncertainty.texts import MapKind
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.storage.exercise import ExerciseFile

ENGLISH = frozenset(
    re.findall(
        r"\w+",
        """about above again all and any are be been before below board both but by camera can
        change chosen close done drag edge end every fit four from go has have help hide how if
        image is it its keys known left lens less look makes means more most move moved new next no
        not of on once one only or other page picture pictures place pose press right see seen
        shown show shows side some step steps target that the their then there they this to towards
        turn two view views what when where which who with without you your""",
    )
)
# Names: of methods, of costs, of notations, of files.
NAMES = re.compile(
    r"\(?[a-z]+(-[a-z]+)+\)?|--[\w.-]+|\w+\.(yaml|json|csv)|venus3d|Gimbal Lock|ROS|"
    r"Roll, Pitch, Yaw"
)

PARAMETERS = PAPER_CAMERA.parameter_names


def english_in(text: str) -> list[str]:
    """The English words of a text or an HTML fragment; style sheets, scripts and data left out."""
    hidden = r"<(style|script)\b.*?</\1>|onclick=\"[^\"]*\"|data-copy='[^']*'"
    text = re.sub(hidden, " ", text, flags=re.S)
    shown = re.findall(r"(?:title|alt|aria-label)=(?:'([^']*)'|\"([^\"]*)\")", text)
    plain = " . ".join([re.sub(r"<[^>]*>", " ", text), *("".join(pair) for pair in shown)])
    plain = NAMES.sub(" ", unescape(plain))
    return [w for w in re.findall(r"[A-Za-zÄÖÜäöüß]+", plain) if w.lower() in ENGLISH]


_SHOWN = {
    "label", "hint", "content", "text", "title", "body", "description", "markdown", "_markdown",
    "options", "value", "html", "tab_labels", "_tab_labels", "lower_label", "upper_label",
    "placeholder", "legend", "series", "axes",
}  # fmt: skip


def texts_in(value: Any, key: str = "") -> Iterator[str]:
    """The texts of a message that a person sees, by the names of their fields."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from texts_in(inner, name if name in _SHOWN else key if key == "series" else "")
            if name in ("props", "updates", "marks", "_marks"):
                yield from texts_in(inner, "")
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from texts_in(inner, key)
    elif isinstance(value, str) and key:
        yield value


def check(messages: list[dict[str, Any]], moment: str) -> int:
    """No text in these messages is English; how many there are."""
    texts = [t for m in messages for t in texts_in(m) if re.search(r"[a-z]{2}", t)]
    found = {t[-300:]: words for t in texts if (words := english_in(t))}
    assert not found, f"{moment}: {found}"
    return len(texts)


def everything(port: int) -> list[dict[str, Any]]:
    """All that a page which tabs share sends to a new browser."""
    with RawClient(port, language="de-DE,de;q=0.9,en;q=0.5") as client:
        client.look()
        return client.backlog()


def arriving(client: RawClient, quiet_s: float = 0.25) -> list[dict[str, Any]]:
    """What comes until nothing has for a while."""
    got: list[dict[str, Any]] = []
    with suppress(TimeoutError):
        while True:
            got += client.window(timeout=quiet_s)
    return got


# -- guide and the second monitor ------------------------------------------------------------------


def moments(
    guided: Snapshot, camera: Camera, board: Board
) -> Iterator[tuple[str, Snapshot, Callable[[Viewer], None]]]:
    """Names, snapshots, and what else happens."""

    def nothing(_: Viewer) -> None:
        pass

    def toggle(name: Any) -> Callable[[Viewer], None]:
        return lambda viewer: viewer._ask(Toggle(name))

    session = Session(board, camera.image_size)
    yield "startup", session.snapshot(), nothing
    target = Pose.from_vector([20, -30, 15, 0.05, 0.02, 0.5])
    for name, vector in {
        "move": [0, 0, 0, -0.1, 0.05, 0.7],
        "tilt": [-20, -10, 0, 0.05, 0.02, 0.5],
        "swing": [20, 20, -9, 0.05, 0.02, 0.5],
        "hold": [20, -30, 15, 0.05, 0.02, 0.5],
    }.items():
        yield name, pose_snapshot(board, camera, Pose.from_vector(vector), target), nothing
    yield "unseen", pose_snapshot(board, camera, None, target), nothing
    yield "no target", pose_snapshot(board, camera, target), nothing
    yield "guiding", guided, nothing
    yield "how it is built", guided, toggle("built")
    yield "camera's words", guided, toggle("camera_words")
    for kind in get_args(MapKind):
        yield kind, guided, lambda viewer, kind=kind: viewer.layers[0]._change(map=kind)  # pyright: ignore
    yield "a view", guided, lambda viewer: viewer.layers[0]._change(view=2)  # pyright: ignore
    yield "searching", guided, lambda viewer: viewer.layers[0]._change(search=True)  # pyright: ignore
    yield "captured", replace(guided, phase="captured", target=None, remaining=None), nothing
    yield "end?", guided, lambda viewer: viewer._ask(PageAction.FINISH)
    settled = Convergence(np.ones(9), (True,) * len(PARAMETERS), "repaired")
    over = replace(guided, convergence=settled, target=None, match=None, remaining=None)
    yield "converged", replace(over, phase="converged", diagnoses=()), nothing
    yield "doubted", replace(over, phase="converged"), nothing
    yield "finished", replace(over, phase="finished"), nothing
    unsure = Convergence(np.ones(9), (False,) * 3 + (True,) * 6, "repaired")
    yield "unsettled", replace(over, phase="finished", convergence=unsure), nothing
    yield "silent", guided, lambda viewer: viewer.no_pictures("")
    yield "paused", guided, toggle("paused")


def test_what_is_said_before_a_browser_comes_is_in_its_language(guided: Snapshot) -> None:
    """The first sentences stayed English on a German page."""
    with closing(Viewer(port=free_port())) as viewer:
        viewer.show(guided)
        with viewer.language.spoken():
            viewer.say(after_each_other([guide_say.FROM_CAMERA, guide_say.DRAG_HINT]), seconds=600)
        with suppress(WebSocketException), RawClient(viewer.port, language="de") as first:
            first.look()
            wait_until(lambda: viewer.language.code == "de", "German")

        def told() -> str:
            with suppress(WebSocketException, OSError):
                return " ".join(text for m in everything(viewer.port) for text in texts_in(m))
            return ""

        wait_until(lambda: "an seinen Griffen ziehen" in told(), "the hint, in German")
        assert "Eine bekannte Kamera ist der Anfang" in told()


def test_the_guide_and_the_second_monitor_speak_german(
    guided: Snapshot, paper_camera: Camera, default_board: Board
) -> None:
    """As the first browser asks for it: the pages are laid out once more for that."""
    viewer = Viewer(port=free_port(), draggable_board=True, step_pictures=False)
    audience = Audience("127.0.0.1", free_port())
    viewer.extend(lambda server: AudienceControls(server, audience).commands)
    with closing(viewer), closing(audience):
        before = viewer.server
        with RawClient(viewer.port, language="de") as first, suppress(Exception):
            first.window(timeout=5)
        with RawClient(audience.port, language="de") as first, suppress(Exception):
            first.window(timeout=5)
        wait_until(lambda: viewer.server is not before and viewer.language.code == "de")
        wait_until(lambda: audience.language.code == "de" and audience._threads._page == 1)
        seen = 0
        for name, snapshot, do in moments(guided, paper_camera, default_board):
            do(viewer)
            viewer.show(snapshot)
            audience.show(snapshot)
            wait_until(lambda: not viewer._changed and not audience._changed)
            time.sleep(0.15)
            seen += check(everything(viewer.port), f"guide, {name}")
            seen += check(everything(audience.port), f"second monitor, {name}")
        assert seen > 2000


# -- the pages with a tab for everybody ------------------------------------------------------------


@pytest.fixture
def german() -> Iterator[LocalServer]:
    server, _ = start_server("127.0.0.1", free_port())
    yield server
    server.stop()


def test_the_teaching_page_speaks_german_in_a_german_tab(
    paper_camera: Camera, default_board: Board, painter: Offscreen
) -> None:
    """Beside an English one; a lesson in English is shown in English, with all around it."""
    pose = (20.0, -30.0, 10.0, 30.0, -20.0, 500.0)
    question = Question("Ja?", ("Ja", "Nein"), 1, "Darum.")
    german = Lesson(
        "eins",
        "Eins",
        "Kurz.",
        (
            LessonPage("Seite", "Text.", pose, show=("sigma", "distortion"), question=question),
            LessonPage("Zwei", "Text.", (80.0, 60.0, 0.0, 600.0, 0.0, 300.0)),
            LessonPage("Drei", "Text.", pose, arrangement="axes"),
            LessonPage("Vier", "Text.", pose, arrangement="order", order="zyx"),
        ),
    )
    english = replace(german, name="two", title="Zwei", language="en")
    analyse = PoseAnalysis(paper_camera, default_board)
    teaching = served_teaching(analyse, painter, lessons=(german, english), lesson=0)
    with teaching as teach, RawClient(teach.port, language="de") as tab:
        tab.look()
        page = teach.page()
        seen = check(arriving(tab), "teach")
        changes: dict[str, Callable[[TeachState], TeachState]] = {
            "answer": lambda state: state.answered(2),
            "step 1": lambda state: state.step_on(),
            "start": lambda state: state.carried_to(0.0),
            "strip": lambda state: state.with_arrangement("strip"),
            "refused": lambda state: state.page_turned(1),
            "axes": lambda state: state.page_turned(1),
            "order": lambda state: state.page_turned(1),
            "locked": lambda state: state.with_vector((10.0, 90.0, 0.0, 0.0, 0.0, 500.0)),
            "free": lambda state: state.opened(None),
        }
        for name, change in changes.items():
            teach.change(change)
            seen += check(arriving(tab), f"teach, {name}")
        with teach.server.tabs[0].language.spoken():  # as viser's callbacks do
            page.toggle_menu()
        seen += check(arriving(tab), "teach, menu")
        assert seen > 200
        with RawClient(teach.port, language="en-GB,de;q=0.5") as other:
            other.look()
            teach.learner(1)
            with pytest.raises(AssertionError, match="camera"):
                check(arriving(other, 1.0), "an English tab")
        mine = teach.server.tabs[0].language
        teach.change(lambda state: state.opened(1))
        wait_until(lambda: mine.code == "en")
        with pytest.raises(AssertionError, match="camera"):
            check(arriving(tab, 1.0), "an English lesson")
        teach.change(lambda state: state.opened(0))
        wait_until(lambda: mine.code == "de")


def test_practice_speaks_german(
    paper_camera: Camera,
    default_board: Board,
    painter: Offscreen,
    tmp_path: Path,
    german: LocalServer,
) -> None:
    settings = PracticeSettings.of(paper_camera, default_board, 0, "practice.csv")
    with closing(ExerciseFile(tmp_path / "practice.csv", "practice")) as file:
        practice = PracticeServer(german, settings, file, painter)
        with RawClient(german.get_port(), language="de") as tab:
            tab.look()
            wait_until(lambda: practice.tabs)
            practice.step()
            seen = check(arriving(tab), "practice")
            for level, help_ in ((6, "steps"), (3, "axes"), (4, "outline"), (2, "none")):
                practice.tabs[0].requests.put(ChooseLevel(level))
                practice.tabs[0].requests.put(ChooseHelp(help_))
                practice.step()
                seen += check(arriving(tab), f"practice, level {level}, {help_}")
            practice.tabs[0].requests.put(Press("give_up"))
            practice.step()
            seen += check(arriving(tab), "practice, given up")
        practice.close()
    assert seen > 150


def test_the_trial_speaks_german(
    paper_camera: Camera, default_board: Board, german: LocalServer
) -> None:
    target = Pose.from_vector([0, 0, 0, 0, 0, 0.5])
    trial = Trial(default_board, paper_camera, plan_of("Anna", []), (target,), lambda _: None)
    trials = trial_server(german, trial, TrialPictures(), simulated=True)
    with RawClient(german.get_port(), language="de") as tab:
        tab.look()
        wait_until(lambda: trials.tabs)
        trial.say(say.DRAG_HINT, 60)
        trials.step()
        seen = check(arriving(tab), "trial")
        pixels = paper_camera.project(
            Pose.from_vector([20, 10, 0, 0, 0, 0.6]).apply(default_board.corners)
        )
        frame = Observation(np.arange(len(pixels)), pixels, paper_camera.image_size)
        for _ in range(3):  # each help
            trial.observe(frame)
            trial.begin()
            trial.observe(frame)
            trials.step()
            seen += check(arriving(tab), "trial, begun")
            trial.give_up()
            trials.step()
            seen += check(arriving(tab), "trial, given up")
    trials.close()
    assert seen > 60
