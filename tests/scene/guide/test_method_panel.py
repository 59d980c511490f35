"""The list of methods says what the session does, and yet keeps what somebody picks."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from tests.ports import free_port
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.intents import ChangeMethod, Intent
from venus3d.scene.pages.guide.method_panel import MethodPanel
from venus3d.scene.pages.guide.texts import COST_WORDS, METHOD_WORDS
from venus3d.scene.web.server import start_server


def test_a_pick_is_not_put_back_while_it_is_on_its_way(
    guided: Snapshot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page is drawn after viser has the value and before the callback comes."""
    now = [100.0]
    monkeypatch.setattr("venus3d.scene.pages.guide.method_panel.monotonic", lambda: now[0])
    server, _ = start_server("127.0.0.1", free_port())
    asked: list[Intent] = []
    panel = MethodPanel(server.gui, asked.append)
    panel.show(guided)
    box: Any = next(iter(vars(server.gui)["_gui_input_handle_from_uuid"].values()))

    def told() -> None:
        for act in box._impl.update_cb:
            act(SimpleNamespace(target=box, client="a browser"))

    venus = replace(guided, method="venus", cost="sum-iod")
    assert box.value == METHOD_WORDS["global"]
    box.value = METHOD_WORDS["venus"]  # as viser does when a browser says so
    panel.show(guided)
    told()
    assert asked == [ChangeMethod("venus", None)]
    panel.show(guided)
    assert box.value == METHOD_WORDS["venus"]

    now[0] += 0.5
    panel.show(venus)
    panel.show(guided)  # by the command palette
    assert box.value == METHOD_WORDS["global"]

    box.value = METHOD_WORDS["venus"]
    told()
    now[0] += 2  # and the session refused it
    panel.show(guided)
    assert box.value == METHOD_WORDS["global"]
    server.stop()


def test_what_the_command_line_chose_stands_in_the_list(guided: Snapshot) -> None:
    """The page offers two methods, and tells the truth of any other."""
    server, _ = start_server("127.0.0.1", free_port())
    try:
        panel = MethodPanel(server.gui, lambda _: None)
        box: Any = next(iter(vars(server.gui)["_gui_input_handle_from_uuid"].values()))
        assert box.options == (METHOD_WORDS["global"], METHOD_WORDS["venus"])
        panel.show(replace(guided, method="random"))
        assert box.value == METHOD_WORDS["random"] and len(box.options) == 3
        panel.show(replace(guided, method="venus", cost="max-iod"))
        assert METHOD_WORDS["venus"] in box.value and COST_WORDS["max-iod"] in box.value
        panel.show(guided)
        assert box.options[:2] == (METHOD_WORDS["global"], METHOD_WORDS["venus"])
        assert len(box.options) == 3, "or nobody could go back to it"
    finally:
        server.stop()
