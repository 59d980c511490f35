"""The four tiles: the old pictures stay until all four new ones are drawn."""

from __future__ import annotations

from concurrent.futures import Future

import numpy as np

from venus3d.scene.web.projections_panel import Picture, Tiles, encoded


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
