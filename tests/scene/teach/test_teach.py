"""What the teaching page is given: poses worked out, and lessons in their order."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from tests.ports import free_port
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.reading import shipped_lessons
from venus3d.scene.pages.teach import run as teach
from venus3d.scene.pages.teach.lesson_html import untold_comparison_html
from venus3d.scene.pages.teach.options import TeachOptions
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import PoseAnalysis

OWN = """
title = "Mine"
summary = "Made by a teacher."
[[page]]
title = "One"
text = "Text."
pose = [10, 0, 0, 0, 0, 500]
"""


def test_a_pose_is_worked_out_in_degrees_and_millimetres(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    study = teach.PoseAnalysis(paper_camera, default_board)
    for _ in range(20):
        angles, place = rng.uniform(-60, 60, 3), rng.uniform([-200, -150, 350], [200, 150, 900])
        a, b, c, x, y, z = (float(v) for v in (*angles, *place))
        taught = study((a, b, c, x, y, z), "yxz")
        rotation = Rotation.from_euler("xyz", angles, degrees=True)
        pixels, _ = cv2.projectPoints(
            default_board.outline,
            rotation.as_rotvec(),
            place / 1000,
            paper_camera.K,
            paper_camera.distortion,
        )
        ours = paper_camera.project(taught.pose.apply(default_board.outline))
        np.testing.assert_allclose(ours, pixels.reshape(-1, 2), atol=1e-6)
        outside = (pixels < 0).any() or (pixels.reshape(-1, 2) > [1279, 719]).any()
        assert not outside or any(r.kind == "outside" for r in taught.refusals)
        other = Rotation.from_euler("yxz", angles[[1, 0, 2]], degrees=True)
        np.testing.assert_allclose(taught.reordered[2].after.R, other.as_matrix(), atol=1e-9)
    assert study((20.0, 88.0, 0.0, 0.0, 0.0, 500.0)).locked
    assert not np.isfinite(study((0.0, 0.0, 0.0, 0.0, 0.0, 500.0)).sigma_px), "a frontal board"


def test_an_own_lesson_comes_first_and_a_wrong_name_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    served: dict[str, object] = {}

    class ServedError(Exception):
        pass

    def server(*_: object, **options: object) -> None:
        served.update(options)
        raise ServedError

    monkeypatch.setattr(teach, "TeachServer", server)
    own = tmp_path / "mine.toml"
    own.write_text(OWN, encoding="utf-8")
    for choice, title, number in ((str(own), "Mine", 0), ("gimbal-lock", "", None)):
        with pytest.raises(ServedError):
            teach.run_teach(TeachOptions(lesson=choice, port=free_port()))
        lessons = served["lessons"]
        assert isinstance(lessons, tuple) and len(lessons) >= 6
        chosen = lessons[served["lesson"]]  # type: ignore[index]
        assert chosen.title == title or "gimbal" in chosen.name
        assert number is None or served["lesson"] == number
    with pytest.raises(VenusError, match="gimbal-lock"):
        teach.run_teach(TeachOptions(lesson="gimbal-luck"))


def test_a_pose_that_leaves_the_picture_is_told_when_it_is_loaded_and_exported(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    paper_camera: Camera,
    default_board: Board,
) -> None:
    own = tmp_path / "mine.toml"
    own.write_text(OWN.replace("[10, 0, 0, 0, 0, 500]", "[0, 0, 0, 250, 0, 500]"), "utf-8")
    # Two corners: the board is 252 mm wide, the picture ends 302 mm right of its middle.
    x = (paper_camera.width - paper_camera.cx) / paper_camera.fx * 500
    assert 250 - default_board.width * 500 < x < 250 + default_board.width * 500
    told = "'Mine', page 1 (One): 2 of the board's 4 corners are outside the picture"
    _, notes = teach.export_lesson(TeachOptions(lesson=str(own)), "png")
    assert any(told in note for note in notes)
    monkeypatch.setattr(teach.TeachServer, "run", lambda _: None)
    teach.run_teach(TeachOptions(lesson=str(own), port=free_port()))
    said = capsys.readouterr().out
    assert told in said and said.count("outside the picture") == 1, "no lesson of ours"


def test_a_file_is_dark_where_that_is_asked_for(tmp_path: Path) -> None:
    own = tmp_path / "mine.toml"
    own.write_text(OWN, encoding="utf-8")
    for dark in (False, True):
        options = TeachOptions(lesson=str(own), export=tmp_path / "mine.gif", dark=dark)
        options.check()
        (film,), _ = teach.export_lesson(options, "gif")
        first = Image.open(BytesIO(film)).convert("RGB")
        assert bool(np.median(first) < 60) is dark
    for export in (None, tmp_path / "mine.png"):
        with pytest.raises(VenusError, match="--dark goes with --export"):
            TeachOptions(export=export, dark=True).check()


def test_a_page_that_compares_does_not_repeat_why_below_its_numbers(
    paper_camera: Camera, default_board: Board
) -> None:
    """Lessons 4 and 5 were longer than a small window by what they say themselves."""
    lessons = shipped_lessons()
    lesson, number = next(
        (i, n)
        for i, one in enumerate(lessons)
        for n, page in enumerate(one.pages)
        if page.arrangement == "axes"
    )
    state = TeachState(lessons=lessons).opened(lesson, number)
    taught = PoseAnalysis(paper_camera, default_board)(state.vector, state.order)
    assert not untold_comparison_html(taught, state)
    assert "v-why" in untold_comparison_html(taught, state.with_arrangement("order"))
    assert "v-why" in untold_comparison_html(taught, state.opened(None).with_arrangement("axes"))
