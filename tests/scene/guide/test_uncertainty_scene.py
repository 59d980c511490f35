"""Captured views and the replayed search as shapes: in the right place, in the right order."""

from __future__ import annotations

import numpy as np

from tests.scene.guided import guided_session
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.describe import SceneOptions, describe
from venus3d.render.framing import content_of
from venus3d.render.palette import contrast, ground
from venus3d.render.shapes import LineShape, MeshShape, PointShape, Shape
from venus3d.scene.pages.guide.subject import subject_of
from venus3d.scene.pages.guide.uncertainty.captured_views import captured_view_shapes, view_of
from venus3d.scene.pages.guide.uncertainty.search_replay import (
    REST_SECONDS,
    SECONDS,
    SearchReplay,
    caption,
    search_shapes,
    shown_after,
)


def named(shapes: tuple[Shape, ...]) -> dict[str, Shape]:
    found = {shape.name: shape for shape in shapes}
    assert len(found) == len(shapes), "each name once"
    return found


def test_ghosts_stand_where_the_board_was(guided: Snapshot) -> None:
    shapes = named(captured_view_shapes(guided.board, guided.views, 2, True))
    for view in guided.views:
        sheet = shapes[f"/views/{view.number}/sheet"]
        assert isinstance(sheet, MeshShape) and sheet.pose is view.pose
        assert view_of(sheet.name) == view.number
    chosen, other = shapes["/views/2/sheet"], shapes["/views/1/sheet"]
    assert isinstance(chosen, MeshShape) and isinstance(other, MeshShape)
    assert chosen.opacity > other.opacity
    worst = max(guided.views, key=lambda view: view.rms_px)
    best = min(guided.views, key=lambda view: view.rms_px)
    colours = [shapes[f"/views/{view.number}/sheet"].colour for view in (best, worst)]  # type: ignore[union-attr]
    assert sum(colours[0]) < sum(colours[1]), "the larger the misfit, the brighter"
    assert view_of("/views/2/outline") is None and view_of("/target/board") is None


def test_unchanged_ghosts_are_the_same_objects(guided: Snapshot) -> None:
    """The scene is drawn 25 times a second and sends only what is another object."""
    once, again = (captured_view_shapes(guided.board, guided.views, None, True) for _ in range(2))
    assert once is again
    walk = guided.search_trace
    assert walk is not None
    assert search_shapes(walk, 2, guided.board, True) is search_shapes(walk, 2, guided.board, True)


def test_a_view_of_the_search_holds_all_of_its_bests_from_the_start(guided: Snapshot) -> None:
    """Each new best could lie outside the window, until the view had flown there."""
    walk = guided.search_trace
    assert walk is not None
    held = [
        content_of(search_shapes(walk, shown, guided.board, True)).points
        for shown in range(1, len(walk.steps) + 1)
    ]
    low, high = held[0].min(axis=0) - 1e-9, held[0].max(axis=0) + 1e-9
    for points in held:
        assert (points >= low).all() and (points <= high).all()


def test_a_search_is_looked_at_from_where_it_is_seen(guided: Snapshot) -> None:
    """It was taken for an empty scene, which no view flies to: after the steps side by side it was
    played below the window."""
    walk = guided.search_trace
    assert walk is not None
    searched = search_shapes(walk, 1, guided.board, True)
    side_by_side = describe(guided, SceneOptions(strip=True))
    subject, before = subject_of(searched, 1), subject_of(side_by_side, 1)
    assert not subject.is_empty and subject.name != before.name
    assert subject_of((), 0).is_empty


def test_search_shows_every_pose_looked_at_and_ends_on_the_target(guided: Snapshot) -> None:
    walk, target = guided.search_trace, guided.target
    assert walk is not None and target is not None
    looked = 0
    for shown in range(1, len(walk.steps) + 1):
        shapes = named(search_shapes(walk, shown, guided.board, True))
        places, angles = shapes["/search/places"], shapes["/search/angles"]
        assert isinstance(places, PointShape) and isinstance(angles, PointShape)
        assert len(places.points) == len(places.colours) == len(angles.points) > looked
        looked = len(places.points)
        assert looked == walk.steps[shown - 1].evaluated
    assert looked == target.evaluated
    best = shapes["/search/best"]
    assert isinstance(best, LineShape)
    np.testing.assert_allclose(best.pose.matrix, target.pose.matrix, atol=1e-9)
    # The cheaper a pose, the more its dot stands out against the ground.
    costs = np.concatenate([move.candidate_costs for move in walk.steps])
    for dark in (True, False):
        dots = named(search_shapes(walk, shown, guided.board, dark))["/search/places"]
        assert isinstance(dots, PointShape)
        cheap, dear = (dots.colours[i] for i in (np.argmin(costs), np.argmax(costs)))
        paper = ground(dark).background
        assert contrast(tuple(cheap.tolist()), paper) > 3 * contrast(tuple(dear.tolist()), paper)


def test_annealing_is_a_line_through_the_poses_taken(
    paper_camera: Camera, default_board: Board
) -> None:
    snapshot = guided_session(paper_camera, default_board, Settings(method="venus"))
    walk = snapshot.search_trace
    assert walk is not None
    shapes = named(search_shapes(walk, 40, snapshot.board, True))
    taken = [move.vector[3:] for move in walk.steps[:40] if move.accepted]
    line = shapes["/search/walk"]
    assert isinstance(line, LineShape)
    np.testing.assert_allclose(line.segments[:, 0], taken[:-1])
    np.testing.assert_allclose(line.segments[:, 1], taken[1:])
    assert f"{len(taken)} taken" in caption(walk, 40, in_px=False)
    ended = caption(walk, len(walk.steps), in_px=False)
    assert "best on the way" in ended


def test_replay_takes_its_time_and_gives_the_steps_back(guided: Snapshot) -> None:
    """10 to 20 s for a search that took a tenth of one, then the scene is as before."""
    assert 10 <= SECONDS + REST_SECONDS <= 20
    now = [100.0]
    replay = SearchReplay(clock=lambda: now[0])
    plain = describe(guided, SceneOptions())
    assert replay.of(guided, plain, on=False, dark=True) is plain and not replay.is_moving
    shown: list[int] = []
    for _ in range(200):
        shapes = named(replay.of(guided, plain, on=True, dark=True))
        if not replay.is_moving:
            break
        assert "/camera/frustum" in shapes and "/target/board" not in shapes
        places = shapes["/search/places"]
        assert isinstance(places, PointShape)
        shown.append(len(places.points))
        assert "poses" in replay.caption
        now[0] += 0.1
    assert shown == sorted(shown) and len(set(shown)) == len(guided.search_trace.steps)  # type: ignore[union-attr]
    assert SECONDS + REST_SECONDS <= now[0] - 100 < SECONDS + REST_SECONDS + 1
    assert "/target/board" in shapes and replay.caption == ""
    # Switched off and on it begins anew.
    replay.of(guided, plain, on=False, dark=True)
    replay.of(guided, plain, on=True, dark=True)
    assert replay.is_moving


def test_nothing_to_watch_is_said(paper_camera: Camera, default_board: Board) -> None:
    """A rule's pose was not searched for."""
    snapshot = guided_session(paper_camera, default_board, Settings(method="pose-selection"))
    replay = SearchReplay()
    plain = describe(snapshot, SceneOptions())
    assert replay.of(snapshot, plain, on=True, dark=True) is plain
    assert "rule" in replay.caption


def test_every_move_is_shown_and_none_twice(guided: Snapshot) -> None:
    walk = guided.search_trace
    assert walk is not None
    counts = [shown_after(walk, s) for s in np.arange(-1, SECONDS + 5, 0.04)]
    assert counts[0] == 1 and counts[-1] == len(walk.steps)
    assert set(np.diff(counts)) <= {0, 1}
