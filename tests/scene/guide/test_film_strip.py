"""The strip of captured views: one button for each, none for a view that was taken back."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.film_strip import FilmStrip
from venus3d.scene.web.server import LocalServer


def strip_of(server: LocalServer) -> tuple[FilmStrip, Any, Any, list[tuple[int, object]]]:
    """The strip, its frame, its row of buttons, and what was opened."""
    opened: list[tuple[int, object]] = []
    film = FilmStrip(lambda number, tab: opened.append((number, tab)))
    film.lay_out(server.gui)
    row, frame = (
        vars(server.gui)["_gui_input_handle_from_uuid"][vars(film)["_row"]._widget._impl.uuid],
        vars(film)["_frame"],
    )
    return film, frame, row, opened


def test_a_button_for_each_view_and_its_picture_with_the_views_that_come(
    server: LocalServer,
) -> None:
    film, frame, row, _ = strip_of(server)
    assert frame.visible
    assert not row.visible, "its place is there from the beginning"
    film.keep_picture(1, np.full((720, 1280, 3), 200, np.uint8))
    film.keep_picture(4, np.full((720, 1280), 20, np.uint8))
    film.show((1, 2, 4), None)
    assert row.options == ("1", "2", "4")
    pictures = [f"nth-child({place})" in frame.content for place in (1, 2, 3)]
    assert pictures == [True, False, True], "no picture of the second one came"
    film.show((1, 2), 2)
    assert row.options == ("1", "2"), "the last one was taken back"
    assert "nth-child(2){border-color" in frame.content
    film.show((), None)
    assert not row.visible
    assert frame.visible


def test_where_nothing_is_captured_there_is_no_strip(server: LocalServer) -> None:
    film, frame, row, _ = strip_of(server)
    film.show(None, None)
    assert not frame.visible
    assert not row.visible


def test_a_click_opens_the_view(server: LocalServer) -> None:
    film, _, row, opened = strip_of(server)
    film.show((3, 5), None)
    row._impl.value = "5"
    for act in row._impl.update_cb:
        act(SimpleNamespace(target=row, client="tab"))
    assert opened == [(5, "tab")]


def test_a_snapshot_names_the_views_that_are_captured(guided: Snapshot) -> None:
    assert guided.captured == tuple(view.number for view in guided.views)
    session = Session(guided.board, guided.camera.image_size)
    assert session.snapshot().captured == ()
