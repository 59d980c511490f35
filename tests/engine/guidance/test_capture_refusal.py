"""What keeps a held board from being captured: each reason, on pictures made for it, and which
picture of a hold becomes the view."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of
from tests.engine.guidance.test_session import Rig
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.picture_quality import least_sharpness, picture_quality
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.capture_refusal import refusal
from venus3d.engine.guidance.work import Settings

Picture = NDArray[np.uint8]


@pytest.fixture(scope="module")
def picture() -> Picture:
    pose = Pose.from_vector([20, -15, 8, 0.01, 0, 0.42])
    return picture_of(Board(), Camera(640, 360, 500, 500, 319.5, 179.5), pose)


def seen_in(picture: Picture) -> Observation:
    seen = Detector(Board(), find_layout=False).detect(picture)
    assert seen.count >= 4
    return replace(seen, image=picture)


def shaded(picture: Picture, low: float, high: float) -> Picture:
    """With black and white at these grey values."""
    return np.clip(low + picture / 255.0 * (high - low), 0, 255).astype(np.uint8)


def glossy(picture: Picture) -> Picture:
    """With a lamp mirrored in the middle of the board."""
    spot = np.zeros(picture.shape, np.float32)
    cv2.ellipse(spot, (320, 180), (55, 40), 0, 0, 360, 110, -1)
    return np.clip(picture + cv2.GaussianBlur(spot, (0, 0), 6), 0, 255).astype(np.uint8)


def test_a_good_picture_is_refused_by_nothing(picture: Picture) -> None:
    good = shaded(picture, 20, 200)
    seen = seen_in(good)
    quality = picture_quality(good, Board(), seen)
    assert quality is not None and quality.washed_out == 0
    # The print's two tones, whose edges the picture blurs.
    assert 20 <= quality.black < 45 and 175 < quality.white <= 200
    assert refusal(seen, Board(), motion_px=0.9, usual_sharpness=seen.sharpness) is None
    deep = (good.astype(np.uint16) * 257).astype(np.uint16)
    same = picture_quality(deep, Board(), seen)  # type: ignore[arg-type]
    assert same is not None and abs(same.white - quality.white) < 0.5
    assert picture_quality(cv2.merge([good] * 3), Board(), seen) == pytest.approx(quality)


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda p: shaded(p, 4, 55), "Too dark: the board's white is only 4"),
        (lambda p: shaded(p, 60, 330), "Too bright: the board's white is burnt out"),
        (lambda p: glossy(shaded(p, 20, 190)), "% of the corners, more than 8%"),
    ],
)
def test_each_bad_light_has_its_sentence(
    picture: Picture, spoil: Callable[[Picture], Picture], said: str
) -> None:
    why = refusal(seen_in(spoil(picture)), Board())
    assert why is not None and said in why


def test_out_of_focus_is_judged_by_the_views_before_and_by_the_picture_width(
    picture: Picture,
) -> None:
    sharp, soft = (
        seen_in(np.asarray(cv2.GaussianBlur(shaded(picture, 20, 200), (0, 0), blur), np.uint8))
        for blur in (0.3, 1.3)
    )
    assert refusal(sharp, Board()) is None and refusal(soft, Board()) is None
    why = refusal(soft, Board(), usual_sharpness=sharp.sharpness)
    assert why is not None and "Out of focus" in why
    assert least_sharpness(3840) == pytest.approx(least_sharpness(1280) / 3)


def test_motion_counts_by_the_time_of_one_frame(picture: Picture) -> None:
    """At 5 pictures a second, 1.5 px between two are 0.25 px while one is read out."""
    seen = seen_in(shaded(picture, 20, 200))
    why = refusal(seen, Board(), motion_px=1.5, since_s=1 / 30)
    assert why == "The board moves by 1.5 px in a frame's time, more than 1.0. Hold it still."
    assert refusal(seen, Board(), motion_px=1.5, since_s=0.2) is None
    assert refusal(seen, Board(), motion_px=1.5, since_s=1 / 120) is not None


class Judged(Rig):
    """A rig whose pictures have the sharpness that is asked for."""

    sharpness = (0.4,)

    def look(self) -> Observation:
        number = len(self.seen) % len(self.sharpness)
        return replace(super().look(), sharpness=self.sharpness[number])


@pytest.fixture
def rig(paper_camera: Camera, default_board: Board) -> Judged:
    return Judged(paper_camera, default_board, Settings(max_views=20))


def test_the_sharpest_picture_of_the_hold_is_captured(rig: Judged) -> None:
    rig.sharpness = (0.40, 0.44, 0.42)
    rig.until_views(3)
    # Every three pictures in a row hold each of the three once.
    assert {view.observation.sharpness for view in rig.session.state.views} == {0.44}


def test_a_blurred_hold_waits_says_why_and_the_key_captures_it(rig: Judged) -> None:
    before = len(rig.until_views(2).views)
    rig.sharpness = (0.1,)
    for _ in range(12):
        snapshot = rig.step()
    assert len(snapshot.views) == before and snapshot.refusal is not None
    assert snapshot.headline == "Not captured yet"
    assert snapshot.instruction.holder == snapshot.refusal and "Out of focus" in snapshot.refusal
    rig.sharpness = (0.4,)
    for _ in range(2):
        snapshot = rig.step()
    assert snapshot.refusal is None and len(snapshot.views) == before + 1
    rig.sharpness = (0.1,)
    rig.step()
    assert rig.session.capture(), "asked for, it is captured as it is"
