"""The four tiles: the old pictures stay until all four new ones are drawn."""

from __future__ import annotations

from concurrent.futures import Future

import numpy as np

from tests.ports import free_port
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.engine.guidance.remaining import RemainingStep, RemainingSteps
from venus3d.scene.web.projections_panel import Picture, ProjectionsPanel, Tiles, encoded
from venus3d.scene.web.server import start_server
from venus3d.scene.web.theme import Theme


def finish(futures: tuple[Future[Picture], ...], grey: int) -> str:
    picture = np.full((9, 16, 3), grey, np.uint8)
    for future in futures:
        future.set_result(picture)
    return encoded(picture)


def test_pictures_of_a_target_come_together() -> None:
    tiles = Tiles()
    assert tiles.shown() is None
    one, two, given_up = ((Future(), Future(), Future(), Future()) for _ in range(3))

    tiles.expect("first", one)
    assert tiles.shown() == ("",) * 4 and tiles.is_waiting
    tiles.expect("given up", given_up)
    assert tiles.shown() == ("",) * 4
    tiles.expect("first", one)
    light = finish(one, 200)
    drawn = tiles.shown()
    assert drawn == (light,) * 4 and not tiles.is_waiting

    tiles.expect("second", two)
    assert tiles.shown() == drawn, "the old ones"
    finish(two[:3], 0)
    assert tiles.shown() == drawn, "one is missing"
    dark = finish(two[3:], 0)
    assert tiles.shown() == (dark,) * 4

    tiles.forget()
    assert tiles.shown() is None


def test_a_tile_warns_of_corners_outside_in_letters_of_the_page(
    paper_camera: Camera, default_board: Board
) -> None:
    """In the picture, a third as large as it is drawn, they were 8 px high."""
    # The move takes a part of the board out of the image, and the swing brings it back.
    steps = decompose(
        Pose.from_vector([0, -60, 0, 0.15, 0, 0.4]), camera=paper_camera, board=default_board
    )
    outside = [len(step.corners_outside) for step in steps]
    assert outside[0] > 1 and outside[3] == 0
    one, two, three, four = (RemainingStep(step, False, step_prompt(step)) for step in steps)
    server, _ = start_server("127.0.0.1", free_port())
    panel = ProjectionsPanel(server.gui)

    def shown(first: RemainingStep) -> list[str]:
        remaining = RemainingSteps((first, two, three, four), 1, None)
        panel.show(remaining, ("a", "b", "c", "d"), 1, Theme(True))
        return panel._tiles.content.split("<div class='v-tile")[1:]

    tiles = shown(one)
    for tile, count in zip(tiles, outside, strict=True):
        assert (f"{count} corners outside" in tile) == (count > 1)
        assert ("v-warning" in tile) == (count > 0)
    first = shown(RemainingStep(one.step, True, one.prompt))[0]
    assert "v-warning" not in first and first.startswith(" v-done"), "it is done"
    assert not any(tile.startswith(" v-done") for tile in tiles)
    server.stop()
