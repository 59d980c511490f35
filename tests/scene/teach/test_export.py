"""Exported files are read again with other programs' eyes: PyAV, Pillow, an HTML parser.

Held down: a film that does not move, a sheet of another size, a page that fetches something.
"""

from __future__ import annotations

import io
import re

import av
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from PIL.GifImagePlugin import GifImageFile
from scipy.spatial.transform import Rotation

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.lesson import Lesson, LessonPage
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.teach.export.animation import exported_pages
from venus3d.scene.pages.teach.export.comparison_picture import comparison_picture
from venus3d.scene.pages.teach.export.files import export_files, kind_of, lesson_of_pose
from venus3d.scene.pages.teach.export.sentences import pose_sentence
from venus3d.scene.pages.teach.state import Vector
from venus3d.scene.pages.teach.view_model import PoseAnalysis

_POSE = (0.0, 0.0, 40.0, 0.0, 0.0, 500.0)


@pytest.fixture
def study(paper_camera: Camera, default_board: Board) -> PoseAnalysis:
    return PoseAnalysis(paper_camera.scaled((320, 180)), default_board)


@pytest.mark.slow
def test_a_film_moves_from_the_upright_board_to_the_target(
    study: PoseAnalysis, painter: Offscreen
) -> None:
    (content,) = export_files(lesson_of_pose(_POSE), "mp4", study, painter)
    with av.open(io.BytesIO(content)) as film:
        stream = film.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in film.decode(stream)]
        assert stream.codec_context.name == "h264" and stream.average_rate == 25
    assert len(frames) > 50 and frames[0].shape[1] == 1280
    after_title = frames[45].astype(int)
    assert np.abs(frames[-1].astype(int) - after_title).mean() > 2


@pytest.mark.slow
def test_an_animated_picture_goes_round(study: PoseAnalysis, painter: Offscreen) -> None:
    (content,) = export_files(lesson_of_pose(_POSE), "gif", study, painter)
    picture = Image.open(io.BytesIO(content))
    assert isinstance(picture, GifImageFile) and picture.n_frames > 20
    assert picture.info["loop"] == 0


def test_a_sheet_is_a4_at_300_dots(study: PoseAnalysis, painter: Offscreen) -> None:
    (content,) = export_files(lesson_of_pose(_POSE), "png", study, painter)
    sheet = Image.open(io.BytesIO(content))
    inches = np.array(sheet.size) / np.array(sheet.info["dpi"])
    np.testing.assert_allclose(25.4 * inches, [297, 210], atol=0.5)
    assert np.asarray(sheet).std() > 20


def test_a_page_needs_nothing_from_outside(study: PoseAnalysis, painter: Offscreen) -> None:
    (content,) = export_files(lesson_of_pose(_POSE), "html", study, painter)
    page = content.decode("utf-8")
    ours = page[: page.index("id='player'")]
    assert not re.search(r"(src|href)=['\"](?!data:)", ours)
    assert ours.count("<figure") == 4 and ours.count("data:image/jpeg;base64,") == 4


def test_a_page_holds_what_its_words_speak_of(
    paper_camera: Camera,
    default_board: Board,
    painter: Offscreen,
    capfd: pytest.CaptureFixture[str],
) -> None:
    # "The figure below", "the map shows", "the program says so": not only in the live lesson.
    pages = (
        LessonPage("Tilted", "See below.", (30, 0, 0, 0, 0, 500), show=("sigma",)),
        LessonPage("Bent", "See the map.", (0, 0, 0, 0, 0, 500), show=("distortion",)),
        LessonPage("Edge on", "Nobody is asked.", (0, 90, 0, 0, 0, 500)),
        LessonPage("Two", "Compare.", (38, 38, 0, 0, 0, 560), arrangement="order", order="yxz"),
    )
    study = PoseAnalysis(paper_camera, default_board)
    (content,) = export_files(Lesson("all", "All", "", pages), "html", study, painter)
    told = [part.split("</article>")[0] for part in content.decode("utf-8").split("<article")[1:]]
    sigma = study(pages[0].pose).sigma_px
    assert f"± {sigma:.{sigma < 10:d}f} px" in told[0] and "v-sigma" in told[0]
    assert "class='lens'" in told[1] and "class='lens'" not in told[0]
    assert "not asked for this pose" in told[2] and "90°; more than 70°" in told[2]
    assert "Gimbal lock" in told[2] and "slider" not in told[2]
    assert "not asked for this pose" not in "".join((told[0], told[1], told[3]))
    one = Rotation.from_euler("xyz", [38, 38, 0], degrees=True)
    other = Rotation.from_euler("yxz", [38, 38, 0], degrees=True)
    apart = np.degrees((other * one.inv()).magnitude())
    assert f"{apart:.0f}° apart" in told[3] and "only the order differs" in told[3]
    assert capfd.readouterr().out == ""  # whoever exports reads where the file is, and no more


def test_boards_that_are_turned_alike_look_alike_side_by_side(
    study: PoseAnalysis, painter: Offscreen
) -> None:
    # In one wide picture perspective would show the two from different sides.
    def halves(angles: tuple[float, float, float]) -> list[NDArray[np.int_]]:
        pose = (*angles, 0.0, 0.0, 500.0)
        page = LessonPage("", "", pose, arrangement="order", order="yxz")
        (shown,) = exported_pages(Lesson("", "", "", (page,)), study, dark=True)
        picture = comparison_picture(shown.taught, shown.state, painter, (640, 360))()
        inside = picture[-300:-4, 4:-4].astype(int)  # neither titles nor the frame
        return [inside[:, :310], inside[:, 320:630]]

    left, right = halves((38, 0, 0))
    assert left.std() > 20 and np.abs(left - right).mean() < 0.5
    left, right = halves((38, 38, 0))
    assert np.abs(left - right).mean() > 4


@pytest.mark.parametrize(
    ("vector", "line"),
    [
        ((0, 0, 0, 0, 0, 500), "is not turned; its centre is straight ahead and 500 mm away."),
        ((0, 90, 0, 0, 0, 500), "turned by +90° about Y (swing); its centre is straight ahead"),
        (
            (25, -30, 20.5, 40, -20, 520),
            "+25° about X (tilt), −30° about Y (swing) and +20.5° about Z (rotation); its centre "
            "is 40 mm to the right, 20 mm up and 520 mm away.",
        ),
        ((0, 0, 0, -5, 8, 300), "5 mm to the left, 8 mm down and 300 mm away."),
    ],
)
def test_a_pose_is_told_without_what_is_zero(vector: Vector, line: str) -> None:
    assert line in pose_sentence(vector) and "+0" not in pose_sentence(vector)


def test_an_unknown_ending_names_those_that_there_are() -> None:
    from pathlib import Path

    with pytest.raises(StorageError, match=r"\.html, \.png, \.mp4 or \.gif"):
        kind_of(Path("lesson.pdf"))
