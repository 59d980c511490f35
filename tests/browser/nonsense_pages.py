"""The pages with all texts replaced by the same nonsense: each control still does what it is for.

`test_nonsense.py` runs this file in a process of its own, in which `nonsense` comes before all
pages. Buttons and entries are therefore found by their places; what they do is seen in the state.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest

from tests.browser.keyboard import hotkeys, pressed
from tests.ports import free_port
from tests.scene.teach_server import ServedTeaching, served_teaching
from tests.waiting import wait_until
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.exercise import LEVELS
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.lessons.reading import shipped_lessons
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.exercise.practice import PracticeSettings
from venus3d.scene.pages.exercise.run import PracticeServer, trial_server
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_pictures import TrialPictures
from venus3d.scene.pages.exercise.trial_plan import plan_of
from venus3d.scene.pages.exercise.view_model import (
    PRACTICE_HELPS,
    ChooseHelp,
    ChooseLevel,
    Nudge,
)
from venus3d.scene.pages.exercise.view_model import Press as Button
from venus3d.scene.pages.guide import intents, texts
from venus3d.scene.pages.guide.control_panel import CONTROLS
from venus3d.scene.pages.guide.method_panel import OFFERED
from venus3d.scene.pages.guide.uncertainty.maps import MAP_KINDS
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.pages.teach.actions import Action, Answer, PageAction, after_action
from venus3d.scene.pages.teach.controls import (
    HOTKEYS,
    LOOK_ROW,
    MENU_ROWS,
    PAGE_ROW,
    STEP_ROW,
)
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.server import start_server
from venus3d.storage.exercise import ExerciseFile

pytestmark = [pytest.mark.browser, pytest.mark.slow]

Press = Callable[[], object]
T = TypeVar("T")
ROW = ".mantine-Flex-root:has(> .mantine-Button-root)"


def test_the_texts_are_nonsense() -> None:
    assert texts.CAPTURE == texts.METHOD == "Blah"


def button(page: Any, row: int, place: int, within: str = "") -> Press:
    """Press a button by the place of its row, and its own in the row."""
    buttons = page.locator(f"{within} {ROW}:visible").nth(row).locator(".mantine-Button-root")
    return buttons.nth(place).click


def key(page: Any, hotkey: str) -> Press:
    return lambda: page.keyboard.press(pressed(hotkey))


def command(page: Any, place: int) -> Press:
    """Choose from the palette, by the place in its list."""

    def press() -> None:
        page.locator("button:has(.tabler-icon-list-search)").click()
        page.locator(".mantine-Spotlight-action").nth(place).click()
        page.wait_for_selector(".mantine-Spotlight-action", state="detached")

    return press


def entry(page: Any, choice: int, place: int, within: str = "") -> Press:
    """Choose from a list, by the list's place and the entry's."""

    def press() -> None:
        page.locator(f"{within} input.mantine-Select-input:visible").nth(choice).click()
        page.locator("[role=option]:visible").nth(place).click()

    return press


def some_of(keyed: Sequence[T]) -> Sequence[T]:
    """The first, the middle and the last. A key and its entry in the palette are one command, and
    the keys are all pressed."""
    return keyed[0], keyed[len(keyed) // 2], keyed[-1]


def does(viewer: Viewer, press: Press, wanted: intents.Intent) -> None:
    """Pressing does this, and asks the session for nothing else."""
    viewer.drain_intents()
    before = viewer.state
    press()
    asked: list[intents.Intent] = []

    def done() -> bool:
        asked.extend(viewer.drain_intents())
        return wanted in asked  # queued once the state has changed

    wait_until(done, f"{wanted}; asked for {asked}")
    if isinstance(wanted, intents.TurnStep):
        assert viewer.state.step == min(max(before.step + wanted.by, 1), 4)
    if isinstance(wanted, intents.Toggle):
        assert getattr(viewer.state, wanted.option) != getattr(before, wanted.option)
    assert set(asked) <= {wanted}, asked


def becomes(shown: Any, name: str, value: object) -> None:
    """What is shown, a page or a panel, comes to have this in its state."""
    wait_until(lambda: getattr(shown.state, name) == value, f"{name} is {value}: {shown.state}")


GUIDE_ROWS = (
    ("skip", "undo", "finish"),
    ("previous", "play", "next"),
    ("follow", "strip", "theme"),
    ("pause", "autopilot"),
    ("words", "built", "explain"),
)


def test_guide(viewer: Viewer, open_page: Callable[[], Any], guiding: Snapshot) -> None:
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector("[data-marked='3']", state="attached")
    does(viewer, page.locator("button:has(.icon-tabler-camera)").click, intents.PageAction.CAPTURE)
    for row, names in enumerate(GUIDE_ROWS):
        for place, name in enumerate(names):
            does(viewer, button(page, row, place), CONTROLS[name][0])
            if name == "finish":  # asks; the answers stand beside the question
                card = "[data-dock-leaf]:has(.v-guide)"
                does(viewer, button(page, 0, 1, card), intents.PageAction.GO_ON)
                page.wait_for_selector(f"{card} {ROW}", state="hidden")
    for intent, hotkey in CONTROLS.values():
        if hotkey is not None:
            does(viewer, key(page, hotkey), intent)
    known = hotkeys(viewer.server.gui)
    keyed = [(intent, hotkey) for intent, hotkey in CONTROLS.values() if hotkey is not None]
    for intent, hotkey in some_of(keyed):
        does(viewer, command(page, known.index(hotkey)), intent)


def test_help_tour_methods_and_uncertainty(
    viewer: Viewer, open_page: Callable[[], Any], guiding: Snapshot
) -> None:
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector(".v-chip")
    help_and_tour(page)
    method_lists(viewer, page)
    uncertainty(viewer, page, guiding)


def help_and_tour(page: Any) -> None:
    row = len(GUIDE_ROWS)
    button(page, row, 0)()
    page.wait_for_selector(".v-keys")
    page.locator(".mantine-Modal-body .mantine-Button-root").click()
    page.wait_for_selector(".v-keys", state="detached")
    button(page, row, 1)()
    page.wait_for_selector(".v-tour[data-step='1']")
    forth = page.locator(".mantine-Modal-body .mantine-Button-root").first
    for number in (2, 3):
        forth.click()
        page.wait_for_selector(f".v-tour[data-step='{number}']")
    button(page, 0, 0, ".mantine-Modal-body")()
    page.wait_for_selector(".v-tour[data-step='2']")
    button(page, 0, 1, ".mantine-Modal-body")()
    page.wait_for_selector(".v-tour", state="detached")


def method_lists(viewer: Viewer, page: Any) -> None:
    page.locator(".tabler-icon-chevron-down:visible").last.click()
    for place in (1, 0):
        does(viewer, entry(page, 0, place), intents.ChangeMethod(OFFERED[place]))


def uncertainty(viewer: Viewer, page: Any, guiding: Snapshot) -> None:
    page.locator("[role=tab]:has(.icon-tabler-map-2)").click()
    panel: Any = viewer.layers[0]
    tab = "[data-dock-leaf]:has([data-panel=uncertainty])"
    page.wait_for_selector(f"{tab} {ROW}")
    for place in (1, 2, 3, 4, 0):
        button(page, 0, place, tab)()
        becomes(panel, "map", MAP_KINDS[place])
    for place, name in enumerate(("views", "search")):
        before = getattr(panel.state, name)
        button(page, 1, place, tab)()
        becomes(panel, name, not before)
    numbers = [None, *(view.number for view in guiding.views)]
    for place in (1, 0):
        entry(page, 0, place, tab)()
        becomes(panel, "view", numbers[place])


@pytest.fixture
def teaching(paper_camera: Camera, default_board: Board) -> Iterator[ServedTeaching]:
    with (
        Offscreen("painter") as offscreen,
        served_teaching(
            PoseAnalysis(paper_camera, default_board),
            offscreen,
            lessons=shipped_lessons(),
            save=lambda state, kind: (f"pose.{kind}", b"content"),
            kinds=("html", "png"),
        ) as served,
    ):
        yield served


TEACH_ROWS = ((PAGE_ROW,), (STEP_ROW[:3], LOOK_ROW))
TEACH_MENU = MENU_ROWS


def test_teach(chromium: Any, teaching: ServedTeaching) -> None:
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.set_default_timeout(60_000)
    page.goto(teaching.url)
    page.wait_for_selector(".v-now")
    left = "[data-dock-leaf]:has([data-block], .mantine-Select-input)"
    right = "[data-dock-leaf]:has(.v-now)"
    # A page in the middle of a lesson, with a question.
    shown = teaching.state.lessons[0].pages
    asking = next(n for n, one in enumerate(shown) if one.question is not None)

    def does(press: Press, action: Action) -> None:
        before = teaching.change(lambda state: state.opened(0, asking).carried_to(0.3))
        page.wait_for_selector(".v-question")
        wanted = after_action(before, action)
        press()

        def done() -> bool:
            now = teaching.state
            if wanted.playing:  # a single step is soon over
                return now.playing or now.progress > before.progress
            return now == wanted

        wait_until(done, str(action))

    teaching.change(lambda state: state.opened(0, asking))
    page.wait_for_selector(".v-question")
    for within, rows in zip((left, right), TEACH_ROWS, strict=True):
        for row, actions in enumerate(rows):
            for place, action in enumerate(actions):
                does(button(page, row, place, within), action)
    menu = ".mantine-Modal-body"

    def in_menu(row: int, place: int) -> Press:
        def press() -> None:
            button(page, 0, 3, right)()
            button(page, row, place, menu)()
            page.wait_for_selector(menu, state="detached")

        return press

    for row, actions in enumerate(TEACH_MENU):
        for place, action in enumerate(actions):
            does(in_menu(row, place), action)
    known = hotkeys(teaching.server.tabs[0].client.gui)
    # No question has so many answers; the menu was opened above.
    unasked = (Answer(4), Answer(5), PageAction.MENU)
    keyed = [(a, k) for a, k in HOTKEYS.items() if k is not None and a not in unasked]
    for action, hotkey in keyed:
        does(key(page, hotkey), action)
    for action, hotkey in some_of(keyed):
        does(command(page, known.index(hotkey)), action)
    for lesson in (1, 0):
        entry(page, 0, lesson, left)()
        becomes(teaching, "lesson", lesson)
    with page.expect_download() as download:
        in_menu(len(TEACH_MENU), 1)()
    assert download.value.suggested_filename == "pose.png"
    page.close()


class Asked:
    """What a tab's exercise has been asked for since the last look."""

    def __init__(self, exercise: Any) -> None:
        handle, self._came = exercise.handle, list[Any]()

        def recorded(request: Any) -> None:
            handle(request)
            self._came.append(request)

        exercise.handle = recorded

    def after(self, press: Press, wanted: object) -> None:
        """Pressing asks for this and nothing else."""
        self._came.clear()
        press()
        wait_until(lambda: self._came, str(wanted))
        assert self._came == [wanted]


@contextmanager
def running(step: Callable[[], object]) -> Iterator[None]:
    """The loop that serves the pages, in a thread of its own."""
    stop = threading.Event()

    def run() -> None:
        while not stop.wait(0.02):
            step()

    loop = threading.Thread(target=run)
    loop.start()
    try:
        yield
    finally:
        stop.set()
        loop.join()


PRACTICE_KEYS: dict[str, object] = {
    "R": Button("start_over"),
    "V": Button("view"),
    "B": Button("theme"),
    "shift+H": ChooseHelp(None),
    **{str(level): ChooseLevel(level) for level in LEVELS},
    **dict(zip("LJKIOU", (Nudge(n, sign) for n in (3, 4, 5) for sign in (1, -1)), strict=True)),
    "shift+I": Nudge(0, 1),
    "shift+K": Nudge(0, -1),
    "shift+L": Nudge(1, 1),
    "shift+O": Nudge(2, 1),
    "G": Button("give_up"),
}


def test_practice(
    chromium: Any,
    paper_camera: Camera,
    default_board: Board,
    tmp_path: Path,
) -> None:
    settings = PracticeSettings.of(paper_camera, default_board, 0, "practice.csv")
    server, _ = start_server("127.0.0.1", free_port())
    with ExitStack() as stack:
        stack.callback(server.stop)
        offscreen = stack.enter_context(Offscreen("painter"))
        file = stack.enter_context(closing(ExerciseFile(tmp_path / "practice.csv", "practice")))
        practice = stack.enter_context(closing(PracticeServer(server, settings, file, offscreen)))
        stack.enter_context(running(practice.step))
        page = chromium.new_page(viewport={"width": 1280, "height": 900})
        stack.callback(page.close)
        page.set_default_timeout(60_000)
        page.goto(server.url)
        page.wait_for_selector(".v-do")
        (tab,) = practice.tabs
        asked, left = Asked(tab.model), "[data-dock-leaf]:has(.v-do)"
        for place in (3, 5, 0):
            asked.after(entry(page, 0, place, left), ChooseLevel(LEVELS[place]))
        for place in (1, 2, 3, 0):
            asked.after(entry(page, 1, place, left), ChooseHelp(PRACTICE_HELPS[place]))
        for place in (1, 0):
            asked.after(button(page, 0, place, left), Button("view"))
            page.wait_for_timeout(500)
        for place, action in enumerate(("start_over", "give_up")):
            asked.after(button(page, 1, place, left), Button(action))
        for hotkey, wanted in PRACTICE_KEYS.items():
            asked.after(key(page, hotkey), wanted)
        known = hotkeys(tab.client.gui)
        for hotkey in ("R", "4", "shift+H"):
            asked.after(command(page, known.index(hotkey)), PRACTICE_KEYS[hotkey])


def test_trial(chromium: Any, paper_camera: Camera, default_board: Board) -> None:
    targets = tuple(Pose.from_vector([0, 0, 0, 0, 0, z]) for z in (0.5, 0.6))
    trial = Trial(default_board, paper_camera, plan_of("Anna", []), targets, lambda _: None)
    server, _ = start_server("127.0.0.1", free_port())
    with ExitStack() as stack:
        stack.callback(server.stop)
        pictures = TrialPictures()
        trials = stack.enter_context(closing(trial_server(server, trial, pictures)))
        pictures.put(np.full((360, 640, 3), 90, np.uint8))
        asked = Asked(trial)

        def step() -> None:
            trial.observe(Observation.nothing(paper_camera.image_size))
            trials.step()

        stack.enter_context(running(step))
        page = chromium.new_page(viewport={"width": 1280, "height": 900})
        stack.callback(page.close)
        page.set_default_timeout(60_000)
        page.goto(server.url)
        page.wait_for_selector(".v-card")
        (tab,) = trials.tabs
        known = hotkeys(tab.client.gui)
        start = page.locator("button:has(.icon-tabler-player-play)").click
        give_up = page.locator("button:has(.icon-tabler-player-skip-forward)").click
        skip = Button("give_up")
        for begin in (start, key(page, "space"), command(page, known.index("space"))):
            asked.after(begin, Button("next"))
            page.wait_for_selector(".v-count")
            asked.after(give_up, skip)
            asked.after(key(page, "G") if begin is start else command(page, known.index("G")), skip)
            page.wait_for_selector(".v-count", state="detached")
        page.wait_for_selector(".v-times")
        for press in (key(page, "B"), command(page, known.index("B"))):
            asked.after(press, Button("theme"))
