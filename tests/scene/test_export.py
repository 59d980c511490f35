"""Exported files are read again with other programs' eyes: PyAV, Pillow, an HTML parser.

Held down: a film that does not move, a sheet of another size, a page that fetches something.
"""

from __future__ import annotations

import io
import re

import av
import numpy as np
import pytest
from PIL import Image

from venus3d.app.export import exported, kind_of, lesson_of_pose
from venus3d.app.teach import PoseStudy
from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.errors import StorageError
from venus3d.scene.offscreen import Offscreen

_POSE = (0.0, 0.0, 40.0, 0.0, 0.0, 500.0)


@pytest.fixture
def study(paper_camera: Camera, default_board: Board) -> PoseStudy:
    return PoseStudy(paper_camera.scaled((320, 180)), default_board)


@pytest.mark.slow
def test_a_film_moves_from_the_upright_board_to_the_target(
    study: PoseStudy, painter: Offscreen
) -> None:
    (content,) = exported(lesson_of_pose(_POSE), "mp4", study, painter)
    with av.open(io.BytesIO(content)) as film:
        stream = film.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in film.decode(stream)]
        assert stream.codec_context.name == "h264" and stream.average_rate == 25
    assert len(frames) > 50 and frames[0].shape[1] == 1280
    after_title = frames[45].astype(int)
    assert np.abs(frames[-1].astype(int) - after_title).mean() > 2


@pytest.mark.slow
def test_an_animated_picture_goes_round(study: PoseStudy, painter: Offscreen) -> None:
    (content,) = exported(lesson_of_pose(_POSE), "gif", study, painter)
    picture = Image.open(io.BytesIO(content))
    assert picture.n_frames > 20 and picture.info["loop"] == 0


def test_a_sheet_is_a4_at_300_dots(study: PoseStudy, painter: Offscreen) -> None:
    (content,) = exported(lesson_of_pose(_POSE), "png", study, painter)
    sheet = Image.open(io.BytesIO(content))
    inches = np.array(sheet.size) / np.array(sheet.info["dpi"])
    np.testing.assert_allclose(25.4 * inches, [297, 210], atol=0.5)
    assert np.asarray(sheet).std() > 20


def test_a_page_needs_nothing_from_outside(study: PoseStudy, painter: Offscreen) -> None:
    (content,) = exported(lesson_of_pose(_POSE), "html", study, painter)
    page = content.decode("utf-8")
    ours = page[: page.index("id='player'")]
    assert not re.search(r"(src|href)=['\"](?!data:)", ours)
    assert ours.count("<figure") == 4 and ours.count("data:image/jpeg;base64,") == 4


def test_an_unknown_ending_names_those_that_there_are() -> None:
    from pathlib import Path

    with pytest.raises(StorageError, match=r"\.html, \.png, \.mp4 or \.gif"):
        kind_of(Path("lesson.pdf"))
