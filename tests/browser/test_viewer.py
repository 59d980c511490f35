"""The viewer without a browser: addresses, what one moment puts into the scene, the picture."""

from __future__ import annotations

import socket

import cv2
import numpy as np
import pytest

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import annotate, small_picture
from venus3d.scene.pages.guide.state import SECONDS_PER_STEP, ViewState
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.server import AddressError, start_server


def test_taken_port_is_told_and_the_next_one_used() -> None:
    """viser takes another port in silence; whoever reads the address must be told."""
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = holder.getsockname()[1]
        server, note = start_server("127.0.0.1", port)
        try:
            assert server.get_port() > port
            assert str(port) in note and str(server.get_port()) in note
            assert server.request_share_url() is None
        finally:
            server.stop()


@pytest.mark.parametrize("host", ["203.0.113.7", "no.such.host.invalid"])
def test_address_that_cannot_be_bound_is_one_sentence(host: str) -> None:
    """viser's constructor would wait for ever."""
    with pytest.raises(AddressError, match=r"127\.0\.0\.1"):
        start_server(host, free_port())


def test_port_that_is_none_is_one_sentence() -> None:
    with pytest.raises(AddressError, match="70000"):
        start_server("127.0.0.1", 70000)


def test_newest_snapshot_wins_and_any_thread_may_show(guiding: Snapshot, viewer: Viewer) -> None:
    for _ in range(200):
        viewer.show(guiding)
    wait_until(lambda: "/steps/3/arrow" in viewer.scene_names)


def test_animation_walks_the_four_steps_and_starts_again(guiding: Snapshot) -> None:
    state = ViewState().seeing(guiding).play(True)
    seen: list[int] = []
    for _ in range(round(5 * SECONDS_PER_STEP / 0.1) + 2):
        state = state.later(0.1).seeing(guiding)
        assert 0 <= state.sweep < 1
        if not seen or seen[-1] != state.step:
            seen.append(state.step)
    assert seen[:5] == [1, 2, 3, 4, 1]
    assert state.play(False).seeing(guiding).step == 3


def test_a_new_target_is_followed_again(guiding: Snapshot) -> None:
    by_hand = ViewState().turned_to(2)
    assert by_hand.step == 2 and not by_hand.follow
    followed = by_hand.seeing(guiding)
    assert followed.follow and followed.step == 3
    assert followed.turned_to(1).seeing(guiding).step == 1


def test_outline_is_drawn_where_opencv_projects_the_board(
    guiding: Snapshot, paper_camera: Camera
) -> None:
    """The thick outline of the picture goes through the board's corners as cv2 projects them."""
    assert guiding.match is not None
    frame = np.zeros((720, 1280, 3), np.uint8)
    picture = small_picture(frame)
    assert picture.shape == (360, 640, 3)
    colour = (10, 200, 30)
    nothing = Observation.nothing((1280, 720))
    annotate(picture, guiding, nothing, 3, colour)
    pose: Pose = guiding.match.steps[2].after
    camera = guiding.camera
    pixels, _ = cv2.projectPoints(
        guiding.board.outline, pose.rvec, pose.t, camera.K, camera.distortion
    )
    for u, v in (pixels.reshape(-1, 2) + 0.5) / 2 - 0.5:
        if 3 < u < 636 and 3 < v < 356:
            near = picture[round(v) - 2 : round(v) + 3, round(u) - 2 : round(u) + 3].reshape(-1, 3)
            assert (np.abs(near.astype(int) - colour).max(axis=1) < 30).any()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_grey_pictures_of_any_depth_are_shown(dtype: type) -> None:
    grey = np.full((480, 500), np.iinfo(dtype).max // 2, dtype)
    grey[-1, -1] = np.iinfo(dtype).max
    rgb = small_picture(grey)
    assert rgb.shape == (480, 500, 3) and rgb.dtype == np.uint8
    assert abs(int(rgb[0, 0, 0]) - 127) <= 1
