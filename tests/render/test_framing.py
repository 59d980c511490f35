"""The view of a guided calibration: large, whole, no board edge-on, no arrow as a dot.

The places in the window and the angles are worked out here again, with OpenCV's projection and from
the poses themselves.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.snapshot import Snapshot, pose_snapshot
from venus3d.engine.planning.limits import Limits
from venus3d.render.describe import SceneOptions, describe
from venus3d.render.framing import best_direction, content_of, good_direction
from venus3d.render.shapes import FrustumShape, LabelShape, LineShape, MeshShape, Shape
from venus3d.render.step_shapes import pose_during
from venus3d.render.viewpoints import OUTSIDE, SceneCamera, view_along
from venus3d.scene.web.steady_framing import SteadyFraming

FAR_AWAY = Pose(np.eye(3), np.array([40.0, 40.0, 40.0]))


def in_window(view: SceneCamera, points: Array, aspect: float) -> Array:
    """(N, 2) places in the window, -1 ... 1 to the right and down; OpenCV's projection."""
    ahead = (view.look_at - view.position) / np.linalg.norm(view.look_at - view.position)
    right = np.cross([0.0, 1.0, 0.0], ahead)
    right = right / np.linalg.norm(right)
    R = np.stack([right, np.cross(ahead, right), ahead])
    f = 1 / np.tan(view.fov_rad / 2)
    K = np.array([[f / aspect, 0, 0], [0, f, 0], [0, 0, 1.0]])
    pixels, _ = cv2.projectPoints(points, cv2.Rodrigues(R)[0], -R @ view.position, K, None)
    return np.asarray(pixels, np.float64).reshape(-1, 2)


def every_point(shapes: tuple[Shape, ...], camera: Camera) -> Array:
    """(N, 3) all vertices of what is drawn, and the frustum's corners; not floor and figure."""
    points: list[Array] = [np.zeros((1, 3))]
    for shape in shapes:
        if shape.name.startswith(("/ground/", "/figure/")):
            continue
        if isinstance(shape, FrustumShape):
            w, h = camera.width / camera.fx / 2, camera.height / camera.fy / 2
            points.append(0.14 * np.array([[x, y, 1] for x in (-w, w) for y in (-h, h)]))
        elif isinstance(shape, LabelShape):
            points.append(shape.position[None])
        elif isinstance(shape, MeshShape):
            points.append(shape.pose.apply(np.asarray(shape.mesh.vertices, np.float64)))
        elif isinstance(shape, LineShape):
            points.append(shape.pose.apply(shape.segments.reshape(-1, 3)))
    return np.concatenate(points)


class OneTab:
    """A rig with one tab that flies in no time."""

    def __init__(self, aspect: float) -> None:
        self.aspect, self.views = aspect, 0
        self.view: SceneCamera | None = None

    def go(self, framing: Any, *, at_once: bool = False) -> None:
        self.view = framing(self.aspect)
        self.views += 1

    refit = go

    @property
    def eyes(self) -> Array:
        assert self.view is not None
        return self.view.position[None]

    def cuts_off(self, points: Array) -> bool:
        assert self.view is not None
        return bool(np.abs(in_window(self.view, points, self.aspect)).max() > 0.97)


@pytest.fixture(scope="module")
def moments(
    paper_camera: Camera, default_board: Board
) -> list[tuple[Snapshot, tuple[Shape, ...], Array]]:
    """200 moments of a session, what is drawn in each, and its points: 40 targets, and the board on
    its way to each, step by step."""
    camera, board, rng = paper_camera, default_board, np.random.default_rng(20200720)
    limits, poses = Limits.for_board(board, camera), []
    low, high = [-60, -60, -90, -0.3, -0.2, 0.2], [60, 60, 90, 0.3, 0.2, 1.0]
    while len(poses) < 41:
        vectors = rng.uniform(low, high, (400, 6))
        accepted = vectors[limits.accepts(camera, board, vectors)]
        poses += [Pose.from_vector(vector) for vector in accepted[:3]]
    seen: list[tuple[Snapshot, tuple[Shape, ...], Array]] = []
    for start, target in pairwise(poses[:41]):
        steps = decompose(target, camera, board, start)
        for way in np.sort(rng.uniform(0, 4, 5)):
            pose = pose_during(steps[int(way)], float(way % 1))
            snapshot = pose_snapshot(board, camera, pose, target)
            assert snapshot.match is not None
            shapes = describe(snapshot, SceneOptions(step=snapshot.match.active_step))
            seen.append((snapshot, shapes, every_point(shapes, camera)))
    return seen


@pytest.mark.parametrize("aspect", [0.61, 0.85, 1.22])
def test_200_moments_of_a_session_are_large_whole_and_never_edge_on(
    aspect: float,
    moments: list[tuple[Snapshot, tuple[Shape, ...], Array]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The three windows: 1280 x 720, 1920 x 1080 between their panels, and a phone."""
    monkeypatch.setattr("venus3d.scene.web.steady_framing._REST_S", 0.0)  # they come at once here
    rig = OneTab(aspect)
    framing: Any = SteadyFraming(rig)  # pyright: ignore[reportArgumentType]
    spans, boards, arrows = [], [], []
    for snapshot, shapes, points in moments:
        assert snapshot.target is not None and snapshot.pose is not None
        assert snapshot.remaining is not None
        content = content_of(shapes, snapshot.remaining.steps)
        framing.look(content, snapshot.target.pose.vector().tobytes())
        assert rig.view is not None
        places = in_window(rig.view, points, aspect)
        assert np.abs(places).max() < 1, "cut off"
        spans.append(np.ptp(places, axis=0).max() / 2)
        for pose in (snapshot.pose, snapshot.target.pose):
            sight = (pose.t - rig.view.position) / np.linalg.norm(pose.t - rig.view.position)
            boards.append(np.degrees(np.arcsin(sight @ pose.R[:, 2])))
        for shape in shapes:
            if isinstance(shape, MeshShape) and shape.name == "/steps/1/arrow":
                along, at = shape.pose.R[:, 2], shape.pose.t
                sight = (at - rig.view.position) / np.linalg.norm(at - rig.view.position)
                arrows.append(np.degrees(np.arccos(abs(along @ sight))))
        axes = rig.view.axes
        assert axes[0, 0] > 0.2 and axes[1, 1] > 0.2, "right is right, and down is down"
    assert len(spans) == 200
    assert np.median(spans) >= 0.7
    assert np.mean(np.abs(boards) >= 20) >= 0.98
    assert np.mean(np.array(boards) > 0) >= 0.99, "the printed side is seen"
    assert np.mean(np.array(arrows) >= 20) >= 0.97
    assert rig.views < 60, "a view that is good stays"


def test_the_view_is_good_for_the_whole_way_to_the_target(
    paper_camera: Camera, default_board: Board
) -> None:
    """It was fitted to the board as it was held at the beginning: a board that had to be tilted and
    swung was seen from behind, or edge-on, for half of its way."""
    camera, board = paper_camera, default_board
    held = Pose.from_vector([35, -35, 20, 0.02, 0.0, 0.3])
    for vector in ([-38, 35, 20, 0, 0, 0.3], [40, 40, -20, 0, 0, 0.35], [-40, -40, 10, 0, 0, 0.3]):
        target = Pose.from_vector(vector)
        steps = decompose(target, camera, board, held)
        at_first = pose_snapshot(board, camera, held, target)
        content = content_of(describe(at_first, SceneOptions()), steps)
        forward = best_direction(content, 0.95)
        eye = view_along(forward, content.points, 0.95).position
        for pose in (pose_during(s, share) for s in steps for share in np.linspace(0, 1, 9)):
            sight = (pose.t - eye) / np.linalg.norm(pose.t - eye)
            assert np.degrees(np.arcsin(sight @ pose.R[:, 2])) > 20
        held = target


def test_a_board_that_is_held_edge_on_is_flown_around_but_not_one_that_passes(
    paper_camera: Camera, default_board: Board, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A person need not go the way that is told."""
    camera, board, now = paper_camera, default_board, [100.0]
    monkeypatch.setattr("venus3d.scene.web.steady_framing.time.monotonic", lambda: now[0])
    target, rig = Pose.from_vector([0, 0, 0, 0, 0, 0.5]), OneTab(0.95)
    framing: Any = SteadyFraming(rig)  # pyright: ignore[reportArgumentType]

    def held(turn: float, seconds: float) -> int:
        """Number of flights while the board is held there."""
        before, end = rig.views, now[0] + seconds
        snapshot = pose_snapshot(board, camera, target.turned("y", turn), target)
        # A step that is done: none of its arrows can ask for another view.
        shapes = [s for s in describe(snapshot, SceneOptions()) if not s.name.startswith("/steps")]
        while now[0] < end:
            framing.look(content_of(shapes), "target")
            now[0] += 0.04
        return rig.views - before

    held(0, 3)
    assert rig.view is not None
    to_eye = rig.view.position - target.t
    edge_on = float(np.degrees(np.arctan2(to_eye[0], -to_eye[2])))
    turn = -(90 + edge_on) if edge_on < 0 else 90 - edge_on
    assert held(turn, 0.8) == 0 and held(0, 2) == 0, "it only passes"
    assert held(turn, 1.5) == 1
    sight = (target.t - rig.view.position) / np.linalg.norm(target.t - rig.view.position)
    assert np.degrees(np.arcsin(sight @ target.turned("y", turn).R[:, 2])) > 20
    assert held(turn, 20) == 0


def test_a_good_view_stays_and_a_bad_one_does_not(
    paper_camera: Camera, default_board: Board
) -> None:
    def direction(tilt: float, present: Array | None = None) -> Array:
        target = Pose.from_vector([0, tilt, 0, 0, 0, 0.5])
        shapes = describe(
            pose_snapshot(default_board, paper_camera, target, target), SceneOptions()
        )
        return best_direction(content_of(shapes), 0.85, present)

    first = direction(0)
    assert direction(3, first) is not None
    np.testing.assert_array_equal(direction(3, first), first)
    # A board that lies along this direction would be seen edge-on.
    edge_on = np.degrees(np.arctan2(first[0], first[2])) + 90
    for tilt in (edge_on, edge_on - 180):
        if abs(tilt) < 60:
            assert direction(tilt, first) @ first < np.cos(np.radians(20))


def test_the_view_from_outside_changes_only_where_a_board_is_edge_on(
    paper_camera: Camera, default_board: Board
) -> None:
    """The lessons speak of one view from outside; there a board that swings was seen edge-on."""
    turned = 0
    for swing in range(-60, 61, 10):
        pose = Pose.from_vector([-20, swing, 0, 0, 0, 0.5])
        shapes = describe(pose_snapshot(default_board, paper_camera, pose, pose), SceneOptions())
        forward = good_direction(content_of(shapes), 0.85, OUTSIDE)
        eye = view_along(forward, content_of(shapes).points, 0.85).position
        usual = view_along(OUTSIDE, content_of(shapes).points, 0.85).position
        seen, seen_usually = (
            np.degrees(np.arcsin(abs((pose.t - e) @ pose.R[:, 2]) / np.linalg.norm(pose.t - e)))
            for e in (eye, usual)
        )
        assert seen >= 25
        assert np.array_equal(forward, OUTSIDE) == (seen_usually >= 25), swing
        turned += not np.array_equal(forward, OUTSIDE)
    assert 2 <= turned <= 8


def test_what_is_only_background_does_not_count(paper_camera: Camera, default_board: Board) -> None:
    pose = Pose.from_vector([20, 10, 0, 0, 0, 0.4])
    shapes = describe(pose_snapshot(default_board, paper_camera, pose, pose), SceneOptions())
    board = next(shape for shape in shapes if shape.name == "/board/live")
    assert isinstance(board, MeshShape)
    floor = replace(board, name="/room/floor", pose=FAR_AWAY)
    with_floor, without = (content_of(s).points for s in ((*shapes, floor), shapes))
    np.testing.assert_array_equal(with_floor, without)
