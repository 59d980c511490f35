"""The four tiles: a picture never stands beside the words of another target."""

from __future__ import annotations

from concurrent.futures import Future

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.scene.web.projections_panel import Picture, Tiles, encoded


def finish(futures: tuple[Future[Picture], ...], grey: int) -> str:
    picture = np.full((9, 16, 3), grey, np.uint8)
    for future in futures:
        future.set_result(picture)
    return encoded(picture)


def test_pictures_and_words_of_a_target_come_together(
    paper_camera: Camera, default_board: Board
) -> None:
    def steps_to(*vector: float) -> Steps:
        return decompose(Pose.from_vector(vector), paper_camera, default_board)

    tiles = Tiles()
    assert tiles.shown() is None
    first, second = steps_to(20, 0, 0, 0, 0, 0.5), steps_to(0, 30, 10, 0.1, 0, 0.6)
    one, two = ((Future(), Future(), Future(), Future()) for _ in range(2))

    tiles.expect("first", first, one)
    waiting = tiles.shown()
    assert waiting is not None and (waiting.steps, waiting.sources) == (first, ("",) * 4)
    tiles.expect("given up", second, two)
    waiting = tiles.shown()
    assert waiting is not None and waiting.steps is second, "no picture keeps the first one's words"
    tiles.expect("first", first, one)
    light = finish(one, 200)
    drawn = tiles.shown()
    assert drawn is not None and (drawn.steps, drawn.sources) == (first, (light,) * 4)

    tiles.expect("second", second, two)
    assert tiles.shown() is drawn, "the old ones, with their own words"
    for future in two[:3]:
        future.set_result(np.zeros((9, 16, 3), np.uint8))
    assert tiles.shown() is drawn, "one is missing"
    two[3].set_result(np.zeros((9, 16, 3), np.uint8))
    now = tiles.shown()
    assert now is not None and now.steps is second

    tiles.forget()
    assert tiles.shown() is None
