"""Maps, cards and legends: what they show must be what is known, and be told apart by everybody."""

from __future__ import annotations

from dataclasses import replace
from html import escape

import cv2
import numpy as np
import pytest

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.colour_scale import (
    colour_of,
    colour_table,
    colours_of,
    magnification,
    round_down,
    round_up,
)
from venus3d.render.map_pictures import (
    coverage,
    coverage_picture,
    distorted_grid,
    distortion_magnification,
    distortion_picture,
    largest_shift_px,
    residual_magnification,
    residual_picture,
)
from venus3d.render.palette import linear
from venus3d.scene.pages.guide.uncertainty.maps import (
    MAP_KINDS,
    error_ticks,
    map_html,
    map_of,
)
from venus3d.scene.pages.guide.uncertainty.parameters import parameters_html, sparkline
from venus3d.scene.pages.guide.uncertainty.view_card import judgement, view_html

PARAMETERS = PAPER_CAMERA.parameter_names

SIZE = (640, 360)


def lightness(rgb: np.ndarray) -> np.ndarray:
    """CIE L* of sRGB colours (N, 3)."""
    y = linear(rgb) @ [0.2126, 0.7152, 0.0722]
    return 116 * np.cbrt(np.maximum(y, 0.008856)) - 16


def test_scale_grows_evenly_in_lightness_for_everybody() -> None:
    """Normal sight, and red- and green-blind people (Viénot, Brettel and Mollon 1999)."""
    light = linear(colour_table())
    blind = {
        "none": np.eye(3),
        "protan": np.array([[0.11238, 0.88762, 0], [0.11238, 0.88762, 0], [0.00401, -0.00401, 1]]),
        "deutan": np.array([[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]]),
    }
    for kind, matrix in blind.items():
        y = np.clip(light @ matrix.T, 0, 1) @ [0.2126, 0.7152, 0.0722]
        steps = np.diff(116 * np.cbrt(y[::16]) - 16)
        assert (steps > 0).all(), kind
        assert steps.max() < 3 * steps.min(), kind
    assert np.ptp(lightness(colour_table())) > 60


def test_colours_keep_the_order_of_numbers_and_end_at_the_ends() -> None:
    values = np.linspace(0, 2, 9)
    assert (np.diff(lightness(colours_of(values, 0, 2))) > 0).all()
    assert colour_of(-5, 0, 2) == colour_of(0, 0, 2) != colour_of(9, 0, 2) == colour_of(2, 0, 2)


@pytest.mark.parametrize("value", [0.0101, 0.02, 0.37, 1.0, 7.9, 8.3, 64.0, 999.0])
def test_ends_of_scales_are_round_and_hold_the_value(value: float) -> None:
    assert value <= round_up(value) < 2.01 * value
    assert value / 2.51 < round_down(value) <= value * (1 + 1e-9)


def test_magnified_arrows_fit_their_room() -> None:
    assert magnification(0.3, 60) == 200 and magnification(0.31, 60) == 100
    assert magnification(100, 60) == 1 == magnification(0.0, 60)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0342, "0.034"), (0.416, "0.42"), (3.14, "3.1"), (3.0, "3"), (12.4, "12"), (np.nan, "–")],
)
def test_figures_have_the_digits_that_they_are_worth(value: float, text: str) -> None:
    assert figure(value) == text


def test_distortion_is_what_opencv_projects(paper_camera: Camera) -> None:
    ideal, seen = distorted_grid(paper_camera)
    rays = np.c_[cv2.undistortPoints(ideal, paper_camera.K, np.zeros(5))[:, 0], np.ones(len(ideal))]
    zero = np.zeros(3)
    expected = cv2.projectPoints(rays, zero, zero, paper_camera.K, paper_camera.distortion)[0]
    np.testing.assert_allclose(seen, expected[:, 0], atol=1e-6)


def test_distortion_picture_is_bright_where_the_lens_bends(paper_camera: Camera) -> None:
    picture = distortion_picture(paper_camera, SIZE, dark=True)
    assert picture.shape == (360, 640, 3) and picture.dtype == np.uint8
    # Between the arrows: at the right border, and next to the middle.
    border, middle = (
        lightness(picture[20:340, 638]),
        lightness(picture[160:164, 336:340].reshape(-1, 3)),
    )
    assert border.min() > middle.max() + 10
    assert distortion_magnification(paper_camera) >= 1
    perfect = paper_camera.without_distortion()
    assert largest_shift_px(perfect) < 1e-9


def test_picture_of_a_lens_that_folds_has_gaps_not_numbers() -> None:
    folding = Camera(1280, 720, 640, 640, 639.5, 359.5, k1=-0.4)
    picture = distortion_picture(folding, SIZE, dark=False)
    corner = picture[:40, :40].astype(int)
    assert (np.ptp(corner, axis=2) < 12).all(), "stripes in neutral colours"


def test_coverage_counts_every_corner_once(guided: Snapshot) -> None:
    counts = coverage(guided.views, guided.camera.image_size)
    assert counts.sum() == sum(view.observation.count for view in guided.views)
    picture = coverage_picture(guided.views, guided.camera.image_size, SIZE, dark=True)
    u, v = guided.views[0].observation.corners[0] / 2
    assert (picture[round(v), round(u)] > 200).all(), "a white dot on each corner"


def test_residuals_are_drawn_along_the_misfit(guided: Snapshot) -> None:
    """One corner that is off by (3, -2) px: the line leads that way."""
    view = guided.views[0]
    errors = np.zeros_like(view.errors)
    errors[0] = (3.0, -2.0)
    # All others sit exactly, so nothing but the one line is longer than a dot.
    off = replace(view, errors=errors)
    size = guided.camera.image_size
    stretch = residual_magnification((view,), size)
    assert residual_magnification((off,), size) >= 1
    picture = residual_picture((off,), size, size, dark=True)
    tip = off.observation.corners[0] + errors[0] * residual_magnification((off,), size)
    ground = picture[2, 2].astype(int)
    assert np.abs(picture[round(tip[1]), round(tip[0])] - ground).max() > 60
    assert stretch > 1


def test_now_and_next_share_one_scale_and_the_colours_are_the_errors(guided: Snapshot) -> None:
    known, target = guided.uncertainty, guided.target
    assert known is not None and target is not None
    after = known.predicted_at(target.pose)
    assert after is not None
    now, then = map_of(guided, "now", dark=True), map_of(guided, "after", dark=True)
    assert now.ticks == then.ticks == error_ticks(guided)
    low, _, high = now.ticks
    assert low <= np.nanmin(after) and np.nanmax(known.uncertainty_map) <= high
    for shown, errors in ((now, known.uncertainty_map), (then, after)):
        assert shown.picture is not None
        for row, column in ((12, 18), (3, 4), (20, 30)):
            y, x = round((row + 0.5) * 15 - 0.5), round((column + 0.5) * 640 / 36 - 0.5)
            share = np.log(errors[row, column] / low) / np.log(high / low)
            told = colour_of(float(share), 0.0, 1.0)
            assert np.abs(shown.picture[y, x] - np.array(told)).max() <= 6


def test_every_map_has_words_and_an_accessible_picture(guided: Snapshot) -> None:
    for kind in MAP_KINDS:
        for dark in (True, False):
            html = map_html(map_of(guided, kind, dark=dark))
            assert "<img alt='" in html and "{" not in html and "nan" not in html
    bare = replace(guided, uncertainty=None, calibration=None, target=None)
    for kind in MAP_KINDS:
        html = map_html(map_of(bare, kind, dark=True))
        assert "<img" not in html and "v-line" in html


def test_card_tells_the_view_and_what_if(guided: Snapshot) -> None:
    known = guided.uncertainty
    assert known is not None
    for view in guided.views:
        html = view_html(guided, view.number, "data:image/jpeg;base64,AAAA")
        left = known.without(view.number)
        assert left is not None
        assert f"data-view='{view.number}'" in html and "data:image" in html
        assert f"<td>{figure(left.uncertainty_px)} px</td>" in html
        assert f"<td>{figure(known.uncertainty_px)} px</td>" in html
        assert "{" not in html and "nan" not in html
    assert view_html(guided, 99) == ""


@pytest.mark.parametrize(
    ("change", "kind", "said"),
    [
        (0.5, "worse", "50 % less certain"),
        (-0.4, "better", "40 % more certain"),
        (0.01, "same", "hardly"),
        (-0.01, "same", "hardly"),
        (np.nan, "unknown", "not determine"),
    ],
)
def test_one_judgement_of_a_view_and_all_that_is_said_follows_it(
    guided: Snapshot, monkeypatch: pytest.MonkeyPatch, change: float, kind: str, said: str
) -> None:
    """A view that hardly matters does no harm and gave nothing in the line above."""
    known = guided.uncertainty
    assert known is not None
    left = known.without(2)
    assert left is not None
    other = replace(left, uncertainty_px=known.uncertainty_px * (1 + change))
    monkeypatch.setattr(type(known), "without", lambda *_: other)
    judged = judgement(guided, 2)
    assert judged.kind == kind and said in judged.sentence
    html = view_html(guided, 2)
    assert escape(judged.sentence) in html
    assert ("What it gave" in html) == (kind == "worse") and "harm" not in html


def test_a_view_that_a_warning_wants_out_is_not_recommended_by_its_card(guided: Snapshot) -> None:
    warned = Diagnosis("outlying-view", "View 2 fits worse.", "Leave it out.", (2,))
    html = view_html(replace(guided, diagnoses=(warned,)), 2)
    assert "Leave it out" in html and "Leave it in" not in html and "What it gave" not in html


def test_parameters_say_value_sigma_trend_and_what_they_are(guided: Snapshot) -> None:
    html = parameters_html(guided)
    assert html.count("class='v-row") == len(PARAMETERS) == html.count("class='v-does'")
    calibration = guided.calibration
    assert calibration is not None
    assert f"{calibration.camera.fx:.0f}"[:3] in html
    assert html.count("<polyline") == len(PARAMETERS)
    drawn = sparkline(guided.history, 0)
    heights = [float(p.split(",")[1]) for p in drawn.split("points='")[1].split("'")[0].split(" ")]
    sigmas = [entry.sigma[0] for entry in guided.history if (entry.sigma > 0).all()]
    # Lower is surer: the drawing orders the views as their sigmas do.
    assert list(np.argsort(heights)) == list(np.argsort(-np.array(sigmas)))
    assert sparkline(guided.history[:1], 0) == ""
