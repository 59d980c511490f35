"""The pictures of the steps: made once, kept, and saying what they must."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.target import Target
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import ground, step_colour
from venus3d.render.projections import KEPT_TARGETS, Projections


class Counting(Offscreen):
    """Counts what it is asked for."""

    asked = 0

    def submit(self, *args, **kwargs):  # type: ignore[no-untyped-def]
        self.asked += 1
        return super().submit(*args, **kwargs)


def target_of(vector: list[float], camera: Camera, board: Board) -> Target:
    pose = Pose.from_vector(vector)
    return cast(Target, SimpleTarget(pose=pose, steps=decompose(pose, camera, board)))


class SimpleTarget(SimpleNamespace):
    __hash__ = object.__hash__


def test_pictures_are_made_once_for_a_target_and_camera(
    paper_camera: Camera, default_board: Board
) -> None:
    target = target_of([20, -30, 15, 0.06, -0.03, 0.55], paper_camera, default_board)
    with Counting("painter") as offscreen:
        projections = Projections(offscreen)
        assert offscreen.asked == 0
        first = projections.of(target, paper_camera, default_board, size=(240, 135))
        assert first == projections.of(target, paper_camera, default_board, size=(240, 135))
        assert offscreen.asked == 4
        other = replace(paper_camera, fx=1070.0)
        assert first != projections.of(target, other, default_board, size=(240, 135))
        assert offscreen.asked == 8
        for i in range(KEPT_TARGETS):
            vector = [float(i), 0, 0, 0, 0, 0.5]
            fresh = target_of(vector, paper_camera, default_board)
            projections.of(fresh, paper_camera, default_board, size=(48, 27))
        assert first != projections.of(target, paper_camera, default_board, size=(240, 135))
        assert {f.result().shape for f in first} == {(170, 240, 3)}


def test_each_picture_carries_its_steps_colour_and_board(
    gl: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    target = target_of([20, -30, 15, 0.06, -0.03, 0.55], paper_camera, default_board)
    for dark in (True, False):
        pictures = Projections(gl).of(target, paper_camera, default_board, dark=dark)
        for number, future in enumerate(pictures, start=1):
            picture = future.result()
            np.testing.assert_array_equal(picture[2, 2], step_colour(number, dark))
            lit = np.abs(picture[75:].astype(int) - step_colour(number, dark)).sum(axis=2) < 90
            assert lit.sum() > 300  # frame, arrow, number


def test_a_picture_says_when_the_board_leaves_the_image(
    gl: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    inside = target_of([0, 0, 10, 0, 0, 0.5], paper_camera, default_board)
    outside = target_of([0, 0, 10, 0.35, 0, 0.5], paper_camera, default_board)
    warning = np.array(ground(True).warning)

    def warned(target: Target) -> bool:
        picture = Projections(gl).of_step(target.steps[0], paper_camera, default_board).result()
        return bool((np.abs(picture.astype(int) - warning).sum(axis=2) < 6).sum() > 500)

    assert not warned(inside)
    assert warned(outside)
