"""The second monitor in a real browser: read at two metres, seen through the lens, not acted on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from tests.browser.conftest import Program
from tests.ports import free_port
from tests.scene.guided import matched
from tests.waiting import wait_until
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.matching import match
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import Language
from venus3d.render.annotated_picture import annotate
from venus3d.render.texts import STEP_SHORT_TITLES
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.controls import AudienceControls
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.sim import Simulation

pytestmark = pytest.mark.browser

TILTED = Pose.from_vector([25, -20, 8, 0.01, 0.005, 0.5])
_WIDE, _TALL = (1803, 1014), (1200, 1300)
"""Windows whose picture is 1280 wide, and one with the picture above the text."""
MARK_COLOUR = (255, 0, 255)


@pytest.fixture
def audience() -> Iterator[Audience]:
    page = Audience("127.0.0.1", free_port())
    yield page
    page.close()


@pytest.fixture
def frame(paper_camera: Camera, default_board: Board) -> Array:
    """What the true camera, with its distortion, sees of the tilted board."""
    source = Simulation(paper_camera, default_board, seed=1, realtime=False, start=TILTED)
    picture = source.read()
    source.close()
    assert picture is not None
    return picture.image


def opened(chromium: Any, url: str, width: int, height: int) -> Any:
    page = chromium.new_page(viewport={"width": width, "height": height})
    page.set_default_timeout(60_000)
    page.goto(url)
    page.wait_for_selector(".v-say")
    return page


def wait_for_sentence(page: Any, text: str) -> None:
    page.wait_for_function("t => document.querySelector('.v-say')?.innerText.includes(t)", arg=text)


def canvas_picture(page: Any) -> Array:
    """The picture's part of the screen, RGB, without the page's letters."""
    box = page.evaluate(
        "() => { const r = [...document.querySelectorAll('canvas')].at(-1)"
        ".getBoundingClientRect(); return [r.x, r.y, r.width, r.height] }"
    )
    clip = dict(zip(("x", "y", "width", "height"), box, strict=True))
    png = page.screenshot(clip=clip)
    return cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]


def detected(board: Board, rgb: Array) -> dict[int, Array]:
    """Corners by OpenCV, pixels."""
    grey = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2GRAY)
    corners, ids, _, _ = cv2.aruco.CharucoDetector(board.cv_board).detectBoard(grey)
    if ids is None:
        return {}
    return dict(zip(ids.ravel().tolist(), corners.reshape(-1, 2), strict=True))


def marks(rgb: Array) -> Array:
    """(N, 2) centres of the marks that are drawn in 3D, pixels."""
    far = np.abs(rgb.astype(int) - MARK_COLOUR).sum(axis=2)
    mask = (far < 200).astype(np.uint8)
    count, _, stats, centres = cv2.connectedComponentsWithStats(mask)
    return np.array([centres[i] for i in range(1, count) if stats[i, cv2.CC_STAT_AREA] > 8])


def settled(page: Any, read: Callable[[Array], Any], enough: int) -> tuple[Any, int]:
    """What is read off the picture once it is there and stands still, and the picture's width."""
    before, found = canvas_picture(page), ()
    for _ in range(80):
        page.wait_for_timeout(150)
        rgb = canvas_picture(page)
        if np.array_equal(rgb, before) and len(found := read(rgb)) >= enough:
            return found, rgb.shape[1]
        before = rgb
    raise AssertionError(f"only {len(found)} of {enough} are seen")


def test_what_is_drawn_in_3d_lies_on_what_the_camera_saw(
    sharp_chromium: Any,
    audience: Audience,
    frame: Array,
    guiding: Snapshot,
    paper_camera: Camera,
    default_board: Board,
) -> None:
    """A wrong field of view, centre, aspect or map would shift the marks off the corners: within
    1.5 px on a picture of 1280 px, for windows of any shape, and after the window has changed."""
    audience.change(lambda look: replace(look, lens=True, mirror=False))
    known = replace(guiding, camera=paper_camera, target=None, phase="guiding")
    audience.show(matched(known, None))
    page = opened(sharp_chromium, audience.url, *_WIDE)
    corners: list[tuple[dict[int, Array], int]] = []
    for size in (_WIDE, _TALL):
        page.set_viewport_size(dict(zip(("width", "height"), size, strict=True)))
        audience.show_picture(frame)
        corners.append(settled(page, lambda rgb: detected(default_board, rgb), 36))
    points = TILTED.apply(default_board.corners)
    for i, point in enumerate(points):
        audience.server.scene.add_icosphere(
            f"/mark/{i}", radius=0.0022, color=MARK_COLOUR, position=point, cast_shadow=False
        )
    for size, (found, width) in zip((_TALL, _WIDE), reversed(corners), strict=True):
        page.set_viewport_size(dict(zip(("width", "height"), size, strict=True)))
        centres, same = settled(page, marks, len(points))
        assert same == width and len(centres) == len(points)
        off = [float(np.linalg.norm(centres - at, axis=1).min()) for at in found.values()]
        print(size, f"mean {np.mean(off) * 1280 / width:.2f} most {max(off) * 1280 / width:.2f}")
        assert max(off) * 1280 / width < 1.5
    page.close()


def test_it_is_read_at_two_metres_and_there_is_nothing_to_press_but_sounds(
    sharp_chromium: Any, audience: Audience, frame: Array, guiding: Snapshot
) -> None:
    """Letters of a twentieth of the screen, half of it the picture; step, hold still, captured."""
    audience.show_picture(frame)  # who comes later sees it, too
    page = opened(sharp_chromium, audience.url, 1280, 720)
    wait_for_sentence(page, texts.STARTING[2])
    audience.show(guiding)
    assert guiding.match is not None
    wait_for_sentence(page, step_prompt(guiding.match.steps[2]).holder)
    assert page.inner_text(".v-top b") == "3"
    assert page.get_attribute(".v-dial svg", "aria-label") is not None
    size = page.evaluate("getComputedStyle(document.querySelector('.v-say')).fontSize")
    assert float(size.removesuffix("px")) >= 720 / 20
    _, width = settled(page, lambda rgb: rgb.ravel() if rgb.std() > 20 else (), 1)
    assert width * width * 9 / 16 >= 0.5 * 1280 * 720
    pressed = "button, input, a, select, textarea, [role=slider]"
    visible = [e for e in page.query_selector_all(pressed) if e.is_visible()]
    assert [e.inner_text() for e in visible] == [label for label, _ in texts.SOUNDS.values()]

    # A mirror turns the picture and no letters; a bright room has dark letters.
    turned = "getComputedStyle(document.querySelector('canvas')).transform.startsWith('matrix(-1,')"
    assert page.evaluate(turned), "whoever faces the camera has left and right as in a mirror"
    audience.change(lambda look: replace(look, mirror=False, light=True))
    page.wait_for_function(f"!{turned}")
    assert page.evaluate("getComputedStyle(document.querySelector('.v-say')).transform") == "none"
    page.wait_for_function(
        "getComputedStyle(document.querySelector('.v-say')).color === 'rgb(22, 25, 30)'"
    )

    there = replace(guiding.match, within=(True,) * 4, reached=True)
    audience.show(matched(guiding, there))
    wait_for_sentence(page, texts.STEP_DONE.format(title=STEP_SHORT_TITLES[2]))
    wait_for_sentence(page, texts.HOLD_STILL[2])
    audience.show(replace(guiding, phase="captured", captured=(1, 2)))
    wait_for_sentence(page, texts.CAPTURED[2])
    wait_for_sentence(page, texts.THINKING[2])

    # An upright phone has the picture as wide as it can be, and all of the rest below it.
    page.set_viewport_size({"width": 420, "height": 860})
    audience.show(guiding)
    wait_for_sentence(page, step_prompt(guiding.match.steps[2]).holder)
    page.wait_for_function(
        "() => { const r = [...document.querySelectorAll('canvas')].at(-1).getBoundingClientRect();"
        " return r.width === 420 && Math.abs(r.height - 420 * 9 / 16) < 1 }"
    )
    parts = ("canvas", ".v-side", ".v-say")
    boxes = [page.locator(part).last.bounding_box() for part in parts]
    ends = [0.0, *(box["y"] + box["height"] for box in boxes)]
    assert all(box["y"] >= end - 1 for box, end in zip(boxes, ends, strict=False))
    assert ends[-1] <= 861 and not page.evaluate(
        "[...document.querySelectorAll('.v-say')].some(e => e.scrollHeight > e.clientHeight + 1)"
    )
    page.close()


def test_the_operator_chooses_for_all_who_look(
    chromium: Any, audience: Audience, guiding: Snapshot
) -> None:
    """A key on the operator's page changes the other page; keys and clicks there change nothing."""
    viewer = Viewer(port=free_port())
    try:
        AudienceControls(viewer.server, audience)
        looking = opened(chromium, audience.url, 1280, 720)
        acting = chromium.new_page(viewport={"width": 1280, "height": 720})
        acting.goto(viewer.url)
        acting.wait_for_selector(".v-guide")
        audience.show(guiding)
        wait_for_sentence(looking, "Swing")
        looking.keyboard.press("Shift+X")
        looking.mouse.click(300, 300)
        acting.keyboard.press("Shift+C")
        looking.wait_for_function("document.querySelector('.v-audience') !== null")
        wait_until(lambda: audience.state.lens, "the operator's choice")
        assert audience.state == AudienceState(lens=True)

        looking.close(), acting.close()
    finally:
        viewer.close()


LISTEN = """
    window.spoken = []; window.tones = [];
    speechSynthesis.speak = u => spoken.push([performance.now() / 1000, u.text, u.lang]);
    const start = OscillatorNode.prototype.start;
    OscillatorNode.prototype.start = function (at) {
        tones.push([performance.now() / 1000, this.frequency.value]); start.call(this, at);
    };
    // What playwright asks of a page counts as a click; only the mouse's counts here.
    let clicked = false;
    addEventListener('pointerdown', () => { clicked = true }, true);
    Object.defineProperty(navigator, 'userActivation', { get: () => ({ hasBeenActive: clicked }) });
"""


@pytest.fixture
def listening(chromium: Any, audience: Audience) -> Iterator[Any]:
    """A page that records what is spoken and played."""
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.set_default_timeout(60_000)
    page.add_init_script(LISTEN)
    page.goto(audience.url)
    page.wait_for_selector(".v-say")
    yield page
    page.close()


def turned_by(snapshot: Snapshot, deg: float) -> Snapshot:
    """The board on step 3, so far from its end."""
    assert snapshot.target is not None
    target = snapshot.target.pose
    pose = target.turned("z", -30).turned("y", -deg)
    found = match(snapshot.camera, snapshot.board, pose, target)
    return matched(replace(snapshot, pose=pose), found)


def test_a_click_on_the_page_has_it_speak_at_most_every_four_seconds(
    listening: Any, audience: Audience, guiding: Snapshot
) -> None:
    """The holder's sentence at the click, the next one when the step has changed; silent before."""
    swing, rotate = turned_by(guiding, 20), turned_by(guiding, 0)
    for step, number in ((swing, 3), (rotate, 4)):
        assert step.remaining is not None and step.remaining.active == number
    audience.show(swing)
    wait_for_sentence(listening, "Swing")
    assert listening.evaluate("spoken") == []
    listening.get_by_role("button", name="Voice").click()
    listening.wait_for_function("spoken.length === 1")
    audience.show(rotate)
    listening.wait_for_function("spoken.length === 2")
    (first, said, language), (second, then, _) = listening.evaluate("spoken")
    assert "Swing" in said and "Rotate" in then and language == "en"
    assert "degrees" in said and "degrees" in then, "units as words"
    assert second - first >= 4
    listening.get_by_role("button", name="Voice").click()
    audience.show(swing)
    listening.wait_for_timeout(4500)
    assert len(listening.evaluate("spoken")) == 2 and listening.evaluate("tones") == []


def test_tones_close_in_and_the_page_asks_for_the_click_that_browsers_want(
    listening: Any, audience: Audience, guiding: Snapshot
) -> None:
    """The operator switches them on; nothing is played before the click, twice as often near."""
    audience.show(turned_by(guiding, 80))
    wait_for_sentence(listening, "Swing")
    audience.change(lambda look: replace(look, sound="tones"))
    listening.get_by_text(texts.SOUND_HINT).wait_for(state="visible")
    assert listening.evaluate("tones") == []
    listening.mouse.click(300, 300)
    listening.get_by_text(texts.SOUND_HINT).wait_for(state="hidden")

    def pause_s(deg: float) -> float:
        audience.show(turned_by(guiding, deg))
        wait_for_sentence(listening, f"{deg:.0f}°")
        listening.evaluate("tones.length = 0")
        listening.wait_for_function("tones.length >= 4")
        return float(np.median(np.diff([at for at, _ in listening.evaluate("tones")])))

    assert pause_s(5) < 0.6 * pause_s(80)
    audience.show(turned_by(guiding, 0))
    listening.wait_for_function("tones.some(([, hertz]) => hertz === 784)")
    assert listening.evaluate("spoken") == []


def test_it_goes_on_by_itself_after_the_program_was_started_again(
    chromium: Any, start: Callable[..., Program]
) -> None:
    """The program dies: that is said large. On the same port again: the page shows its moment."""
    port = free_port()
    command = f"guide sim --camera-size 640x360 --no-tour --no-record --audience {port}"
    command += f" --port {free_port()}"
    program = start(*command.split())
    page = opened(chromium, f"http://127.0.0.1:{port}", 1280, 720)
    page.wait_for_function("document.querySelector('.v-is-wait') === null")
    page.evaluate("document.querySelector('.v-say').dataset.before = 'yes'")
    assert not page.is_visible(".v-lost")
    program.kill()
    page.wait_for_selector(".v-lost", state="visible")
    page.wait_for_function(r"/\d\d:\d\d/.test(document.querySelector('.v-lost').innerText)")
    size = page.evaluate("getComputedStyle(document.querySelector('.v-lost')).fontSize")
    assert float(size.removesuffix("px")) >= 720 / 20
    at = page.locator(".v-lost").bounding_box(), page.locator(".v-say").bounding_box()
    assert at[0] == at[1], "what was said before is old, and covered"
    start(*command.split())
    page.wait_for_selector(".v-lost", state="hidden")
    page.wait_for_selector(".v-say:not([data-before])")
    page.close()


@pytest.mark.parametrize("language", ["en", "de"])
def test_what_is_praised_is_whole_and_nothing_else_is_drawn(
    sharp_chromium: Any,
    guiding: Snapshot,
    frame: Array,
    language: Language,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The next target was outlined beside "You may relax your arms"; and "Aufgenommen" was cut."""
    drawn: list[Snapshot] = []

    def noted(rgb: Array, snapshot: Snapshot, *others: Any) -> Array:
        drawn.append(snapshot)
        return annotate(rgb, snapshot, *others)

    monkeypatch.setattr("venus3d.scene.web.told_moment.annotate", noted)
    audience = Audience("127.0.0.1", free_port(), language=language)
    try:
        audience.show(guiding)
        page = opened(sharp_chromium, audience.url, 1280, 720)
        audience.show_picture(frame)
        wait_until(lambda: drawn and drawn[-1].remaining is not None, "the step's outline")
        audience.show(replace(guiding, captured=(1, 2)))  # with the next target already
        page.wait_for_selector(".v-is-good")
        wait_until(lambda: drawn[-1].remaining is None, "the outlines go")
        audience.show_picture(frame)
        for _ in range(2):
            title = page.locator(".v-top")
            assert title.evaluate("e => e.scrollWidth <= e.clientWidth"), title.inner_text()
            page.wait_for_timeout(300)
        assert drawn[-1].remaining is None
        page.wait_for_selector(".v-is-step")
        wait_until(lambda: drawn[-1].remaining is not None, "the next one's outline")
        refused = replace(guiding, refusal="Out of focus: edges are wide. Focus the lens.")
        audience.show(refused)
        page.wait_for_selector(".v-is-warning, .v-is-unseen")
        assert page.locator(".v-top").evaluate("e => e.scrollWidth <= e.clientWidth")
        page.close()
    finally:
        audience.close()
