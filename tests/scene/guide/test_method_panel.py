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
from venus3d.scene.pages.guide.texts import METHOD_WORDS
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

    assert box.value == METHOD_WORDS["global"]
    box.value = METHOD_WORDS["random"]  # as viser does when a browser says so
    panel.show(guided)
    told()
    assert asked == [ChangeMethod("random", None)]
    panel.show(guided)
    assert box.value == METHOD_WORDS["random"]

    now[0] += 0.5
    accepted = replace(guided, method="random")
    panel.show(accepted)
    panel.show(replace(accepted, method="venus"))  # by the command palette
    assert box.value == METHOD_WORDS["venus"]

    box.value = METHOD_WORDS["random"]
    told()
    now[0] += 2  # and the session refused it
    panel.show(replace(accepted, method="venus"))
    assert box.value == METHOD_WORDS["venus"]
    server.stop()
