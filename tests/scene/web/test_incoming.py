"""What is heard of a browser, message by message: all that a person can do, and nothing else."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
import pytest
import viser
from hypothesis import given
from hypothesis import strategies as st
from viser import _messages as messages

from tests.ports import free_port
from tests.scene.raw_client import AHEAD, RawClient, instance
from tests.scene.teach_server import served_teaching
from tests.waiting import wait_until
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.exercise.practice import PracticeSettings
from venus3d.scene.pages.exercise.run import PracticeServer, trial_server
from venus3d.scene.pages.exercise.trial import Trial
from venus3d.scene.pages.exercise.trial_pictures import TrialPictures
from venus3d.scene.pages.exercise.trial_plan import plan_of
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.incoming import is_heard
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.scene.web.viser_private import widget_of
from venus3d.storage.exercise import ExerciseFile


def nobody(_: str) -> None:
    """A page without widgets."""


def heard(server: viser.ViserServer, **content: Any) -> bool:
    return is_heard(msgspec.msgpack.encode(content), partial(widget_of, server.gui))


def set_value(server: viser.ViserServer, widget: Any, **updates: Any) -> bool:
    uuid = widget._impl.uuid
    return heard(server, type="GuiUpdateMessage", uuid=uuid, updates=updates)


WIDGETS: dict[str, tuple[Callable[[viser.GuiApi], Any], list[Any], list[Any]]] = {
    "button": (lambda gui: gui.add_button("b"), [True], [False, 1, "x", None]),
    "checkbox": (lambda gui: gui.add_checkbox("c", False), [True, False], [1, "True", None, []]),
    "slider": (
        lambda gui: gui.add_slider("s", -70.0, 70.0, 0.5, 0.0),
        [0, -70, 70.0, 12.5, 70.4],
        [-70.6, 71, math.nan, math.inf, -math.inf, 1e300, 2**63, True, "1", None, [1.0]],
    ),
    "choice": (
        lambda gui: gui.add_dropdown("d", ("one", "two")),
        ["one", "two"],
        ["three", "", b"one", 0, None, ["one"], {"one": 1}],
    ),
    # A row's labels follow the state: one that was there a moment ago is a click, too.
    "row": (
        lambda gui: gui.add_button_group("g", ("one", "two")),
        ["two", "✓ two"],
        [None, 1, True, ["two"], "x" * 1001],
    ),
    "text": (lambda gui: gui.add_text("t", ""), ["", "Anna", "x" * 1000], ["x" * 1001, 1, None]),
    "number": (
        lambda gui: gui.add_number("n", 0.0),
        [0, -6.0, 4000, 1e5],
        [math.nan, math.inf, -math.inf, 1e300, 2**63, True, "1", None, [1.0]],
    ),
    # No page has any; whoever adds the first adds a rule.
    "colour": (lambda gui: gui.add_rgb("r", (0, 0, 0)), [], [(1, 2, 3)]),
    "upload": (lambda gui: gui.add_upload_button("u"), [], [True, {}, b"x"]),
}


@pytest.mark.parametrize("kind", WIDGETS)
def test_a_widget_takes_what_a_person_can_give_it(server: LocalServer, kind: str) -> None:
    make, good, bad = WIDGETS[kind]
    widget = make(server.gui)
    assert all(set_value(server, widget, value=value) for value in good)
    for value in bad:
        assert not set_value(server, widget, value=value), value
    value = good[0] if good else bad[0]
    for name in ("removed", "props", "visible", "disabled", "options", "label", "order", "uuid"):
        assert not set_value(server, widget, **{name: True})
        assert not set_value(server, widget, **{"value": value, name: True})
    widget.visible = False
    assert not any(set_value(server, widget, value=value) for value in good)
    if kind != "row":  # which viser cannot disable
        widget.visible, widget.disabled = True, True
        assert not any(set_value(server, widget, value=value) for value in good)


def test_only_ones_own_widgets_are_heard_of(server: LocalServer) -> None:
    """Another tab's or another server's widget is nobody's here."""
    widget = server.gui.add_checkbox("mine", False)
    message = {
        "type": "GuiUpdateMessage",
        "uuid": widget._impl.uuid,
        "updates": {"value": True},
    }
    raw = msgspec.msgpack.encode(message)
    assert is_heard(raw, partial(widget_of, server.gui)) and not is_heard(raw, nobody)


CAMERA = {**instance(messages.ViewerCameraMessage, {}), **AHEAD} | {
    "image_width": 1280,
    "image_height": 720,
}


@pytest.mark.parametrize(
    "change",
    [{}, {"image_width": 1280.5}, {"image_width": 11520}, {"position": (0, 0, -9.5)}, {"fov": 1}],
    ids=str,
)
def test_a_point_of_view_is_heard(server: LocalServer, change: dict[str, Any]) -> None:
    assert heard(server, **CAMERA | change)


@pytest.mark.parametrize(
    "change",
    [
        {"up_direction": (0, 0, 0)},
        {"look_at": (0, 0, 0)},
        {"wxyz": (0, 0, 0, 0)},
        {"wxyz": (1, 0, 0)},
        {"position": (math.nan, 0, 0)},
        {"position": (1e300, 0, 0)},
        {"position": ("a", "b", "c")},
        # viser makes numbers of texts, past every limit.
        {"position": ("nan", "0", "1e300")},
        {"up_direction": ("nan", "0", "1")},
        {"up_direction": (0, math.nan, 1)},
        {"image_width": "1" * 310},
        {"fov": "1"},
        {"fov": True},
        {"position": None},
        {"position": ((0, 0, 0), (0, 0, 0))},
        {"fov": math.inf},
        {"fov": 0},
        {"fov": 4.0},
        {"near": -1.0},
        {"image_width": 0},
        {"image_height": None},
        {"more": 1},
    ],
    ids=str,
)
def test_a_point_of_view_that_cannot_be_is_not_heard(
    server: LocalServer, change: dict[str, Any]
) -> None:
    assert not heard(server, **CAMERA | change)
    shorter = {name: value for name, value in CAMERA.items() if name not in change}
    assert "more" in change or not heard(server, **shorter)


@pytest.mark.parametrize(
    "change",
    [
        {"wxyz": (0, 0, 0, 0)},
        {"wxyz": (math.nan, 0, 0, 1)},
        {"position": (0, 0, 1e9)},
        {"position": (0, 0)},
        {"name": 7},
        {"name": "x" * 1001},
    ],
    ids=str,
)
def test_a_board_is_dragged_to_where_it_can_be(server: LocalServer, change: dict[str, Any]) -> None:
    good = {
        "type": "TransformControlsUpdateMessage",
        "name": "/gizmo",
        "wxyz": (1, 0, 0, 0),
        "position": (0, 0.1, 0.5),
        "owner": "",
    }
    assert heard(server, **good) and not heard(server, **good | change)


HEARD = {
    "ViewerCameraMessage",
    "GuiUpdateMessage",
    "CommandTriggerMessage",
    "TransformControlsUpdateMessage",
    "TransformControlsDragStartMessage",
    "TransformControlsDragEndMessage",
    "SceneNodeClickMessage",
    "SceneNodeDragMessage",
    "ScenePointerMessage",
    "LocalStorageGetItemResponseMessage",
}


def test_of_all_messages_of_viser_these_are_heard(server: LocalServer) -> None:
    """A version of viser that renames one, or brings another, is seen here."""
    uuid = server.gui.add_button("b")._impl.uuid
    sent = {
        kind.__name__: instance(kind, {"uuid": uuid}) for kind in messages.Message.get_subclasses()
    }
    sent["ViewerCameraMessage"] = CAMERA
    assert len(sent) > 100
    assert {name for name, message in sent.items() if heard(server, **message)} == HEARD


@given(st.binary(max_size=200))
def test_bytes_that_say_nothing_are_no_error(raw: bytes) -> None:
    assert not is_heard(raw, nobody)


@given(
    st.dictionaries(
        st.sampled_from(["uuid", "updates", "name", "wxyz", "position", "owner", "fov", "type"]),
        st.recursive(
            st.none() | st.booleans() | st.floats() | st.integers(-(2**63), 2**64 - 1) | st.text(),
            lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
            max_leaves=8,
        ),
    ),
    st.sampled_from(sorted(HEARD)),
)
def test_fields_of_any_kind_are_no_error(content: dict[str, Any], kind: str) -> None:
    is_heard(msgspec.msgpack.encode({**content, "type": kind}), nobody)


def test_nested_without_end_is_no_error(server: LocalServer) -> None:
    deep = b"\x91" * 60_000
    head = msgspec.msgpack.encode({"type": "ViewerCameraMessage"})
    assert not is_heard(
        b"\x82" + head[1:] + b"\xa3fov" + deep + b"\xc0", partial(widget_of, server.gui)
    )
    assert not is_heard(deep, partial(widget_of, server.gui))


@pytest.mark.parametrize("page", ["guide", "trial", "teach", "practice"])
def test_every_widget_of_every_page_has_a_rule(
    page: str, paper_camera: Camera, default_board: Board, painter: Offscreen, tmp_path: Path
) -> None:
    """One without would be dead: its value is heard by nobody."""
    gui, close = opened_page(page, paper_camera, default_board, painter, tmp_path)
    try:
        widgets = gui._gui_input_handle_from_uuid
        assert widgets
        for uuid, widget in widgets.items():
            shown, disabled = widget.visible, widget.disabled
            widget.visible = True
            if disabled:
                widget.disabled = False
            value = True if isinstance(widget, viser.GuiButtonHandle) else widget.value
            message = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}
            assert is_heard(msgspec.msgpack.encode(message), partial(widget_of, gui)), widget.label
            widget.visible = shown
            if disabled:
                widget.disabled = True
    finally:
        close()


def opened_page(
    page: str, camera: Camera, board: Board, painter: Offscreen, folder: Path
) -> tuple[Any, Callable[[], None]]:
    """The widgets of one page, and what closes it."""
    if page == "guide":
        viewer = Viewer(port=free_port())
        return viewer.server.gui, viewer.close
    if page == "teach":
        stack = ExitStack()
        teach = stack.enter_context(served_teaching(PoseAnalysis(camera, board), painter))
        client = stack.enter_context(RawClient(teach.port))
        client.look()
        teach.page().toggle_menu()
        return teach.server.tabs[0].client.gui, stack.close
    server, _ = start_server("127.0.0.1", free_port())
    if page == "trial":
        target = Pose.from_vector([0, 0, 0, 0, 0, 0.5])
        trial = Trial(board, camera, plan_of("Anna", []), (target,), lambda _: None)
        exercise = trial_server(server, trial, TrialPictures())
    else:
        settings = PracticeSettings.of(camera, board, 0, "practice.csv")
        file = ExerciseFile(folder / "practice.csv", "practice")
        exercise = PracticeServer(server, settings, file, painter)
    with RawClient(server.get_port()) as client:
        client.look()
        client.backlog()
        # The page's last message may be read before its tab is there.
        wait_until(lambda: exercise.tabs)
        (tab,) = exercise.tabs
        return tab.client.gui, lambda: (exercise.close(), server.stop())[0]
