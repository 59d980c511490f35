"""Everything on the guide page that tells what to do says the same, and it is true.

The page once told one step twice in opposite directions: the panel counted from the board as it is
held now, the pictures and the arrow from an upright one. Here 200 pairs (board now, target) are
shown on a real page and a real second monitor, and what they were given is compared with scipy's
rotations. The oracle knows nothing of the engine's decomposition and sentences.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import Wording
from venus3d.engine.guidance.snapshot import Snapshot, pose_snapshot
from venus3d.render.projections import Pictures, Projections
from venus3d.scene.pages.audience import audience as audience_module
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.guide.viewer import Viewer

PAIRS = 200
Matrix = Any


# -- the oracle ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Told:
    """What one wording says of four steps."""

    active: int
    amounts: tuple[str, ...]
    done: tuple[bool, ...]
    sentences: tuple[str, ...]
    others: tuple[str, ...]
    """The sentences in the other wording."""
    ends: tuple[tuple[Matrix, Matrix], ...]
    """Rotation and place of the board after each step."""


def told(
    now: tuple[Matrix, Matrix] | None, target: tuple[Matrix, Matrix], board: Board, wording: Wording
) -> Told:
    """From the board now, or from the frontal one at 500 mm: R' = Rz Ry Rx R, scipy's "xyz"."""
    upright = np.eye(3), np.array([0, 0, 0.5])
    (R0, t0), (R1, t1) = now or upright, target
    rest = Rotation.from_matrix(R1) * Rotation.from_matrix(R0).inv()
    turns, mm = rest.as_euler("xyz", degrees=True), 1000 * (t1 - t0)
    limit_mm = 35 * min(board.width, board.height)
    done = (float(np.sqrt(mm @ mm)) <= limit_mm, *(abs(turns) <= 2.5))
    # The dial ticks a part off that is within its share; a sentence tells the others.
    still = mm if now is None else np.where(abs(mm) <= limit_mm / np.sqrt(3), 0, mm)
    done = tuple(bool(d) and now is not None for d in done)
    amounts = (f"{np.sqrt(mm @ mm):.0f} mm", *(degrees(angle) for angle in turns))
    said = {
        w: tuple(
            "This step is done; leave it." if d else s
            for d, s in zip(done, (moved(still, w), *turned(turns, w)), strict=True)
        )
        for w in ("holder", "camera")
    }
    ends, R = [(R0, t1)], R0
    for axis, angle in zip("xyz", turns, strict=True):
        R = Rotation.from_euler(axis, angle, degrees=True).as_matrix() @ R
        ends.append((R, t1))
    other = "camera" if wording == "holder" else "holder"
    active = 1 + done.index(False) if False in done else 4
    return Told(active, amounts, done, said[wording], said[other], tuple(ends))


def degrees(angle: float) -> str:
    whole = f"{angle:+.0f}"
    return "0°" if float(whole) == 0 else whole.replace("-", "−") + "°"


def moved(mm: Matrix, wording: str) -> str:
    ways = {
        "camera": (("to the right", "to the left"), ("down", "up")),
        "holder": (("to your left", "to your right"), ("down", "up")),
    }[wording]
    ways = (*ways, ("away from the camera", "towards the camera"))
    parts = [
        f"{abs(part):.0f} mm {way[0] if part > 0 else way[1]}"
        for part, way in zip(mm, ways, strict=True)
        if abs(part) >= 0.5
    ]
    if len(parts) > 1:
        parts = [", ".join(parts[:-1]) + " and " + parts[-1]]
    return f"Move the board {''.join(parts)}."


def turned(turns: Matrix, wording: str) -> tuple[str, ...]:
    x, y, z = turns
    a, b, c = (f"{abs(turn):.0f}°" for turn in turns)
    # A turn +Y brings what is at +x, the picture's right and the holder's left, to -z: nearer.
    edge = "right" if y > 0 else "left"
    if wording == "holder":
        edge = "left" if y > 0 else "right"
    # +Z turns x towards y: right to down, clockwise as the camera sees it.
    clockwise = (z > 0) == (wording == "camera")
    return (
        f"Tilt the {'top' if x > 0 else 'bottom'} edge towards the camera by {a}.",
        f"Swing the edge on your {edge} towards the camera by {b}."
        if wording == "holder"
        else f"Swing the {edge} edge towards the camera by {b}.",
        f"Rotate the board {'clockwise' if clockwise else 'counter-clockwise'} by {c}.",
    )


# -- the pairs -------------------------------------------------------------------------------------


def a_pair(
    rng: np.random.Generator, case: int
) -> tuple[tuple[Matrix, Matrix] | None, tuple[Matrix, Matrix]]:
    """The board now (None: not seen), and its target. Every second one has steps done."""
    R1 = Rotation.from_euler("xyz", rng.uniform([-55, -55, -180], [55, 55, 180]), degrees=True)
    t1 = rng.uniform([-0.25, -0.15, 0.3], [0.25, 0.15, 0.9])
    if case % 8 == 7:
        return None, (R1.as_matrix(), t1)
    left = rng.uniform(3, 60, 3) * rng.choice([-1, 1], 3)
    mm = rng.uniform(20, 300) * direction(rng)
    if case % 2:
        left = np.where(rng.random(3) < 0.5, rng.uniform(-2.4, 2.4, 3), left)
        mm = mm if rng.random() < 0.4 else rng.uniform(0, 5.5) * direction(rng)
    elif case % 4 == 2:
        left = rng.uniform([-89, -80, -179], [89, 80, 179])
    R0 = Rotation.from_euler("xyz", left, degrees=True).inv() * R1
    return (R0.as_matrix(), t1 - mm / 1000), (R1.as_matrix(), t1)


def direction(rng: np.random.Generator) -> Matrix:
    free = rng.standard_normal(3)
    return free / np.linalg.norm(free)


# -- the page --------------------------------------------------------------------------------------


class Recorded(Projections):
    """Draws nothing; remembers what the newest pictures are of."""

    steps: Steps
    done: tuple[bool, ...]

    def __init__(self) -> None:
        pass

    @property
    def note(self) -> str:
        return ""

    def of(self, steps: Steps, *args: Any, **how: Any) -> Pictures:
        if "done" in how:  # not those of the pose from upright
            self.done = how["done"]
            self.steps = steps
            assert not how["letters"], "a picture has no number that could contradict the words"
        picture: Future[Any] = Future()
        picture.set_result(np.zeros((9, 16, 3), np.uint8))
        return picture, picture, picture, picture


@dataclass
class Pages:
    viewer: Viewer
    audience: Audience
    pictures: Recorded

    def show(self, snapshot: Snapshot) -> None:
        self.viewer.show(snapshot)
        self.audience.show(snapshot)


@pytest.fixture(scope="module")
def pages() -> Iterator[Pages]:
    pictures = Recorded()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(audience_module, "_SCENE_PERIOD_S", 0.002)
        viewer = Viewer("127.0.0.1", free_port(), projections=pictures)
        audience = Audience("127.0.0.1", free_port())
        viewer._period = 0.002
        yield Pages(viewer, audience, pictures)
        audience.close()
        viewer.close()


def text_of(html: str) -> str:
    plain = re.sub(r"<[^>]*>", "\n", html).replace("\u00a0", " ").replace("&#x27;", "'")
    return "\n".join(line.strip() for line in plain.split("\n") if line.strip())


def inside(html: str, name: str) -> list[str]:
    """Texts of the elements of this class."""
    found = re.findall(rf"<(\w+) class='{name}(?: [^']*)?'[^>]*>(.*?)</\1>", html)
    return [text_of(content) for _, content in found]


def panel_says(viewer: Viewer) -> dict[str, Any]:
    html = viewer.view.guidance.content
    chips = re.findall(
        r"<div class='v-chip( v-on)?( v-done)?'[^>]*title='([^']*)'><b>(\d)</b>"
        r"<span>\w+</span><i>([^<]*)</i>",
        html,
    )
    return {
        "title": inside(html, "v-title"),
        "amount": [a.split("\n") for a in inside(html, "v-amount")],
        "sentence": inside(html, "v-sentence"),
        "other": inside(html, "v-picture"),
        "chips": [(int(number), fact) for *_, number, fact in chips],
        "chips done": [bool(done) for _, done, *_ in chips],
        "chip on": [int(number) for on, _, _, number, _ in chips if on],
        "chip hints": [hint.split(": ")[1] for _, _, hint, *_ in chips],
    }


def panel_shall_say(told: Told, now: Any, wording: Wording) -> dict[str, Any]:
    names = ("Move", "Tilt about X", "Swing about Y", "Rotate about Z")
    facts = facts_of(told)
    said: dict[str, Any] = {
        "chips": list(enumerate(facts, start=1)),
        "chips done": list(told.done),
        "chip on": [told.active],
        "chip hints": facts,
        "amount": [],
        "other": [],
    }
    if now is None:
        sentence = "Show the whole board to the camera: near enough, and not edge-on."
        return {**said, "title": ["Board not seen"], "sentence": [sentence]}
    if all(told.done):
        return {**said, "title": ["Hold still"], "sentence": ["Hold the board still."]}
    i = told.active - 1
    label = {
        "holder": "In the camera's picture: ",
        "camera": "For whoever holds the board: ",
    }[wording]
    differs = told.others[i] != told.sentences[i]
    return {
        **said,
        "title": [f"Step {told.active} of 4:\n{names[i]}"],
        "amount": [[told.amounts[i], "to go"]],
        "sentence": [told.sentences[i]],
        "other": [label + told.others[i]] if differs else [],
    }


def facts_of(told: Told) -> list[str]:
    return ["✓ done" if d else a for a, d in zip(told.amounts, told.done, strict=True)]


def cards_say(viewer: Viewer) -> dict[str, Any]:
    html = viewer.view.projections._tiles.content
    cards = re.findall(
        r"<div class='v-tile(?: v-done| v-old)?( v-on)?'.*?<b>(\d)</b>"
        r"<strong>[^<]*<small>(.*?)</small></strong>"
        r"<span>([^<]*)</span>.*?data-shot='steps-(\d)'",
        html,
    )
    return {
        "cards": [
            (int(n), text_of(fact).replace("\n", " "), words) for _, n, fact, words, _ in cards
        ],
        "pictures": [int(picture) for *_, picture in cards],
        "card on": [int(number) for on, number, *_ in cards if on],
        "from upright": "Four steps from upright" in html,
        "reader": re.findall(r">For the (holder|camera): ", html),
    }


def cards_shall_say(told: Told, now: Any, wording: Wording) -> dict[str, Any]:
    lefts = [f if d else f"{f} to go" for f, d in zip(facts_of(told), told.done, strict=True)]
    return {
        "cards": [
            (n, f"Step {n} of 4 · {left}", sentence)
            for n, left, sentence in zip((1, 2, 3, 4), lefts, told.sentences, strict=True)
        ],
        "pictures": [1, 2, 3, 4],
        "card on": [told.active],
        "from upright": now is None,
        "reader": [wording],
    }


def scene_says(viewer: Viewer) -> dict[str, Any]:
    # Without a browser, labels are viser's own.
    scene, names = viewer._scene, viewer.scene_names
    return {
        "labels": {n: scene.node(n)._plain.text for n in names if re.match(r"/steps/\d/label", n)},
        "arrows": {n for n in names if re.match(r"/steps/\d/arrow", n)},
        "ends": {n for n in names if re.match(r"/steps/\d/after", n)},
    }


def scene_shall_say(told: Told) -> dict[str, Any]:
    n, is_done = told.active, told.done[told.active - 1]
    return {
        "labels": {} if is_done else {f"/steps/{n}/label": told.amounts[n - 1]},
        "arrows": set() if is_done else {f"/steps/{n}/arrow"},
        "ends": {f"/steps/{n}/after"},
    }


def monitor_says(audience: Audience) -> dict[str, Any]:
    html = audience._view._glance.content
    return {
        "sentence": text_of(re.findall(r"class='v-say'[^>]*>(.*?)</div>", html)[0]),
        "figure": re.findall(r"class='v-figure'>([^<]*)<", html),
        "move": re.findall(r"class='v-part'[^>]*>([^<]*)<", html),
        "chips": re.findall(r"<i class='v-chip[^']*'[^>]*>([^<]*)</i>", html),
        "on": re.findall(r"<i class='v-chip v-on[^']*' style='[^']*'>([^<]*)</i>", html),
    }


def monitor_shall_say(told: Told, mm: Matrix, now: Any, board: Board) -> dict[str, Any]:
    """For its reader, who always holds the board; left and right are theirs."""
    said: dict[str, Any] = {"figure": [], "move": [], "on": []}
    said["chips"] = ["✓" if d else str(n) for n, d in enumerate(told.done, start=1)]
    if now is None:
        sentence = "Show the whole board to the camera: near enough, and not edge-on."
        return {**said, "sentence": sentence, "chips": ["1", "2", "3", "4"]}
    if all(told.done):
        return {**said, "sentence": "Hold the board still."}
    said["sentence"], said["on"] = told.sentences[told.active - 1], [str(told.active)]
    if told.active > 1:
        said["figure"] = [told.amounts[told.active - 1]]
        return said
    band = 35 * min(board.width, board.height) / np.sqrt(3)
    x, y, z = (f"{abs(v):.0f} mm" for v in mm)
    parts = (
        f"{x} →" if mm[0] < 0 else f"← {x}",  # the camera's right is the holder's left
        f"{y} ↓" if mm[1] > 0 else f"↑ {y}",
        z,
    )
    said["move"] = [
        p if abs(v) > band else "✓ done" if abs(v) < 0.5 else f"✓ {p}"
        for v, p in zip(mm, parts, strict=True)
    ]
    return said


# -- the tests -------------------------------------------------------------------------------------


@pytest.mark.parametrize("wording", ["holder", "camera"])
def test_everything_that_tells_what_to_do_agrees_with_scipy(
    wording: Wording, pages: Pages, paper_camera: Camera, default_board: Board
) -> None:
    board, rng, before = default_board, np.random.default_rng(15), None
    viewer = pages.viewer
    viewer.change(lambda state: replace(state, camera_words=wording == "camera", strip=False))
    seen = dict.fromkeys(("unseen", "hold", "some done", 1, 2, 3, 4), 0)
    for case in range(PAIRS // 2):
        now, target = a_pair(rng, case)
        pose = None if now is None else Pose(*now)
        snapshot = before = pose_snapshot(board, paper_camera, pose, Pose(*target), before)
        pages.show(snapshot)
        said, holder = (told(now, target, board, w) for w in (wording, "holder"))
        mm = 1000 * (target[1] - (now or (None, target[1]))[1])
        shall = {
            **{f"panel: {k}": v for k, v in panel_shall_say(said, now, wording).items()},
            **{f"cards: {k}": v for k, v in cards_shall_say(said, now, wording).items()},
            **{f"scene: {k}": v for k, v in scene_shall_say(said).items()},
            **{f"monitor: {k}": v for k, v in monitor_shall_say(holder, mm, now, board).items()},
        }

        def says() -> dict[str, Any]:
            return {
                **{f"panel: {k}": v for k, v in panel_says(viewer).items()},
                **{f"cards: {k}": v for k, v in cards_say(viewer).items()},
                **{f"scene: {k}": v for k, v in scene_says(viewer).items()},
                **{f"monitor: {k}": v for k, v in monitor_says(pages.audience).items()},
            }

        try:
            wait_until(lambda shall=shall: says() == shall, "the moment is shown", within_s=5)
        except AssertionError:
            assert says() == shall, case
        check_plates_and_pictures(pages, said)
        seen["unseen"] += now is None
        seen["hold"] += all(said.done)
        seen["some done"] += 0 < sum(said.done) < 4
        seen[said.active] += not all(said.done)
    assert min(seen.values()) > 0, seen


def check_plates_and_pictures(pages: Pages, said: Told) -> None:
    """The end plate stands where the active step ends, and the pictures show these steps."""
    plate = pages.viewer._scene.node(f"/steps/{said.active}/after")
    R, t = said.ends[said.active - 1]
    quaternion = np.roll(plate.wxyz, -1)
    np.testing.assert_allclose(Rotation.from_quat(quaternion).as_matrix(), R, atol=1e-6)
    np.testing.assert_allclose(plate.position, t, atol=1e-9)
    goal = said.ends[3][1]
    wait_until(lambda: (pages.pictures.steps[3].after.t == goal).all(), "pictures are ordered")
    assert pages.pictures.done == said.done
    for step, (R, t) in zip(pages.pictures.steps, said.ends, strict=True):
        np.testing.assert_allclose(step.after.R, R, atol=1e-9)
        np.testing.assert_allclose(step.after.t, t, atol=1e-12)


def test_the_steps_side_by_side_say_the_same(
    pages: Pages, paper_camera: Camera, default_board: Board
) -> None:
    rng, viewer = np.random.default_rng(16), pages.viewer
    viewer.change(lambda state: replace(state, strip=True))
    for case in range(20):
        now, target = a_pair(rng, case)
        pose = None if now is None else Pose(*now)
        pages.show(pose_snapshot(default_board, paper_camera, pose, Pose(*target)))
        facts = facts_of(told(now, target, default_board, "holder"))

        def captions() -> list[str]:
            nodes = [viewer._scene.node(f"/strip/{n}/caption") for n in (1, 2, 3, 4)]
            return ["" if n is None or n._plain is None else n._plain.text for n in nodes]

        wait_until(lambda facts=facts: all(map(str.endswith, captions(), facts)), "captions")
    viewer.change(lambda state: replace(state, strip=False))


def test_how_the_pose_is_built_is_drawn_only_when_asked_for(
    pages: Pages, paper_camera: Camera, default_board: Board
) -> None:
    """The paper's steps from upright, under a name of their own, whatever the board does."""
    rng, viewer = np.random.default_rng(17), pages.viewer
    now, target = a_pair(rng, 0)
    assert now is not None
    snapshot = pose_snapshot(default_board, paper_camera, Pose(*now), Pose(*target))
    pages.show(snapshot)
    panel = viewer.view.built._tiles
    assert not panel.visible and not panel.content
    viewer.change(lambda state: replace(state, built=True, camera_words=True))
    wait_until(lambda: panel.visible and "data-shot='built-4'" in panel.content, "it is shown")
    upright = told(None, target, default_board, "camera")
    cards = re.findall(
        r"<small>Step \d of 4 · ([^<]*) in all</small></strong><span>([^<]*)<", panel.content
    )
    assert cards == list(zip(upright.amounts, upright.sentences, strict=True))
    viewer.change(lambda state: replace(state, built=False, camera_words=False))
    wait_until(lambda: not panel.visible, "it is folded away")
