"""Measuring in a real browser: a click on a corner of the board in the picture is that corner."""

from __future__ import annotations

import re
from contextlib import closing
from typing import Any

import numpy as np
import pytest

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.calibration.measurement import MeasuringCamera
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.board_mesh import board_shape
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.measure import texts
from venus3d.scene.pages.measure.page import MeasurePage

pytestmark = [pytest.mark.browser, pytest.mark.slow]
POSE = Pose.from_vector([25, -15, 10, 0.03, 0.01, 0.5])
FROM, TO = 1, 38


def test_two_clicks_in_the_picture_are_a_length(
    chromium: Any, paper_camera: Camera, default_board: Board
) -> None:
    with Offscreen("painter") as offscreen:
        rgb = offscreen.render(paper_camera, (board_shape(default_board, POSE),))
    corners = paper_camera.project(POSE.apply(default_board.corners))
    ids = np.arange(default_board.corner_count)
    frame = np.ascontiguousarray(rgb[..., ::-1])
    seen = Observation(ids, corners, paper_camera.image_size, image=frame)
    by = MeasuringCamera(paper_camera)
    with closing(MeasurePage("127.0.0.1", free_port(), by, default_board)) as page:
        page.show(seen)
        tab = chromium.new_page(viewport={"width": 1280, "height": 720})
        tab.set_default_timeout(60_000)
        tab.goto(page.url)
        tab.wait_for_selector(f".v-measure:has-text('{texts.FIRST[:20]}')")
        wait_until(lambda: page.server.get_clients())
        camera = next(iter(page.server.get_clients().values())).camera
        tab.wait_for_function("!!document.querySelector('canvas')")
        wait_until(lambda: np.abs(camera.position).max() < 1e-3, "the tab is in the lens")
        box = tab.locator("canvas").first.bounding_box()

        def click(corner: int) -> None:
            """Where a pinhole of the browser's field of view, in the lens's place, shows it."""
            x, y, z = POSE.apply(default_board.corners)[corner]
            f = box["height"] / 2 / np.tan(camera.fov / 2)
            middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            tab.mouse.click(middle[0] + f * x / z, middle[1] + f * y / z)

        def measured() -> tuple[float, float]:
            click(FROM)
            wait_until(lambda: len(page.state.points) == 1, "the first point")
            tab.wait_for_selector(f".v-measure:has-text('{texts.SECOND}')")
            click(TO)
            tab.wait_for_selector(".v-measured")
            told = re.fullmatch(r"([\d.]+) ± ([\d.]+) mm", tab.inner_text(".v-measured"))
            assert told is not None
            length, sigma = (float(figure) for figure in told.groups())
            return length, sigma

        ends = default_board.corners[[FROM, TO]]
        true = 1000 * float(np.linalg.norm(ends[1] - ends[0]))
        length, sigma = measured()
        if abs(length - true) > 3 * sigma:
            # A slow browser was clicked before it had the view that the clicks are computed for.
            page.clear()
            tab.wait_for_selector(".v-measured", state="detached")
            length, sigma = measured()
        assert 0 < sigma < 2 and abs(length - true) < 3 * sigma, (length, sigma, true)
        tab.keyboard.press("Backspace")
        tab.wait_for_selector(".v-measured", state="detached")
        tab.close()
