"""The measuring page without a browser: clicks become lengths, and what is drawn is where it was
clicked."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from html import unescape

import numpy as np
import pytest

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.calibration.measurement import MeasuringCamera
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.shapes import LabelShape, LineShape
from venus3d.scene.pages.measure import texts
from venus3d.scene.pages.measure.options import MeasureOptions
from venus3d.scene.pages.measure.page import MeasurePage
from venus3d.scene.pages.measure.shapes import measure_shapes
from venus3d.scene.pages.measure.state import MeasureState

BOARD = Board()
POSE = Pose.from_vector([25, -15, 10, 0.03, 0.01, 0.5])
OTHER = Pose.from_vector([-20, 10, -30, 0.0, 0.02, 0.6])


def seen(pose: Pose = POSE) -> Observation:
    corners = PAPER_CAMERA.project(pose.apply(BOARD.corners))
    return Observation(np.arange(len(corners)), corners, PAPER_CAMERA.image_size)


def ray(corner: int, pose: Pose = POSE) -> Array:
    """From the lens to one of the board's corners, of any length."""
    return 3.7 * pose.apply(BOARD.corners[corner : corner + 1])[0]


@pytest.fixture
def page() -> Iterator[MeasurePage]:
    with closing(
        MeasurePage("127.0.0.1", free_port(), MeasuringCamera(PAPER_CAMERA), BOARD)
    ) as served:
        yield served


def test_two_clicks_are_a_length_even_if_the_board_moves_in_between(page: MeasurePage) -> None:
    page.click(ray(0), 1.0)
    assert not page.state.points, "no picture yet"
    page.show(seen())
    page.click(ray(0), 1.0)
    page.show(seen(OTHER))
    page.click(ray(39, OTHER), 1.0)
    measured = page.state.measured
    assert measured is not None
    true = float(np.linalg.norm(BOARD.corners[39] - BOARD.corners[0]))
    assert measured.length_m == pytest.approx(true, abs=1e-6)
    assert 1e-5 < measured.sigma_m < 2e-3
    page.click(ray(3, OTHER), 1.0)
    assert len(page.state.points) == 1 and page.state.measured is None, "a third click begins anew"


def test_a_coarser_screen_measures_less_surely(page: MeasurePage) -> None:
    page.show(seen())
    sigmas: list[float] = []
    for px_of_screen in (1.0, 4.0):
        page.clear()
        for corner in (0, 7):
            page.click(ray(corner), px_of_screen)
        assert page.state.measured is not None
        sigmas.append(page.state.measured.sigma_m)
    assert sigmas[1] == pytest.approx(4 * sigmas[0], rel=0.1), "the click is most of it"


def test_a_click_beside_the_plane_is_told_and_changes_nothing(page: MeasurePage) -> None:
    page.show(seen(Pose.from_vector([60, 0, 0, 0, 0.1, 0.5])))
    for away in ([0.0, -5.0, 1.0], [0.0, 0.0, -1.0], [np.nan, 0.0, 1.0], [0.0, 0.0, 0.0]):
        page.click(np.array(away), 1.0)
    assert not page.state.points
    assert page._remark == texts.MISSED  # pyright: ignore[reportPrivateUsage]


def test_a_board_that_the_camera_cannot_see_so_is_told() -> None:
    """Lengths were measured, or the board was asked for while it was there."""
    bent = replace(PAPER_CAMERA, coefficients=(-5.0, 20.0, 0.0, 0.0, 0.0))
    beside = replace(PAPER_CAMERA, cx=1e6)
    for camera in (bent, beside, PAPER_CAMERA):
        by = MeasuringCamera(camera)
        with closing(MeasurePage("127.0.0.1", free_port(), by, BOARD)) as page:
            told: list[bool] = []
            for _ in range(6):
                page.show(seen())
                told.append(page.is_wrong)
            assert told == [False] * 4 + [camera != PAPER_CAMERA] * 2
            text = page._text  # pyright: ignore[reportPrivateUsage]
            expected = texts.FIRST if camera == PAPER_CAMERA else "not as this camera would see it"
            wait_until(lambda text=text, expected=expected: expected in unescape(text.content))
            page.measure_by(MeasuringCamera(PAPER_CAMERA), BOARD)
            assert not page.is_wrong


def test_a_held_picture_is_asked_for_once_each_time(page: MeasurePage) -> None:
    asked: list[bool] = []
    page.on_hold = asked.append
    page.hold()
    page.hold()
    assert asked == [True, False]


def test_the_ruler_lies_between_the_points_with_a_tick_each_centimetre() -> None:
    state = MeasureState(points=((-0.05, 0.01), (0.055, 0.01)))
    shapes = {shape.name: shape for shape in measure_shapes(state, POSE, "105 mm")}
    ruler = shapes["/measure/ruler"]
    assert isinstance(ruler, LineShape)
    line, ticks = ruler.segments[0], ruler.segments[1:]
    np.testing.assert_allclose(line[:, 0], [-0.05, 0.055])
    np.testing.assert_allclose(ticks[:, 0, 0], -0.05 + 0.01 * np.arange(11), atol=1e-12)
    label = shapes["/measure/label"]
    assert isinstance(label, LabelShape) and label.text == "105 mm"
    np.testing.assert_allclose(label.position, POSE.apply(np.array([[0.0025, 0.01, 0.0]]))[0])


def test_the_cube_stands_on_the_side_that_is_seen() -> None:
    state = MeasureState(tool="cube", points=((0.01, 0.02),), edge_m=0.04)
    shapes = {shape.name: shape for shape in measure_shapes(state, POSE, "")}
    cube = shapes["/measure/cube"]
    assert isinstance(cube, LineShape) and cube.segments.shape == (12, 2, 3)
    np.testing.assert_allclose(
        np.linalg.norm(cube.segments[:, 1] - cube.segments[:, 0], axis=1), 0.04
    )
    ends = cube.segments.reshape(-1, 3)
    np.testing.assert_allclose(
        [ends.min(axis=0), ends.max(axis=0)], [[0.01, 0.02, -0.04], [0.05, 0.06, 0]]
    )
    assert POSE.apply(ends)[:, 2].min() < POSE.apply(np.array([[0.01, 0.02, 0]]))[0, 2]


def test_a_cube_is_not_said_to_have_an_uncertainty(page: MeasurePage) -> None:
    def note() -> str:
        return page._note.content  # pyright: ignore[reportPrivateUsage]

    wait_until(lambda: "±" in note() and "percent" not in note())
    page.change(lambda state: state.with_tool("cube"))
    wait_until(lambda: "A cube has no ±" in note())


def test_nothing_is_drawn_without_a_board_or_points() -> None:
    assert measure_shapes(MeasureState(points=((0, 0),)), None, "") == ()
    assert measure_shapes(MeasureState(), POSE, "") == ()


def test_another_tool_begins_without_points() -> None:
    state = MeasureState().clicked((0, 0)).with_tool("cube")
    assert not state.points and state.clicked((0, 0)).clicked((0.1, 0)).points == ((0.1, 0),)


def test_a_real_source_needs_a_calibration() -> None:
    with pytest.raises(VenusError, match="--camera FILE"):
        MeasureOptions("0").check()
    MeasureOptions().check()
