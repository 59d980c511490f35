"""Both renderers against the camera model: where corners are, what hides what."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.board_mesh import board_ghost, board_outline, board_shape
from venus3d.render.offscreen import Offscreen
from venus3d.render.shapes import LabelShape, Shape

GREY = (90, 100, 110)


def seen_poses(camera: Camera, board: Board, count: int, seed: int) -> Iterator[Pose]:
    rng = np.random.default_rng(seed)
    while count:
        vector = [*rng.uniform(-35, 35, 3), *rng.uniform(-0.15, 0.15, 2), rng.uniform(0.3, 0.7)]
        pose = Pose.from_vector(vector)
        pixels = camera.project(pose.apply(board.corners))
        if ((pixels > 15) & (pixels < np.array(camera.image_size) - 15)).all():
            count -= 1
            yield pose


def corners_in(
    picture: np.ndarray, camera: Camera, board: Board, pose: Pose
) -> tuple[np.ndarray, np.ndarray]:
    """Corners found by OpenCV, (N, 2), and the true ones.

    The window follows the narrowest extent of the squares around a corner, so that no marker
    comes into it.
    """
    grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
    found, ids, *_ = cv2.aruco.CharucoDetector(board.cv_board).detectBoard(grey)
    corners = np.asarray(found, dtype=np.float32).reshape(-1, 2)
    truth = camera.project(pose.apply(board.corners))
    grid = truth.reshape(board.rows - 1, board.columns - 1, 2)
    right, down = np.gradient(grid, axis=1), np.gradient(grid, axis=0)
    area = np.abs(right[..., 0] * down[..., 1] - right[..., 1] * down[..., 0])
    longest = np.maximum(np.linalg.norm(right, axis=-1), np.linalg.norm(down, axis=-1))
    ids = np.asarray(ids).ravel()
    for corner, extent in zip(corners, (area / longest).ravel()[ids], strict=True):
        half = max(2, int(0.12 * extent))
        corner[:] = cv2.cornerSubPix(
            grey, corner.reshape(1, 1, 2).copy(), (half, half), (-1, -1), (3, 40, 1e-4)
        ).ravel()
    return corners.astype(np.float64), truth[ids]


@pytest.mark.slow
@pytest.mark.parametrize("supersample", [1, 2])
def test_corners_are_where_the_camera_projects_them(
    renderer: Offscreen, paper_camera: Camera, default_board: Board, supersample: int
) -> None:
    errors: list[np.ndarray] = []
    for pose in seen_poses(paper_camera, default_board, 12, seed=3):
        picture = renderer.render(
            paper_camera,
            [board_shape(default_board, pose)],
            background=GREY,
            supersample=supersample,
        )
        found, truth = corners_in(picture, paper_camera, default_board, pose)
        errors.append(found - truth)
    error = np.concatenate(errors)
    assert len(error) > 0.95 * 12 * default_board.corner_count
    assert np.sqrt((error**2).mean(axis=0)).max() < 0.05
    assert np.abs(error.mean(axis=0)).max() < 0.02


def test_both_renderers_put_the_corners_at_the_same_place(
    gl: Offscreen, painter: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    pose = Pose.from_vector([15, -20, 10, 0.03, 0.02, 0.42])
    shapes = [board_shape(default_board, pose)]
    a, b = (
        corners_in(
            r.render(paper_camera, shapes, background=GREY), paper_camera, default_board, pose
        )
        for r in (gl, painter)
    )
    assert len(a[0]) == len(b[0]) == default_board.corner_count
    assert np.linalg.norm(a[0] - b[0], axis=1).max() < 0.1


def test_a_moving_board_uploads_nothing_again(
    gl: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    gl.render(paper_camera, [board_shape(default_board, Pose.from_vector([0, 0, 0, 0, 0, 0.5]))])
    nodes = gl._renderer._nodes  # type: ignore[attr-defined]
    before = dict(nodes)
    for angle in (10, 20, 30):
        pose = Pose.from_vector([angle, 0, 0, 0, 0, 0.5])
        gl.render(paper_camera, [board_shape(default_board, pose)])
    assert dict(nodes) == before


def test_the_nearer_one_of_two_boards_hides_the_other(
    renderer: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    red = board_ghost(default_board, Pose.from_vector([0, 0, 0, 0, 0, 0.6]), "/a", (255, 0, 0), 1)
    # Tilted through the red one: its upper half is in front, its lower half behind.
    green = board_ghost(
        default_board, Pose.from_vector([30, 0, 0, 0, 0, 0.6]), "/b", (0, 255, 0), 1
    )
    picture = renderer.render(paper_camera, [green, red], background=(0, 0, 0))
    u, v = paper_camera.project([[0, -0.04, 0.6], [0, 0.04, 0.6]]).round().astype(int).T
    np.testing.assert_array_equal(picture[v, u], [(0, 255, 0), (255, 0, 0)])
    on_top = renderer.render(paper_camera, [green, replace(red, on_top=True)], background=(0, 0, 0))
    np.testing.assert_array_equal(on_top[v, u], [(255, 0, 0), (255, 0, 0)])


def test_translucent_things_mix_with_what_is_behind(
    renderer: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    ghost = board_ghost(
        default_board, Pose.from_vector([0, 0, 0, 0, 0, 0.5]), "/a", (255, 0, 0), 0.5
    )
    ground = np.full((720, 1280, 3), (0, 100, 200), dtype=np.uint8)
    for background in ((0, 100, 200), ground):
        picture = renderer.render(paper_camera, [ghost], background=background)
        np.testing.assert_allclose(picture[355, 635], (128, 50, 100), atol=2)
        np.testing.assert_allclose(picture[5, 5], (0, 100, 200), atol=1)


def test_an_outline_runs_through_the_projected_corners(
    renderer: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    pose = Pose.from_vector([20, -30, 10, 0.1, 0.05, 0.6])
    line = board_outline(default_board, pose, "/a", (255, 255, 255), 3.0)
    picture = renderer.render(paper_camera, [line])
    outline = default_board.outline
    middles = (outline + np.roll(outline, -1, axis=0)) / 2
    u, v = paper_camera.project(pose.apply(np.vstack([outline, middles]))).round().astype(int).T
    assert (picture[v, u] > 200).all()
    assert (picture[..., 0] > 0).mean() < 0.02


def test_size_labels_and_board_behind_the_camera(
    renderer: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    shapes = [
        board_shape(default_board, Pose.from_vector([0, 0, 0, 0, 0, -0.5])),
        LabelShape("/t", "+30°", np.array([0.0, 0.0, 0.5]), (255, 255, 255)),
        LabelShape("/u", "unseen", np.array([0.0, 0.0, -0.5]), (255, 255, 255)),
    ]
    picture = renderer.render(paper_camera, shapes, size=(480, 270), supersample=2)
    assert picture.shape == (270, 480, 3)
    rows, columns = np.nonzero(picture[..., 0] > 128)
    np.testing.assert_allclose([columns.mean(), rows.mean()], [238, 133], atol=4)


def test_a_machine_without_opengl_gets_the_painter_and_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(_: bool) -> None:
        raise ImportError("no EGL")

    monkeypatch.setattr("venus3d.render.offscreen._open_gl", missing)
    with Offscreen() as offscreen:
        assert offscreen.backend == "painter"
        for package in ("libegl1", "libgl1", "libgl1-mesa-dri"):
            assert re.search(rf"\b{package}[ ,]", offscreen.note)
    with pytest.raises(RuntimeError, match="no EGL"):
        Offscreen("gl")


@pytest.mark.usefixtures("gl")
def test_opengl_looks_for_no_screen() -> None:
    # A window's pyglet needs libraries of X that a machine without a screen does not have.
    assert "pyglet.window" in sys.modules
    assert "pyglet.gl.xlib" not in sys.modules


def test_closing_twice_and_a_second_renderer_that_lives_on(
    gl: Offscreen, paper_camera: Camera, default_board: Board
) -> None:
    other = Offscreen("gl")
    shapes = [board_shape(default_board, Pose.from_vector([0, 0, 0, 0, 0, 0.5]))]
    one = other.render(paper_camera, shapes)
    other.close()
    other.close()
    np.testing.assert_array_equal(gl.render(paper_camera, shapes), one)


def lose_the_context(offscreen: Offscreen, _: pytest.MonkeyPatch) -> None:
    from OpenGL import EGL

    platform: Any = offscreen._renderer._platform  # type: ignore[attr-defined]
    display, context = platform._egl_display, platform._egl_context
    # A context that is in use would live on until it is left.
    nothing = (EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, EGL.EGL_NO_CONTEXT)
    offscreen._thread.submit(EGL.eglMakeCurrent, display, *nothing).result()
    offscreen._thread.submit(EGL.eglDestroyContext, display, context).result()


def let_the_second_reading_fail(_: Offscreen, monkeypatch: pytest.MonkeyPatch) -> None:
    """As a driver fails: after one half of a picture, with an error of OpenGL's own."""
    from OpenGL import GL

    read, done = GL.glReadPixels, list[Any]()

    def reading(*arguments: Any) -> Any:
        if done:
            GL.glEnable(0xDEAD)
        done.append(read(*arguments))
        return done[-1]

    monkeypatch.setattr(GL, "glReadPixels", reading)


def run_out_of_memory(offscreen: Offscreen, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any) -> None:
        raise MemoryError

    monkeypatch.setattr(offscreen._renderer._renderer, "render", full)  # type: ignore[attr-defined]


BREAKING = [
    (lose_the_context, "err = 12294"),  # EGL_BAD_CONTEXT
    (let_the_second_reading_fail, "err = 1280"),  # GL_INVALID_ENUM
    (run_out_of_memory, "MemoryError"),
]
Break = Callable[[Offscreen, pytest.MonkeyPatch], None]


@pytest.fixture
def scene(default_board: Board) -> list[Shape]:
    pose = Pose.from_vector([20, -30, 10, 0.1, 0.05, 0.6])
    return [
        board_shape(default_board, pose),
        board_outline(default_board, pose, "/a", (255, 255, 255), 3.0),
        LabelShape("/t", "+30°", np.array([0.0, 0.0, 0.5]), (255, 255, 255)),
    ]


@pytest.mark.usefixtures("gl")
@pytest.mark.parametrize(("breaks", "cause"), BREAKING)
def test_where_opengl_fails_in_mid_session_the_painter_goes_on(
    painter: Offscreen,
    paper_camera: Camera,
    scene: list[Shape],
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    breaks: Break,
    cause: str,
) -> None:
    # A picture behind: two halves are drawn, and both have to come from the same hand.
    behind = np.full((720, 1280, 3), GREY, dtype=np.uint8)
    with Offscreen() as offscreen:
        for _ in range(2):
            drawn = offscreen.render(paper_camera, scene, background=behind)
        assert offscreen.backend == "gl" and not offscreen.note
        breaks(offscreen, monkeypatch)
        pictures = [offscreen.render(paper_camera, scene, background=behind) for _ in range(2)]
        assert offscreen.backend == "painter"
        assert cause in offscreen.note and len(offscreen.note.splitlines()) == 1
    painted = painter.render(paper_camera, scene, background=behind)
    assert (painted != drawn).any()
    np.testing.assert_array_equal(pictures, [painted, painted])
    assert caplog.messages == [offscreen.note]


@pytest.mark.usefixtures("gl")
def test_shapes_that_nobody_can_draw_are_no_fault_of_opengl(
    paper_camera: Camera, default_board: Board, scene: list[Shape]
) -> None:
    ghost = board_ghost(default_board, Pose.from_vector([0, 0, 0, 0, 0, 0.5]), "/a", (9, 9, 9), 1)
    with Offscreen() as offscreen:
        drawn = offscreen.render(paper_camera, scene)
        with pytest.raises(AttributeError):
            offscreen.render(paper_camera, [*scene, replace(ghost, textured=True)])
        assert offscreen.backend == "gl" and not offscreen.note
        np.testing.assert_array_equal(offscreen.render(paper_camera, scene), drawn)


@pytest.mark.usefixtures("gl")
def test_who_asks_for_opengl_alone_is_told_of_its_failures(
    paper_camera: Camera, scene: list[Shape], monkeypatch: pytest.MonkeyPatch
) -> None:
    with Offscreen("gl") as offscreen, monkeypatch.context() as broken:
        run_out_of_memory(offscreen, broken)
        with pytest.raises(MemoryError):
            offscreen.render(paper_camera, scene)
        assert offscreen.backend == "gl" and not offscreen.note


@pytest.mark.usefixtures("gl")
def test_a_lost_context_is_closed_without_fuss(monkeypatch: pytest.MonkeyPatch) -> None:
    offscreen, alone = Offscreen(), Offscreen("gl")
    for one in (offscreen, alone):
        lose_the_context(one, monkeypatch)
    offscreen.close()
    offscreen.close()
    with pytest.raises(Exception, match="err = 12294"):
        alone.close()
    for one in (offscreen, alone):
        with pytest.raises(RuntimeError, match="shutdown"):
            one.submit(Camera(64, 64, 50, 50, 32, 32), [])
