"""The pictures of the steps: made once, kept, and saying what they must."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, step_colour
from venus3d.render.projections import KEPT, Projections


class Counting(Offscreen):
    """Counts what it is asked for."""

    asked = 0

    def submit(self, *args, **kwargs):  # type: ignore[no-untyped-def]
        self.asked += 1
        return super().submit(*args, **kwargs)


def steps_to(vector: list[float], camera: Camera, board: Board) -> Steps:
    return decompose(Pose.from_vector(vector), camera, board)


def test_pictures_are_made_once_for_steps_and_a_camera(
    paper_camera: Camera, default_board: Board
) -> None:
    steps = steps_to([20, -30, 15, 0.06, -0.03, 0.55], paper_camera, default_board)
    with Counting("painter") as offscreen:
        projections = Projections(offscreen)
        assert offscreen.asked == 0
        first = projections.of(steps, paper_camera, default_board, size=(240, 135))
        assert first == projections.of(steps, paper_camera, default_board, size=(240, 135))
        assert offscreen.asked == 4
        other = replace(paper_camera, fx=1070.0)
        assert first != projections.of(steps, other, default_board, size=(240, 135))
        assert offscreen.asked == 8
        for i in range(KEPT):
            vector = [float(i), 0, 0, 0, 0, 0.5]
            fresh = steps_to(vector, paper_camera, default_board)
            projections.of(fresh, paper_camera, default_board, size=(48, 27))
        assert first != projections.of(steps, paper_camera, default_board, size=(240, 135))
        assert {f.result().shape for f in first} == {(170, 240, 3)}


def test_each_picture_carries_its_steps_colour_and_board(
    gl: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    steps = steps_to([20, -30, 15, 0.06, -0.03, 0.55], paper_camera, default_board)
    for dark in (True, False):
        pictures = Projections(gl).of(steps, paper_camera, default_board, dark=dark)
        for number, future in enumerate(pictures, start=1):
            picture = future.result()
            np.testing.assert_array_equal(picture[2, 2], step_colour(number, dark))
            lit = np.abs(picture[75:].astype(int) - step_colour(number, dark)).sum(axis=2) < 90
            assert lit.sum() > 300  # frame, arrow, number


def test_a_picture_says_when_the_board_leaves_the_image(
    gl: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    inside = steps_to([0, 0, 10, 0, 0, 0.5], paper_camera, default_board)
    outside = steps_to([0, 0, 10, 0.35, 0, 0.5], paper_camera, default_board)
    warning = np.array(ground(True).warning)

    def warned(steps: Steps) -> bool:
        picture = Projections(gl).of_step(steps[0], paper_camera, default_board).result()
        return bool((np.abs(picture.astype(int) - warning).sum(axis=2) < 6).sum() > 500)

    assert not warned(inside)
    assert warned(outside)


def test_a_done_step_has_no_arrow_and_letters_can_be_left_out(
    gl: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    """A picture without a number stays true while the amount beside it falls."""
    step = steps_to([20, -30, 15, 0.06, -0.03, 0.55], paper_camera, default_board)[1]

    def coloured(**how: bool) -> int:
        picture = Projections(gl).of_step(step, paper_camera, default_board, header=False, **how)
        far = np.abs(picture.result().astype(int) - step_colour(2, True)).sum(axis=2)
        return int((far < 90).sum())

    whole, bare, done = coloured(), coloured(letters=False), coloured(done=True)
    assert whole > bare + 20 and bare > 300 and done == 0
