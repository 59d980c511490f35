"""The description of a moment: the arrows say what the poses do, and names are stable."""

from __future__ import annotations

from itertools import combinations, product
from typing import Any

import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot, pose_snapshot
from venus3d.languages import PageLanguage
from venus3d.render.describe import SceneOptions, describe, describe_step
from venus3d.render.frustum import DEPTH, border_segments, frustum
from venus3d.render.redrawing import looks_alike
from venus3d.render.shapes import FrustumShape, LabelShape, LineShape, MeshShape, Shape
from venus3d.render.step_shapes import instruction_shapes, protractor
from venus3d.render.strip import strip_shapes
from venus3d.sources.sim_cameras import SIM_CAMERAS, SimCamera

TARGETS = {
    "moderate": [20, -30, 15, 0.06, -0.03, 0.55],
    "extreme": [50, 20, -40, -0.05, 0.03, 0.5],
    "corner": [-15, 30, 70, 0.22, 0.12, 0.8],
    "small": [3, -4, 2, 0.0, 0.0, 0.32],
    "one turn": [0, 45, 0, 0.0, 0.0, 0.5],
}


LIVE = Pose.from_vector([9, -9, 7, 0, 0, 0.6])


def moment(
    vector: Any, camera: Camera, board: Board, live: Pose | None = LIVE
) -> tuple[Snapshot, RemainingSteps]:
    """A board at `live` that is guided to the pose of this vector."""
    snapshot = pose_snapshot(board, camera, live, Pose.from_vector(vector))
    assert snapshot.remaining is not None
    return snapshot, snapshot.remaining


def points_of(shape: Shape) -> np.ndarray:
    if isinstance(shape, MeshShape):
        return shape.pose.apply(shape.mesh.vertices)
    if isinstance(shape, LineShape):
        return shape.pose.apply(shape.segments.reshape(-1, 3))
    assert isinstance(shape, LabelShape)
    return shape.position[None]


@pytest.mark.parametrize("name", TARGETS)
@pytest.mark.parametrize("strip", [False, True])
@pytest.mark.parametrize("step", [1, 2, 3, 4])
def test_names_are_unique_and_none_lies_under_another(
    name: str, strip: bool, step: int, paper_camera: Camera, default_board: Board
) -> None:
    snapshot, _ = moment(TARGETS[name], paper_camera, default_board)
    names = [s.name for s in describe(snapshot, SceneOptions(step=step, strip=strip))]
    assert len(set(names)) == len(names)
    # A viewer's tree would move the inner one along with the outer one.
    assert not [(a, b) for a, b in combinations(sorted(names), 2) if b.startswith(f"{a}/")]
    if not strip:
        assert {"/camera/frustum", "/camera/border", "/board/live", "/target/board"} <= set(names)


@pytest.mark.parametrize("name", TARGETS)
def test_sector_and_arrow_show_the_turn_itself(
    name: str, paper_camera: Camera, default_board: Board
) -> None:
    snapshot, remaining = moment(TARGETS[name], paper_camera, default_board)
    for step, done in zip(remaining.steps[1:], remaining.done[1:], strict=True):
        shapes = {s.name: s for s in describe(snapshot, SceneOptions(step=step.number))}
        prefix = f"/steps/{step.number}"
        if done:
            assert f"{prefix}/arrow" not in shapes and f"{prefix}/label" not in shapes
            continue
        sector, arrow = shapes[f"{prefix}/sector"], shapes[f"{prefix}/arrow"]
        assert isinstance(sector, MeshShape)
        assert isinstance(arrow, MeshShape)
        rim = points_of(sector)[1:] - points_of(sector)[0]
        turn = step.after.R @ step.before.R.T
        # The sheet starts at a radius that the turn itself carries to its end.
        np.testing.assert_allclose(turn @ rim[0], rim[-1], atol=1e-4)
        # The arrow's tip is where the sheet ends, its tail is not ahead of the start.
        end = points_of(sector)[-1]
        assert np.linalg.norm(points_of(arrow) - end, axis=1).min() < 1e-4
        label = shapes[f"{prefix}/label"]
        assert isinstance(label, LabelShape)
        assert label.text == f"{step.angle_deg:+.0f}°".replace("-", "−")


def test_a_tilt_starts_at_the_edge_that_the_words_name(
    paper_camera: Camera, default_board: Board
) -> None:
    for vector, number, edge in (
        ([30, 0, 0, 0, 0, 0.5], 2, [0, -1, 0]),
        ([-30, 0, 0, 0, 0, 0.5], 2, [0, 1, 0]),
        ([0, 30, 0, 0, 0, 0.5], 3, [1, 0, 0]),
        ([0, -30, 0, 0, 0, 0.5], 3, [-1, 0, 0]),
    ):
        snapshot, _ = moment(vector, paper_camera, default_board, live=None)
        shapes = {s.name: s for s in describe(snapshot, SceneOptions(step=number))}
        rim = points_of(shapes[f"/steps/{number}/sector"])
        start, end = rim[1] - rim[0], rim[-1] - rim[0]
        np.testing.assert_allclose(start / np.linalg.norm(start), edge, atol=1e-6)
        assert end[2] < -0.01  # towards the camera


def test_the_move_arrow_joins_the_two_centres(paper_camera: Camera, default_board: Board) -> None:
    snapshot, remaining = moment(TARGETS["moderate"], paper_camera, default_board)
    shapes = {s.name: s for s in describe(snapshot, SceneOptions(step=1))}
    points = points_of(shapes["/steps/1/arrow"])
    np.testing.assert_array_equal(remaining.steps[0].before.t, LIVE.t)
    for centre in (LIVE.t, remaining.steps[0].after.t):
        assert np.linalg.norm(points - centre, axis=1).min() < 2e-4


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_the_sweep_runs_from_before_to_after(
    number: int, paper_camera: Camera, default_board: Board
) -> None:
    snapshot, remaining = moment(TARGETS["corner"], paper_camera, default_board)
    step = remaining.steps[number - 1]
    for sweep, pose in ((0.0, step.before), (1.0, step.after)):
        shapes = {s.name: s for s in describe(snapshot, SceneOptions(step=number, sweep=sweep))}
        board = shapes[f"/steps/{number}/after"]
        assert isinstance(board, MeshShape)
        np.testing.assert_allclose(board.pose.matrix, pose.matrix, atol=1e-9)


def test_equal_moments_give_the_very_same_meshes(
    paper_camera: Camera, default_board: Board
) -> None:
    snapshot, _ = moment(TARGETS["moderate"], paper_camera, default_board)
    for options in (SceneOptions(step=3), SceneOptions(strip=True)):
        a, b = describe(snapshot, options), describe(snapshot, options)
        assert all(x.mesh is y.mesh for x, y in zip(a, b, strict=True) if isinstance(x, MeshShape))


@pytest.mark.parametrize("name", TARGETS)
def test_the_strip_keeps_its_steps_apart(
    name: str, paper_camera: Camera, default_board: Board
) -> None:
    snapshot, _ = moment(TARGETS[name], paper_camera, default_board)
    shapes = describe(snapshot, SceneOptions(strip=True))
    boxes = []
    for number in (1, 2, 3, 4):
        cell = [s for s in shapes if s.name.startswith(f"/strip/{number}/")]
        assert any(s.name.endswith("/caption") for s in cell)
        points = np.vstack([points_of(s) for s in cell])
        boxes.append((points[:, :2].min(axis=0), points[:, :2].max(axis=0)))
    for (_, end), (start, _) in ((boxes[0], boxes[1]), (boxes[2], boxes[3])):
        assert end[0] < start[0], "one and two above, three and four below"
    assert max(boxes[0][1][1], boxes[1][1][1]) < min(boxes[2][0][1], boxes[3][0][1])


@pytest.mark.parametrize("name", TARGETS)
def test_the_strip_seen_from_above_keeps_its_rows_apart(
    name: str, paper_camera: Camera, default_board: Board
) -> None:
    """The lower row hid under the upper one, and captions lay over each other."""
    _, remaining = moment(TARGETS[name], paper_camera, default_board)
    shapes = strip_shapes(
        default_board, remaining.steps, dark=True, active=1, sweep=1.0, from_above=True
    )
    depths = []
    for number in (1, 2, 3, 4):
        cell = [s for s in shapes if s.name.startswith(f"/strip/{number}/")]
        points = np.vstack([points_of(s) for s in cell])
        depths.append((points[:, 2].min(), points[:, 2].max()))
    assert max(depths[2][1], depths[3][1]) < min(depths[0][0], depths[1][0])


@pytest.mark.parametrize("name", TARGETS)
def test_an_arc_that_fits_into_the_picture_is_in_it(
    name: str, paper_camera: Camera, default_board: Board
) -> None:
    for step in decompose(Pose.from_vector(TARGETS[name]), paper_camera, default_board)[1:]:
        for shape in describe_step(default_board, paper_camera, step):
            if shape.name.endswith("/arrow"):
                pixels = paper_camera.project(points_of(shape))
                inside = (pixels > 0) & (pixels < paper_camera.image_size)
                assert inside.all(axis=1).mean() > 0.9


@pytest.mark.filterwarnings("error")
def test_a_board_on_edge_has_its_arrows_too(paper_camera: Camera, default_board: Board) -> None:
    """One of the board's edges lies on the axis of the turn: the arc began there, with a radius of
    nothing, and the page stopped."""
    for x, y, z in product((-90, 0, 90), (-90, 90), (0, -25.49, 90)):
        live = Pose.from_vector([x, y, z, -0.301, 0.048, 0.843])
        _, remaining = moment(TARGETS["moderate"], paper_camera, default_board, live)
        for step in remaining.steps[1:]:
            place = protractor(default_board, paper_camera, step)
            assert place.radius > 0.25 * default_board.height
            for shape in instruction_shapes(default_board, paper_camera, step, dark=True):
                assert np.isfinite(points_of(shape)).all()


@pytest.mark.parametrize("name", ["action", "fisheye"])
def test_a_wide_lens_has_its_border_on_a_dome(name: SimCamera, default_board: Board) -> None:
    camera = SIM_CAMERAS[name]
    border = border_segments(camera).reshape(-1, 3)
    np.testing.assert_allclose(np.linalg.norm(border, axis=1), DEPTH, rtol=1e-9)
    pixels = camera.project(border)
    from_edge = np.abs(pixels + 0.5 - np.array(camera.image_size) * (pixels > 300)).min(axis=1)
    assert from_edge.max() < 0.01, "each point is seen on the picture's edge"
    assert (border[:, 2].min() < 0) == (name == "fisheye"), "it sees behind itself"
    picture = frustum(camera)
    depth = picture.scale / np.cbrt(np.tan(picture.fov_y_rad / 2) ** 2 * picture.aspect / 3)
    assert depth * np.hypot(1, np.tan(picture.fov_y_rad / 2) * picture.aspect) < DEPTH


def test_frustum_and_border_agree_for_a_perfect_lens(default_board: Board) -> None:
    camera = Camera(640, 480, 500, 510, 319.5, 239.5)
    snapshot = pose_snapshot(default_board, camera, None)
    shapes = {s.name: s for s in describe(snapshot, SceneOptions())}
    assert "/board/live" not in shapes
    frustum = shapes["/camera/frustum"]
    assert isinstance(frustum, FrustumShape)
    # viser: the frustum's picture stands at scale / cbrt(tan(fov/2)^2 aspect / 3).
    half = np.tan(frustum.fov_y_rad / 2)
    depth = frustum.scale / np.cbrt(half**2 * frustum.aspect / 3)
    border = points_of(shapes["/camera/border"])
    np.testing.assert_allclose(border[:, 2], depth)
    np.testing.assert_allclose(border[:, 1].max(), half * depth)
    np.testing.assert_allclose(border[:, 0].max(), half * frustum.aspect * depth)


def test_what_has_not_changed_is_the_same_object(
    paper_camera: Camera, default_board: Board
) -> None:
    """Renderers skip it by identity; drawing everything anew cost 14 ms a frame instead of 3. A
    board that trembles moves no arrow, but its amounts are told as they are."""
    snapshot, drawn = moment(TARGETS["moderate"], paper_camera, default_board)
    first = {s.name: s for s in describe(snapshot, SceneOptions(step=2))}
    for live, expected in (
        (LIVE, {"/board/live"}),
        (LIVE.turned("x", 0.6), {"/board/live", "/steps/2/label"}),
    ):
        later = pose_snapshot(default_board, paper_camera, live, snapshot.target)
        assert looks_alike(drawn, later.remaining)
        second = {s.name: s for s in describe(later, SceneOptions(step=2), drawn)}
        other = {name for name in first if first[name] is not second[name]}
        # Figure and drop line go along, and none is sent again.
        along = {name for name in other if name.startswith(("/figure/", "/ground/", "/board/back"))}
        for one, two in ((first[name], second[name]) for name in along):
            if isinstance(one, LineShape):
                assert isinstance(two, LineShape) and one.segments is two.segments
            else:
                assert isinstance(one, MeshShape) and isinstance(two, MeshShape)
                assert one.mesh is two.mesh
        assert other - along == expected
    other = {s.name: s for s in describe(snapshot, SceneOptions(step=3))}
    assert "/steps/3/arrow" in other and "/steps/2/arrow" not in other


def test_two_pages_of_one_program_each_speak_their_language(
    paper_camera: Camera, default_board: Board
) -> None:
    """What is kept of the scene was kept in the language of the page that asked first."""
    snapshot, steps = moment(TARGETS["moderate"], paper_camera, default_board)
    for strip, expected in (
        (False, {"en": "Target", "de": "Ziel"}),
        (True, {"en": "Move", "de": "Bewegen"}),
    ):
        for code, word in expected.items():
            with PageLanguage(code).spoken():
                shapes = describe(snapshot, SceneOptions(strip=strip), steps)
            texts = [shape.text for shape in shapes if isinstance(shape, LabelShape)]
            assert any(word in text for text in texts), (code, texts)
