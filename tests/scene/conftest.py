"""Renderers for the scene's tests."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.scene.guided import guided_session
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.render.offscreen import Offscreen


@pytest.fixture(scope="session")
def gl() -> Iterator[Offscreen]:
    """The OpenGL renderer; tests that need it are skipped where OpenGL cannot be had."""
    offscreen = Offscreen()
    if offscreen.backend != "gl":
        offscreen.close()
        pytest.skip(offscreen.note)
    yield offscreen
    offscreen.close()


@pytest.fixture(scope="session")
def painter() -> Iterator[Offscreen]:
    """The OpenCV painter."""
    with Offscreen("painter") as offscreen:
        yield offscreen


@pytest.fixture(params=["gl", "painter"])
def renderer(request: pytest.FixtureRequest) -> Offscreen:
    """Either of the two."""
    offscreen: Offscreen = request.getfixturevalue(request.param)
    return offscreen


@pytest.fixture(scope="session")
def guided(paper_camera: Camera, default_board: Board) -> Snapshot:
    """The same, with our own search."""
    return guided_session(paper_camera, default_board, Settings())
