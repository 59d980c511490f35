"""Rows and lists tell which action was meant, whatever stands on the buttons."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from venus3d.scene.web.buttons import ButtonRow, ChoiceList
from venus3d.scene.web.server import LocalServer


def widgets(server: LocalServer) -> list[Any]:
    return list(vars(server.gui)["_gui_input_handle_from_uuid"].values())


def choose(widget: Any, label: str) -> None:
    """As viser does when a browser sends this value."""
    widget._impl.value = label
    for act in widget._impl.update_cb:
        act(SimpleNamespace(target=widget, client="tab"))


def row_of(server: LocalServer) -> tuple[ButtonRow[str], Any, list[object]]:
    pressed: list[object] = []
    row = ButtonRow(
        server.gui,
        "g",
        {"a": "Same", "b": "Same"},
        lambda action, tab: pressed.extend((action, tab)),
    )
    return row, widgets(server)[-1], pressed


def test_buttons_with_the_same_label_are_two(server: LocalServer) -> None:
    _, widget, pressed = row_of(server)
    first, second = widget.options
    assert first != second
    choose(widget, second)
    choose(widget, first)
    assert pressed == ["b", "tab", "a", "tab"]


def test_a_click_on_a_label_that_has_just_changed_counts(server: LocalServer) -> None:
    row, widget, pressed = row_of(server)
    before = widget.options[1]
    row.show({"a": "Other", "b": "✓ Same"})
    choose(widget, before)
    choose(widget, widget.options[1])
    assert pressed == ["b", "tab"] * 2


def test_what_was_never_a_label_is_no_click(server: LocalServer) -> None:
    _, widget, pressed = row_of(server)
    choose(widget, "Another")
    assert not pressed


def test_a_row_shows_what_makes_sense_and_goes_with_its_last_button(server: LocalServer) -> None:
    row, widget, pressed = row_of(server)
    row.show({"b": "Same"})
    choose(widget, widget.options[0])
    assert pressed[0] == "b" and widget.visible
    row.show({})
    assert not row.visible
    row.show({"a": "Same"})
    assert row.visible


def test_labels_that_nobody_shares_stay_as_they_are(server: LocalServer) -> None:
    row, widget, _ = row_of(server)
    row.show({"a": "One", "b": "Two"})
    assert widget.options == ("One", "Two")
    row.show({"a": "Two", "b": "One"})
    assert [label.rstrip("\u200b") for label in widget.options] == ["Two", "One"]
    assert set(widget.options).isdisjoint(("One", "Two"))


def test_a_list_tells_what_a_person_chose_only(server: LocalServer) -> None:
    chosen: list[int] = []
    labels = {1: "One", 2: "Same", 3: "Same"}
    choices = ChoiceList(server.gui, "d", labels, chosen.append, chosen=2)
    widget = widgets(server)[-1]
    assert choices.chosen == 2
    choices.show(labels, 3)
    assert choices.chosen == 3 and not chosen
    choose(widget, widget.options[0])
    assert chosen == [1] and choices.chosen == 1
    choices.show(labels, 3)
    assert choices.chosen == 1, "shown before: what was picked is on its way"
    choices.show(labels, 3, again=True)
    assert choices.chosen == 3
    choices.show({1: "Uno", 3: "Tres"}, 1)
    assert choices.chosen == 1 and widget.options == ("Uno", "Tres")
