"""What a tab is sent first when the board moves and a new target comes in the same moment."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.waiting import wait_until
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.guide.uncertainty import panel, texts
from venus3d.scene.pages.guide.uncertainty.search_replay import SearchReplay
from venus3d.scene.pages.guide.viewer import Viewer

MAP = "class='v-map'"


def test_the_board_moves_before_maps_and_pictures_come(
    guided: Snapshot, painter: Offscreen
) -> None:
    """These take longer than all the rest, and nobody waits for them. All come, too, though no
    frame comes any more."""
    came = shown(guided, Projections(painter), MAP, "data-shot='steps-4' role='img'")
    assert 0 <= board_in(came) < place_of(MAP, came)


def test_the_map_comes_by_itself(guided: Snapshot) -> None:
    """It is drawn a moment after the scene, without a frame or a picture that calls for it."""
    came = shown(guided, None, MAP)
    assert 0 <= board_in(came) < place_of(MAP, came)


def test_a_replayed_search_ends_although_nothing_comes(
    guided: Snapshot, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [100.0]
    monkeypatch.setattr(panel, "SearchReplay", partial(SearchReplay, clock=lambda: now[0]))
    viewer, came = Viewer("127.0.0.1", free_port()), list[dict[str, Any]]()
    try:
        (known,) = viewer.layers
        assert guided.search_trace is not None
        next(c for c in known.commands if c.label == texts.REPLAY_SEARCH).do()
        with RawClient(viewer.port) as tab:
            tab.look()
            viewer.show(guided)
            # Until nothing else is to be drawn either: the map is on the page.
            while place_of(MAP, came) < 0:
                came += tab.window(timeout=20)
        wait_until(lambda: is_searching(viewer))
        time.sleep(0.1)
        assert is_searching(viewer)
        now[0] += 1000
        wait_until(lambda: not is_searching(viewer))
    finally:
        viewer.close()


def test_the_picture_s_outline_comes_with_the_words_of_its_step(
    default_board: Board, paper_camera: Camera
) -> None:
    """It was that of the step before until the next frame came."""
    target = Pose.from_vector([20, 0, 30, 0.05, 0, 0.5])
    viewer = Viewer("127.0.0.1", free_port())
    show = partial(viewer.show_pose, default_board, paper_camera, target=target)
    try:
        with RawClient(viewer.port) as tab:
            tab.look()
            viewer.show_picture(np.zeros((720, 1280, 3), np.uint8))
            show(target.moved([0.1, 0, 0]))
            windows_until("Step 1 of 4", tab)
            with suppress(TimeoutError):
                while True:
                    tab.window(timeout=1)
            for pose, words in ((target.turned("z", -30), "Step 4 of 4"), (target, "Hold still")):
                show(pose)
                last = windows_until(words, tab)[-1]
                assert any("_data" in message.get("updates", {}) for message in last), words
    finally:
        viewer.close()


def windows_until(words: str, tab: RawClient) -> list[list[dict[str, Any]]]:
    """What a tab is sent together, until these words are."""
    windows: list[list[dict[str, Any]]] = []
    while not windows or place_of(words, windows[-1]) < 0:
        windows.append(tab.window(timeout=20))
    return windows


def shown(snapshot: Snapshot, projections: Projections | None, *wanted: str) -> list[Any]:
    """What a tab is sent after this snapshot alone, until all this is on the page."""
    viewer = Viewer("127.0.0.1", free_port(), projections=projections)
    came: list[dict[str, Any]] = []
    try:
        with RawClient(viewer.port) as tab, suppress(TimeoutError):
            tab.look()
            tab.backlog()
            viewer.show(snapshot)
            while min(place_of(text, came) for text in wanted) < 0:
                came += tab.window(timeout=10)
    finally:
        viewer.close()
    missing = [text for text in wanted if place_of(text, came) < 0]
    assert not missing
    return came


def board_in(came: list[dict[str, Any]]) -> int:
    """Place of the first message on the board that moves; -1 if none came."""
    places = (i for i, message in enumerate(came) if message.get("name") == "/board/live")
    return next(places, -1)


def is_searching(viewer: Viewer) -> bool:
    return any(name.startswith("/search") for name in viewer.scene_names)


def place_of(text: str, came: list[dict[str, Any]]) -> int:
    """Place of the first message that puts this on the page; -1 if none came."""
    for place, message in enumerate(came):
        if text in str(message.get("updates", {}).get("content", "")):
            return place
    return -1


def test_steps_side_by_side_leave_room_for_a_replayed_search_and_none_for_views(
    guided: Snapshot,
) -> None:
    """A search among them was seen from where they are seen, half of it outside the window."""
    viewer = Viewer("127.0.0.1", free_port())
    (known,) = viewer.layers
    switches = {command.label: command.do for command in known.commands}

    def shown_of(kinds: set[str]) -> set[str]:
        return {kind for kind in kinds if any(kind in name for name in viewer.scene_names)}

    def is_shown(*only: str) -> bool:
        return shown_of({"/strip/", "/views/", "/search/", "/frustum"}) == set(only)

    try:
        viewer.show(guided)
        switches[texts.TOGGLE_VIEWS]()
        wait_until(lambda: is_shown("/views/", "/frustum"))
        viewer.change(lambda state: replace(state, strip=True))
        wait_until(lambda: is_shown("/strip/"))
        switches[texts.REPLAY_SEARCH]()
        wait_until(lambda: is_shown("/search/", "/frustum"))
    finally:
        viewer.close()
