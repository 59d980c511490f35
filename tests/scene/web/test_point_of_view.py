"""What depends on the point of view: arrows in front of what hides them, labels that face it."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
import trimesh
import viser.transforms as tf

from tests.scene.raw_client import RawClient
from tests.waiting import wait_until
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.frustum import DEPTH, frustum
from venus3d.render.shapes import LabelShape, MeshShape
from venus3d.render.viewpoints import FLIGHT_SECONDS, SceneCamera
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer

PLACE = Pose.from_vector([20, 30, 40, 0.1, 0.05, 0.6])
ARROW = MeshShape("/steps/1/arrow", trimesh.creation.cone(0.02, 0.1), PLACE, on_top=True)
PLATE = MeshShape("/steps/1/after", trimesh.creation.box([0.2, 0.1, 0.01]), PLACE, opacity=0.4)
LABEL = LabelShape("/steps/1/label", "57 mm", np.array([0.1, 0.0, 0.6]), (200, 100, 150))
EYE = (-0.6, -0.5, -0.4)


def settled(view: SceneView) -> bool:
    view.refresh()
    return not view.is_due


def vertices_of(view: SceneView) -> Array:
    """(N, 3) where the browser puts the arrow's vertices."""
    handle = view.node(ARROW.name)
    turned = tf.SO3(handle.wxyz) @ np.asarray(ARROW.mesh.vertices, np.float64)
    return np.asarray(handle.scale * turned + handle.position)


def test_an_arrow_looks_the_same_and_is_nearer_until_another_tab_looks_from_elsewhere(
    server: LocalServer,
) -> None:
    view, port = SceneView(server), server.get_port()
    shapes = (ARROW, PLATE, LABEL)
    view.draw(shapes, dark=True)
    there = PLACE.apply(np.asarray(ARROW.mesh.vertices, np.float64))
    np.testing.assert_allclose(vertices_of(view), there, atol=1e-6)
    with RawClient(port) as one:
        one.look(position=EYE, look_at=(0.0, 0.0, 0.5))
        wait_until(lambda: server.get_clients() and settled(view))
        rays, before = vertices_of(view) - EYE, there - EYE
        shares = np.linalg.norm(rays, axis=1) / np.linalg.norm(before, axis=1)
        assert shares.max() < 0.5, "in front of the rest"
        np.testing.assert_allclose(rays, shares[:, None] * before, atol=1e-6)
        np.testing.assert_allclose(view.node(PLATE.name).position, PLACE.t)  # may be hidden
        with RawClient(port) as other:
            other.look(position=(0.5, -0.5, 1.0), look_at=(0.0, 0.0, 0.5))
            wait_until(lambda: len(server.get_clients()) == 2 and settled(view))
            np.testing.assert_allclose(vertices_of(view), there, atol=1e-6)


def test_an_arrow_is_before_the_camera_s_picture_also_where_that_is_near_the_eye(
    server: LocalServer, paper_camera: Camera
) -> None:
    """Seen from behind the camera, its picture hid the arrow but for a stub."""
    eye = (-0.02, -0.01, -0.1)
    view = SceneView(server)
    view.draw((ARROW, frustum(paper_camera)), dark=True)
    there = PLACE.apply(np.asarray(ARROW.mesh.vertices, np.float64))
    with RawClient(server.get_port()) as tab:
        tab.look(position=eye, look_at=(0.0, 0.0, 0.5))
        wait_until(lambda: server.get_clients() and settled(view))
        places = vertices_of(view)
        assert (places[:, 2] < DEPTH).all(), "on the eye's side of the picture"
        shares = np.linalg.norm(places - eye, axis=1) / np.linalg.norm(there - eye, axis=1)
        assert shares.min() > 0.25, "and behind the labels"


def test_nothing_is_drawn_for_an_eye_that_is_still_flying(server: LocalServer) -> None:
    """A slow browser shows a view long after it was sent: an arrow drawn nearer for the flight's
    end stood huge before the eye that was still on its way."""
    rig = CameraRig(server)
    view = SceneView(server, arrived=lambda: rig.arrived)
    there = PLACE.apply(np.asarray(ARROW.mesh.vertices, np.float64))
    view.draw((ARROW,), dark=True)

    def in_front() -> bool:
        view.refresh()
        if rig.is_due:
            rig.advance()
        return not np.allclose(vertices_of(view), there, atol=1e-6)

    def goes_to(eye: tuple[float, float, float]) -> None:
        rig.go(lambda _: SceneCamera(np.array(eye), np.array([0.0, 0.0, 0.5]), 0.7))

    goes_to(EYE)
    with RawClient(server.get_port()) as tab:
        tab.look(position=EYE, look_at=(0.0, 0.0, 0.5), fov=0.7)
        wait_until(lambda: rig.aspect != 1.0 and not in_front())
        tab.look(position=EYE, look_at=(0.0, 0.0, 0.5), fov=0.7)
        wait_until(in_front)
        goes_to((0.9, -0.7, 1.3))
        assert not in_front(), "not from the moment the flight is asked for"
        end = time.monotonic() + FLIGHT_SECONDS + 1.0
        while time.monotonic() < end:
            assert not in_front(), "nor when its last view was sent"
        tab.look(position=(0.9, -0.7, 1.3), look_at=(0.0, 0.0, 0.5), fov=0.7)
        wait_until(in_front)
        assert rescaled(tab) == set(), "a browser comes to a scale later than to a position"


def rescaled(tab: RawClient) -> set[str]:
    """Names of the shapes whose scale was changed in all that was sent to the tab."""
    names: set[str] = set()
    while True:
        try:
            window = tab.window(timeout=0.5)
        except TimeoutError:
            return names
        names |= {m["name"] for m in window if "scale" in m.get("updates", {})}


def test_a_label_faces_the_person_and_keeps_its_size(server: LocalServer) -> None:
    view = SceneView(server)
    view.draw((LABEL,), dark=True)
    with RawClient(server.get_port()) as tab:
        for eye in (EYE, (0.9, -0.7, 1.3)):
            tab.look(1280, 720, position=eye, look_at=(0.0, 0.0, 0.5), fov=0.7)
            wait_until(lambda eye=eye: _is_at(server, eye) and settled(view))
            pill = view.node(LABEL.name)._pill
            R = tf.SO3(pill.wxyz).as_matrix()
            ahead = np.array([0.0, 0.0, 0.5]) - eye
            np.testing.assert_allclose(R[:, 2], ahead / np.linalg.norm(ahead), atol=1e-6)
            assert R[1, 1] > 0, "upright, and not mirrored: right, down and ahead"
            depth = (np.asarray(pill.position) - eye) @ R[:, 2]
            assert pill.scale == 1, "a browser comes to it later than to the position"
            high = pill.render_height / depth * 360 / np.tan(0.35)
            assert 22 < high < 32, "pixels"


def _is_at(server: LocalServer, eye: tuple[float, float, float]) -> bool:
    clients = server.get_clients().values()
    return any(np.allclose(client.camera.position, eye) for client in clients)


def test_the_end_of_a_new_step_pulses_once(server: LocalServer) -> None:
    view = SceneView(server)
    view.draw((PLATE,), dark=True)
    plate, seen = view.node(PLATE.name), list[float]()

    def over() -> bool:
        view.refresh()
        seen.append(plate.opacity)
        return not view.is_due

    wait_until(over)
    assert max(seen) > 0.6 and plate.opacity == pytest.approx(0.4)
    view.draw((PLATE,), dark=True)
    assert not view.is_due, "the same step does not pulse again"


def test_an_amount_is_shown_when_it_has_stayed(server: LocalServer) -> None:
    """A picture comes later than the numbers beside it: in motion the label names the step."""
    view, moving = SceneView(server), replace(LABEL, in_motion="Tilt")
    view.draw((moving,), dark=True)
    with RawClient(server.get_port()) as tab:
        tab.look(1280, 720, position=EYE, look_at=(0.0, 0.0, 0.5), fov=0.7)
        wait_until(lambda: _is_at(server, EYE) and settled(view))
        label = view.node(LABEL.name)
        assert label._pill.visible and not label.is_changing
        before = label._pill.image
        view.draw((replace(moving, text="-85°"),), dark=True)
        assert label.is_changing and not label._pill.visible and label._word.visible
        wait_until(lambda: label._pill.image is not before or view.refresh())
        assert not label._pill.visible, "its picture is sent before it is shown"
        wait_until(lambda: label._pill.visible or view.refresh())
        assert not view.is_due and not label._word.visible


def test_an_arrow_that_comes_nearer_than_a_label_does_not_cover_it(server: LocalServer) -> None:
    """The arrow of a move towards the person covered the last letter of "Target"."""
    view = SceneView(server)
    near = replace(ARROW, pose=Pose(np.eye(3), np.array([0.0, 0.0, 0.3])))
    label = replace(LABEL, position=np.array([0.0, 0.0, 0.6]))
    eye = (0.0, -0.02, 0.0)
    view.draw((near, label), dark=True)
    with RawClient(server.get_port()) as tab:
        tab.look(position=eye, look_at=(0.0, 0.0, 0.5))
        wait_until(lambda: _is_at(server, eye) and settled(view))
        pill = view.node(label.name)._pill
        arrow = np.linalg.norm(vertices_of(view) - eye, axis=1)
        assert np.linalg.norm(pill.position - eye) < arrow.min()


def test_a_label_whose_amount_changes_loads_the_word_meanwhile(server: LocalServer) -> None:
    """A slow browser shows a node before its next picture: for a new target it showed the amount of
    the last one."""
    view, label = SceneView(server), replace(LABEL, in_motion="Move")
    view.draw((label,), dark=True)
    with RawClient(server.get_port()) as tab:
        tab.look(position=EYE, look_at=(0.0, 0.0, 0.5))
        wait_until(lambda: _is_at(server, EYE) and settled(view))
        pill = view.node(label.name)._pill
        last = pill.image.copy()
        view.draw((replace(label, text="89 mm"),), dark=True)
        assert not pill.visible and not _equal(pill.image, last), "not even behind the scenes"
        wait_until(lambda: settled(view))
        assert pill.visible and not _equal(pill.image, last)


def _equal(one: Array, other: Array) -> bool:
    return one.shape == other.shape and np.array_equal(one, other)
