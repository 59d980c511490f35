"""A replayed session shows what was known at each moment, and nothing of it can be changed."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path

import av
import numpy as np
import pytest

from tests.engine.calibration.test_adjustment import GOOD, observe
from tests.ports import free_port
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.render.offscreen import Offscreen
from venus3d.render.scene_picture import scene_picture
from venus3d.render.shapes import LineShape
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.pages.guide import replay_film as replay_film_module
from venus3d.scene.pages.guide.replay import Worker
from venus3d.scene.pages.guide.replay_bar import Place, ReplayBar, moment_at
from venus3d.scene.pages.guide.replay_document import replay_document
from venus3d.scene.pages.guide.replay_film import known_sentence, replay_film
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.storage.session_folder import SessionFolder
from venus3d.storage.session_moments import LONGEST_PAUSE_S, moments_of

SETTINGS = Settings(auto_capture=False, method="random")
VIEWS = 4


@pytest.fixture(scope="module")
def recorded(
    tmp_path_factory: pytest.TempPathFactory, default_board: Board, paper_camera: Camera
) -> Path:
    """A session of four views, the first of them taken back at the end."""
    directory = tmp_path_factory.mktemp("recorded") / "session"
    rng = np.random.default_rng(3)
    folder = SessionFolder.create(directory, {"options": {}}, lambda _: None)
    session = Session(default_board, paper_camera.image_size, SETTINGS, folder)
    folder.changed(session.state)
    for vector in GOOD[:VIEWS]:
        picture = np.full((720, 1280, 3), 90, np.uint8)
        seen = observe(paper_camera, default_board, vector, rng, 0.1)
        session.observe(replace(seen, image=picture))
        assert session.capture()
        session.run_pending()
    session.drop_view(1)
    session.run_pending()
    folder.close()
    return directory


def test_what_is_shown_is_what_was_known(recorded: Path, default_board: Board) -> None:
    """After view k the calibration of exactly the views until then; before it, that of before."""
    moments = moments_of(recorded)
    assert [m.kind for m in moments] == ["captured", "calibrated"] * VIEWS + ["changed"]
    worker = Worker(moments, SETTINGS)
    snapshots = worker.finish()
    seen = [moments[2 * k].seen for k in range(VIEWS)]
    for k in range(2, VIEWS):
        before, after = snapshots[2 * k], snapshots[2 * k + 1]
        assert before.captured == tuple(range(1, k + 1))
        assert after.captured == tuple(range(1, k + 2))
        assert after.observation is before.observation is seen[k]
        expected = calibrate(default_board, seen[: k + 1]).camera.parameters
        assert after.calibration is not None
        np.testing.assert_allclose(after.calibration.camera.parameters, expected, rtol=1e-6)
    assert snapshots[0].calibration is None and snapshots[0].captured == ()
    assert snapshots[-1].captured == (2, 3, 4)
    assert "not determined" in known_sentence(moments[0], snapshots[0])
    assert "3 views" in known_sentence(moments[-1], snapshots[-1])


def test_the_time_line(recorded: Path) -> None:
    """It plays at its speed to the end, jumps from view to view, and holds no long pause."""
    moments = moments_of(recorded)
    bar = ReplayBar(moments)
    pauses = np.diff([m.play_s for m in moments])
    assert (pauses >= 0).all() and (pauses <= LONGEST_PAUSE_S).all()
    captures = [m.play_s for m in moments if m.kind == "captured"]
    for expected in captures[1:]:
        bar.go_by(1)
        assert bar.place.time_s == expected
    assert moments[moment_at(moments, bar.place.time_s)].number == VIEWS
    bar.go_by(-1)
    assert bar.place.time_s == captures[-2]
    assert Place(1.0, True, 5).after(2.0, 100.0).time_s == 11.0
    assert Place(1.0, True, 5).after(2.0, 3.0) == Place(3.0, False, 5)
    assert Place(1.0).after(2.0, 3.0) == Place(1.0)


def test_the_film_can_be_played(
    recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The camera's picture on the left stands while the board comes there in the scene beside it;
    then two seconds of what it gave."""
    monkeypatch.setattr(replay_film_module, "_SIZE", (320, 180))
    monkeypatch.setattr(replay_film_module, "_FPS", 4)
    path = tmp_path / "session.mp4"
    path.write_bytes(replay_film(moments_of(recorded)[2:4], SETTINGS))
    with av.open(str(path)) as film:
        frames = [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(video=0)]
    way = frames[:-8]
    assert len(way) >= 5 + 6 and frames[0].shape == (226, 640, 3)  # a step and a rest at least
    picture, scene = (slice(50, 220), slice(5, 315)), (slice(50, 220), slice(325, 635))
    assert np.abs(way[0][picture] - way[-1][picture]).mean() < 1
    assert np.abs(way[0][scene] - way[-1][scene]).mean() > 3
    assert np.abs(frames[-1][scene] - way[-1][scene]).mean() > 3
    assert np.abs(frames[-1][scene] - frames[-7][scene]).mean() < 1


def test_the_scene_offscreen_is_seen_from_where_it_is_framed() -> None:
    """A dot in the scene appears where the viewpoint says, by the painter as by viser's frustum."""
    view = SceneCamera(np.array([0.4, -0.3, -0.5]), np.array([0.0, 0.0, 0.5]), 0.7)
    at = np.array([0.05, -0.08, 0.45])
    mark = LineShape(
        "/steps/1/x", np.array([[at, at + np.array([0.004, 0, 0])]]), Pose.identity(), (255, 0, 0)
    )
    with Offscreen("painter") as offscreen:
        size = (320, 180)
        drawn = scene_picture(offscreen, [mark], view, size, dark=True).result().astype(int)
    v, u = np.nonzero(drawn[..., 0] - drawn[..., 1] > 80)
    expected = (view.in_window(at[None], 320 / 180)[0] + 1) / 2 * size
    np.testing.assert_allclose([u.mean(), v.mean()], expected, atol=2.5)


def test_the_document_shows_a_view_on_each_page_and_loads_nothing(recorded: Path) -> None:
    """Each with its picture and recording, then the result; what was taken back is said."""
    moments = moments_of(recorded)
    page = replay_document([*moments[:2], moments[-1]], SETTINGS, "<b>lab</b>").decode()
    assert re.findall(r"<h2>(.*?)</h2>", page) == ["View 1", "The result"]
    assert "This view was taken back later." in page and "&lt;b&gt;lab" in page
    assert page.count("<img class='lens'") == 1
    recordings = re.search(r"id='recordings'>(.*?)</script>", page)
    assert recordings is not None and len(set(json.loads(recordings[1]))) == 2
    assert not re.search(r"(src|href)=.https?:", page) and "default-src 'none'" in page
    assert "3 views" in page.rpartition("The result")[2]


def test_nothing_can_be_changed() -> None:
    """No button, key or command of the page asks for what a record cannot do."""
    viewer = Viewer(port=free_port(), recorded=True)
    try:
        offered = {command.label for command in viewer.view.controls.commands}
        live = Viewer(port=free_port())
        try:
            gone = {c.label for c in live.view.controls.commands} - offered
        finally:
            live.close()
        assert len(gone) == 7  # capture, skip, undo, finish, go on, new, pause
    finally:
        viewer.close()


def test_a_session_without_a_view(tmp_path: Path) -> None:
    folder = SessionFolder.create(tmp_path / "new", {}, lambda _: None)
    with pytest.raises(StorageError, match="nothing to show"):
        moments_of(folder.directory)
    folder.close()


def test_a_clock_that_was_set_back(recorded: Path, tmp_path: Path) -> None:
    """The time line never goes back, and no pause of an hour is shown."""
    lines = [json.loads(line) for line in (recorded / "events.jsonl").read_text().splitlines()]
    for line in lines[3:6]:
        line["at"] = (datetime.fromisoformat(line["at"]) - timedelta(hours=1)).isoformat()
    (tmp_path / "events.jsonl").write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    places = [moment.play_s for moment in moments_of(tmp_path)]
    assert places == sorted(places) and LONGEST_PAUSE_S <= places[-1] <= 2 * LONGEST_PAUSE_S
