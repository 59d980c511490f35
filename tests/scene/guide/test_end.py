"""The end of a calibration: what is asked before it, what is said of it, the result to copy."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from tests.ports import free_port
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.guidance.convergence import Convergence
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.straighten import Straightener
from venus3d.scene.pages.guide.end_panel import result_html
from venus3d.scene.pages.guide.guidance_panel import guidance_html
from venus3d.scene.pages.guide.intents import PageAction, Straighten, Toggle
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.pages.measure.monitor import MeasureMonitor
from venus3d.scene.web.step_card import NO_NOTE
from venus3d.scene.web.theme import Theme

PARAMETERS = PAPER_CAMERA.parameter_names


@pytest.fixture
def guided(guided: Snapshot) -> Snapshot:
    """A session after five views, without doubts."""
    return replace(guided, diagnoses=())


def ended(guided: Snapshot, *unsettled: str) -> Snapshot:
    """The same, ended by hand; these parameters have not settled."""
    judged = tuple(name not in unsettled for name in PARAMETERS)
    convergence = Convergence(np.ones(9), judged, "repaired")
    return replace(guided, phase="finished", convergence=convergence, target=None, match=None)


def said(snapshot: Snapshot, state: ViewState | None = None) -> tuple[str, str]:
    """The badge, and all that the card says."""
    html = guidance_html(snapshot, state or ViewState(), Theme(True), NO_NOTE)
    badge = re.search(r"v-badge'>(.*?)<", html)
    assert badge is not None
    return badge.group(1), re.sub(r"<[^>]*>", " ", html)


def test_finish_is_asked_once_with_what_it_means(guided: Snapshot) -> None:
    asked = ViewState().after(PageAction.FINISH)
    known = guided.calibration
    assert known is not None
    judged = ended(guided, "k2", "p1").convergence
    badge, text = said(replace(guided, convergence=judged), asked)
    assert badge == "?" and "End now?" in text and "k2 and p1" in text
    fx, sigma = map(float, re.findall(r"fx (\S+) ± (\S+) px", text)[0])
    assert fx == pytest.approx(known.camera.fx, abs=0.1 * known.sigma[0])
    assert sigma == pytest.approx(known.sigma[0], rel=0.05)
    for answer in (PageAction.END_NOW, PageAction.GO_ON, PageAction.CAPTURE, PageAction.UNDO_VIEW):
        assert not asked.after(answer).asked_to_end


def test_views_that_do_not_count_are_told_beside_those_that_are_captured(guided: Snapshot) -> None:
    """“From 3 views” stood beside four in the film strip: one of them repeated another."""
    count = len(guided.views)
    asked = ViewState().after(PageAction.FINISH)
    assert f"from {count} views." in said(guided, asked)[1]
    more = replace(guided, captured=(*(guided.captured or ()), 99))
    assert more.captured_count == count + 1
    told = f"{count} of {count + 1} views"
    assert f"from {told}." in said(more, asked)[1]
    assert told in result_html(ended(more), "")


def test_a_question_and_a_result_are_read_while_no_pictures_come(guided: Snapshot) -> None:
    """“No new pictures” stood above the buttons “End now” and “Go on”, and in place of a result."""
    silent = ViewState(no_pictures="None since 12:00:00.")
    assert "No new pictures" in said(guided, silent)[1] and said(guided, silent)[0] == "!"
    asked, over = silent.after(PageAction.FINISH), ended(guided, "k2")
    for snapshot, state, badge in ((guided, asked, "?"), (over, silent, "■")):
        told = said(snapshot, state)
        assert told[0] == badge and "No new pictures. None since 12:00:00." in told[1]
    paused = replace(ViewState(), paused=True)
    assert "pictures are paused" in said(over, paused)[1], "“Go on” means the end there"
    assert said(guided, replace(asked, other_size=True))[0] == "!", "only a new session helps there"


def test_the_question_goes_when_the_session_ends_by_itself(guided: Snapshot) -> None:
    """After the last of --max-views it once stood beside all that said that it is over."""
    asked = ViewState().after(PageAction.FINISH)
    assert asked.seeing(guided).asked_to_end
    assert not asked.seeing(ended(guided)).asked_to_end
    converged = replace(ended(guided), phase="converged")
    settled = asked.seeing(converged)
    assert not settled.asked_to_end
    assert settled.after(PageAction.FINISH).seeing(converged).asked_to_end, (
        "it can still be asked for"
    )
    assert said(ended(guided), asked.seeing(ended(guided)))[0] == "✓"


def test_an_end_that_has_not_settled_has_no_tick(guided: Snapshot) -> None:
    badge, text = said(ended(guided, "fx", "k3"))
    assert badge != "✓" and "✓" not in text and "fx and k3" in text
    badge, text = said(ended(guided))
    assert badge == "✓" and "Not settled" not in text
    nothing = replace(ended(guided, *PARAMETERS), calibration=None, convergence=None)
    assert said(nothing)[0] != "✓"


def test_a_view_taken_back_is_not_said_to_be_captured_by_holding_still(guided: Snapshot) -> None:
    todo = guided.remaining
    assert todo is not None
    reached = replace(todo, each=tuple(replace(step, done=True) for step in todo.each))
    there = replace(guided, remaining=reached, taken_back=True)
    _, text = said(there)
    assert "Hold still" not in text and "C captures it now" in text


def test_the_result_can_be_copied_in_full(guided: Snapshot) -> None:
    known = guided.calibration
    assert known is not None and result_html(guided, "") == ""
    html = result_html(ended(guided), "Saved: here.")
    assert "Saved: here." in html
    copies = re.findall(r"data-copy='(.*?)'", html, re.DOTALL)
    values = dict(zip(re.findall(r"<b>([a-z]+\d?)</b>", html), map(float, copies[:9]), strict=True))
    for name, value in zip(PARAMETERS, known.camera.parameters, strict=True):
        assert values[name] == pytest.approx(value, rel=1e-8)
    names: dict[str, Any] = {"np": np}
    exec(copies[9], names)
    np.testing.assert_allclose(names["K"], known.camera.K, atol=1e-4)
    np.testing.assert_allclose(names["distortion"], known.camera.distortion, atol=1e-6)
    table = [line.split("\t") for line in copies[10].splitlines()]
    sigma = {row[0]: float(row[2]) for row in table if len(row) == 3}
    np.testing.assert_allclose([sigma[name] for name in PARAMETERS], known.sigma, rtol=1e-3)


def test_the_straight_picture_is_opencvs(paper_camera: Camera) -> None:
    rng = np.random.default_rng(0)
    blocks = rng.integers(0, 256, (18, 32, 3)).astype(np.uint8)
    picture = cv2.resize(blocks, (640, 360), interpolation=cv2.INTER_CUBIC).astype(np.uint8)
    small = paper_camera.scaled((640, 360))
    expected = cv2.undistort(picture, small.K, small.distortion).astype(int)
    straightener = Straightener()
    whole, half, none = picture.copy(), picture.copy(), picture.copy()
    straightener.straighten(whole, paper_camera, 1.0)
    straightener.straighten(half, paper_camera, 0.5)
    straightener.straighten(none, paper_camera, 0.0)
    inner = np.s_[20:-20, 20:-20]
    assert np.abs(whole.astype(int)[inner] - expected[inner]).max() <= 2
    assert np.array_equal(half[:, :315], whole[:, :315])
    assert np.array_equal(half[:, 325:], picture[:, 325:]) and np.array_equal(none, picture)


def test_the_picture_is_compared_at_the_end_and_whole_before(guided: Snapshot) -> None:
    state = ViewState().seeing(guided)
    assert state.straight_share == 0.0
    assert state.after(Toggle("straight")).seeing(guided).straight_share == 1.0
    over = state.seeing(ended(guided))
    assert over.straight_share == 0.5
    assert over.after(Straighten(0.8)).seeing(ended(guided)).straight_share == 0.8
    assert over.after(Toggle("straight")).straight_share == 0.0
    assert over.seeing(guided).straight_share == 0.0, "guiding again shows the picture as it comes"


def test_one_measures_with_the_camera_once_the_calibration_is_over(guided: Snapshot) -> None:
    """The page opens then, knows how well the camera is known, and follows a later result."""
    monitor, told = MeasureMonitor("127.0.0.1", free_port()), list[str]()
    monitor.on_open = told.append
    try:
        monitor.show(guided)
        assert monitor.page is None and not told
        monitor.show(ended(guided))
        page, known = monitor.page, guided.calibration
        assert page is not None and known is not None and told == [page.url]
        assert f"href='{page.url}'" in result_html(ended(guided), "", page.url)
        assert "href" not in result_html(ended(guided), "")
        page.show(known.views[0].observation)
        for corner in known.board.corners[[0, -1]]:
            page.click(known.views[0].pose.apply(corner[None])[0], 1.0)
        measured, ends = page.state.measured, known.board.corners[[0, -1]]
        assert measured is not None
        true = float(np.linalg.norm(ends[1] - ends[0]))
        assert abs(measured.length_m - true) < 4 * measured.sigma_m < 0.004
        monitor.show(replace(ended(guided), calibration=replace(known, rms_px=1.0)))
        assert page.state.measured is None and len(told) == 1
    finally:
        monitor.close()
