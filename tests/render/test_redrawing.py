"""When what was drawn of the remaining steps is drawn again."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Any

import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.snapshot import Snapshot, pose_snapshot
from venus3d.render.projections import Pictures, Projections
from venus3d.render.redrawing import looks_alike, still_shows
from venus3d.scene.web.projections_panel import RemainingTiles

TARGET = Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])
START = Pose.from_vector([-20, 10, -25, -0.1, 0.05, 0.7])


@pytest.fixture
def at(paper_camera: Camera, default_board: Board):
    first = pose_snapshot(default_board, paper_camera, START, TARGET)

    def snapshot(pose: Pose | None) -> Snapshot:
        return pose_snapshot(default_board, paper_camera, pose, first.target, first)

    return snapshot


def test_pictures_stay_on_the_way_and_until_a_step_is_done(at) -> None:
    first = at(START)
    steps = first.remaining.steps
    for share in (0.1, 0.5, 0.9):
        assert still_shows(first.remaining, at(START.moved(share * steps[0].translation)).remaining)
    placed = at(steps[0].after)
    assert placed.remaining.done[0] and not still_shows(first.remaining, placed.remaining)
    half = at(steps[1].before.turned("x", steps[1].angle_deg / 2))
    assert still_shows(placed.remaining, half.remaining)


@pytest.mark.parametrize(
    ("off", "stays"),
    [
        (([0.02, 0.02, 0], 0), True),
        (([0.03, 0.03, 0], 0), False),
        (([0, 0, 0], 8), True),
        (([0, 0, 0], 12), False),
    ],
)
def test_a_board_that_left_the_way_has_other_pictures(at, off: Any, stays: bool) -> None:
    """Across the move, and about an axis that is not the first to turn."""
    first = at(START)
    metres, deg = off
    along = first.remaining.steps[0].translation
    across = np.cross(along, [0, 0, 1]) if np.any(metres) else np.zeros(3)
    across *= np.linalg.norm(metres) / max(float(np.linalg.norm(across)), 1e-9)
    pose = START.moved(0.3 * along + across).turned("y", -deg)
    assert still_shows(first.remaining, at(pose).remaining) == stays


def test_a_direction_that_turned_round_has_another_picture(at) -> None:
    """4° too far is near the way, but the arrow would point the wrong way."""
    before, beyond = (at(TARGET.turned("x", deg)) for deg in (-5, 4))
    assert before.remaining.done == beyond.remaining.done == (True, False, True, True)
    assert not still_shows(before.remaining, beyond.remaining)


def test_nothing_is_drawn_again_for_a_hand_that_trembles(at) -> None:
    first, trembling = at(START), at(START.turned("y", 0.5).moved([0.001, 0, 0.001]))
    assert looks_alike(first.remaining, trembling.remaining)
    assert not looks_alike(first.remaining, at(START.turned("y", 1)).remaining)
    assert not looks_alike(first.remaining, at(None).remaining)
    assert not looks_alike(first.remaining, None) and looks_alike(None, None)


class Slow(Projections):
    """Draws when it is told to."""

    def __init__(self) -> None:
        self.sets: list[tuple[Future[Any], ...]] = []

    def of(self, *args: Any, **how: Any) -> Pictures:
        futures = Future(), Future(), Future(), Future()
        self.sets.append(futures)
        return futures

    def finish(self, level: int) -> None:
        for future in self.sets[-1]:
            future.set_result(np.full((9, 16, 3), level, np.uint8))


def test_old_pictures_stay_and_one_set_at_a_time_is_drawn(at) -> None:
    slow = Slow()
    tiles = RemainingTiles(slow, lambda: None)
    tiles.order(at(START), dark=True)
    assert tiles.shown() == ("",) * 4
    slow.finish(50)
    first = tiles.shown()
    assert first is not None and all(first)
    for n in range(1, 6):  # a board that is waved about
        tiles.order(at(START.turned("y", 20 * n)), dark=True)
        assert tiles.shown() is first and len(slow.sets) == 2
    slow.finish(90)
    assert tiles.shown() != first
    tiles.order(at(START.turned("y", 100)), dark=True)
    assert len(slow.sets) == 3
    tiles.forget()
    assert tiles.shown() is None
    assert tiles.outdated(at(START).remaining) == (False,) * 4


def test_a_picture_that_shows_something_else_than_is_said_is_known(at) -> None:
    """Words and chips told of the next target beside the pictures of the last one."""
    slow = Slow()
    tiles = RemainingTiles(slow, lambda: None)
    before, beyond = (at(TARGET.turned("x", deg)) for deg in (-5, 4))
    tiles.order(before, dark=True)
    slow.finish(50)
    tiles.shown()
    assert tiles.outdated(before.remaining) == (False,) * 4
    tiles.order(beyond, dark=True)
    tiles.shown()
    # The arrow points the wrong way, and those of done steps are of no importance.
    assert tiles.outdated(beyond.remaining) == (False, True, False, False)
    assert tiles.outdated(at(None).remaining) == (True,) * 4
    undone = at(TARGET.turned("z", 20)).remaining
    assert not undone.done[3] and tiles.outdated(undone)[3], "it was done: there is no arrow"
    slow.finish(90)
    tiles.shown()
    assert tiles.outdated(beyond.remaining) == (False,) * 4
