"""The fold-out with other notations: which turn it shows, and that what is copied makes it."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.scene.pages.teach.notations_panel import notations_html
from venus3d.scene.pages.teach.state import TeachState, Vector
from venus3d.scene.pages.teach.view_model import PoseAnalysis

POSE: Vector = (20.0, -25.0, 15.0, 40.0, -20.0, 500.0)


@pytest.fixture(scope="module")
def analyse(paper_camera: Camera, default_board: Board) -> PoseAnalysis:
    return PoseAnalysis(paper_camera, default_board)


def copied(html: str) -> tuple[list[Array], list[Array]]:
    """What the buttons' lines make, executed: the rotations, then the poses."""
    rotations: list[Array] = []
    poses: list[Array] = []
    for line in re.findall(r"data-copy='([^']*)'", html):
        made: dict[str, Array] = {}
        exec(unescape(line), made)
        (poses if "T" in made else rotations).append(made["T" if "T" in made else "R"])
    return rotations, poses


def numbers_of(html: str, name: str) -> list[float]:
    shown = re.search(rf"<b>{re.escape(name)}</b>.*?<pre>(.*?)</pre>", html, re.S)
    assert shown is not None, name
    return [float(number) for number in shown[1].split()]


def test_at_the_pose_it_is_the_turn_of_the_pose(analyse: PoseAnalysis) -> None:
    html = notations_html(analyse(POSE), TeachState(vector=POSE))
    turn = Rotation.from_euler("xyz", POSE[:3], degrees=True)
    rotations, poses = copied(html)
    assert len(rotations) == 6 and len(poses) == 3
    for R in rotations:
        np.testing.assert_allclose(R, turn.as_matrix(), atol=1e-9)
    np.testing.assert_allclose(poses[0][:3, :3], turn.as_matrix(), atol=1e-9)
    for T, place in zip(poses, ([40, -20, 500], [40, 20, -500], [500, -40, 20]), strict=True):
        np.testing.assert_allclose(T[:3, 3], np.array(place) / 1000, atol=1e-12)
    assert f"{np.degrees(turn.magnitude()):.1f}°" in html
    np.testing.assert_allclose(numbers_of(html, "Rotation vector"), turn.as_rotvec(), atol=6e-5)
    np.testing.assert_allclose(numbers_of(html, "Quaternion x y z w"), turn.as_quat(), atol=6e-5)
    assert numbers_of(html, "Euler angles, fixed axes x y z (°)") == list(POSE[:3])
    assert "-0.0000" not in html and "-0.00<" not in html


@pytest.mark.parametrize("step, axis", [(2, "x"), (3, "y"), (4, "z")])
def test_on_the_way_it_is_the_turn_of_the_step(step: int, axis: str, analyse: PoseAnalysis) -> None:
    state = replace(TeachState(vector=POSE), progress=step - 0.4)
    html = notations_html(analyse(POSE), state)
    angle = POSE[step - 2]
    wanted = Rotation.from_euler(axis, angle, degrees=True).as_matrix()
    rotations, poses = copied(html)
    for R in rotations:
        np.testing.assert_allclose(R, wanted, atol=1e-9)
    done = [value if number <= step else 0 for number, value in enumerate(POSE[:3], start=2)]
    after = Rotation.from_euler("xyz", done, degrees=True).as_matrix()
    np.testing.assert_allclose(poses[0][:3, :3], after, atol=1e-9)
    assert f"{angle:+.1f}° about {axis.upper()}".replace("-", "−") in html


def test_a_move_turns_nothing_and_the_lock_is_told(analyse: PoseAnalysis) -> None:
    moving = replace(TeachState(vector=POSE), progress=0.5)
    for R in copied(notations_html(analyse(POSE), moving))[0]:
        np.testing.assert_array_equal(R, np.eye(3))
    assert "Gimbal lock" not in notations_html(analyse(POSE), TeachState())
    locked: Vector = (30.0, 90.0, -20.0, 0.0, 0.0, 500.0)
    html = notations_html(analyse(locked), TeachState(vector=locked))
    assert "Gimbal lock" in html
    wanted = Rotation.from_euler("xyz", locked[:3], degrees=True).as_matrix()
    for R in copied(html)[0]:
        np.testing.assert_allclose(R, wanted, atol=2e-7)
