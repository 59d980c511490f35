"""A recorded session as one HTML file that is opened without a network, for a class or a colleague.

A page for each captured view, with its picture, why this pose was asked for, the four steps there
from the view before, and what was known before and after; then a page with the result. The scene of
a page is the board on its way.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial
from html import escape

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import translated
from venus3d.render.annotated_picture import annotate, small_picture
from venus3d.render.describe import SceneOptions, describe
from venus3d.render.framing import content_of
from venus3d.render.offscreen import Offscreen
from venus3d.render.palette import step_style
from venus3d.render.projections import Projections
from venus3d.render.viewpoints import OUTSIDE, view_along
from venus3d.scene.pages.guide import replay_texts as say
from venus3d.scene.pages.guide.replay import Worker, picture_of
from venus3d.scene.pages.guide.replay_film import known_sentence
from venus3d.scene.pages.guide.replay_scene import seen_from, steps_to, way_of
from venus3d.scene.pages.guide.uncertainty.captured_views import captured_view_shapes
from venus3d.scene.pages.guide.uncertainty.maps import map_html, map_of
from venus3d.scene.pages.guide.uncertainty.parameters import parameters_html
from venus3d.scene.web.offline_document import OfflinePage, offline_document, step_figure
from venus3d.scene.web.projections_panel import encoded
from venus3d.scene.web.scene_recording import (
    ASPECT,
    FPS,
    player,
    recording_of,
    recording_server,
)
from venus3d.scene.web.server import LocalServer
from venus3d.storage.session_moments import Moment

_PICTURE_WIDTH, _STEP_WIDTH = 960, 480
_REST_S, _VIEW_S = 1.4, 0.6


def replay_document(moments: Sequence[Moment], settings: Settings, name: str) -> bytes:
    """The file's content, with the session's `name` in the title; takes as long as the calibrations
    and searches."""
    with closing(Worker(moments, settings)) as worker:
        snapshots = worker.finish()
    with closing(Offscreen()) as offscreen, recording_server() as server:
        page = partial(_view_page, server, Projections(offscreen))
        pages = [page(*one) for one in _captures(moments, snapshots)]
        pages.append(_result_page(server, moments[-1], snapshots[-1]))
    began = f"{moments[0].at:%Y-%m-%d %H:%M}"
    summary = say.DOCUMENT_SUMMARY.format(began=began, views=len(snapshots[-1].captured or ()))
    title = say.DOCUMENT_TITLE.format(name=name)
    return offline_document(title, summary, pages, player()).encode()


class _Capture:
    """A view, and what was known before and after it."""

    def __init__(self, moment: Moment, before: Snapshot, after: tuple[Moment, Snapshot]) -> None:
        self.moment, self.before, self.after = moment, before, after


def _captures(
    moments: Sequence[Moment], snapshots: Sequence[Snapshot]
) -> Iterator[tuple[_Capture, Snapshot | None, bool]]:
    """Each captured view, the snapshot of the view before it, and whether it counts in the end."""
    last: Snapshot | None = None
    kept = snapshots[-1].captured or ()
    for index, (moment, snapshot) in enumerate(zip(moments, snapshots, strict=True)):
        if moment.kind != "captured":
            continue
        next_one = min(index + 1, len(moments) - 1)
        after = moments[next_one], snapshots[next_one]
        yield _Capture(moment, snapshot, after), last, moment.number in kept
        last = snapshot


def _view_page(
    server: LocalServer,
    projections: Projections,
    capture: _Capture,
    last: Snapshot | None,
    counts: bool,
) -> OfflinePage:
    moment, snapshot = capture.moment, capture.before
    steps = steps_to(snapshot, last)
    parts = [f"<h2>{escape(say.DOCUMENT_VIEW.format(number=moment.number))}</h2>"]
    if not counts:
        parts.append(f"<p><b>{escape(say.TAKEN_BACK)}</b></p>")
    if snapshot.target is not None:
        parts.append(f"<p>{escape(translated(snapshot.target.reason))}</p>")
    parts.append(_picture(moment, snapshot))
    parts.append(f"<h3>{escape(say.BEFORE)}</h3><p>{escape(known_sentence(moment, snapshot))}</p>")
    parts.append(f"<h3>{escape(say.AFTER)}</h3><p>{escape(known_sentence(*capture.after))}</p>")
    if steps is not None:
        parts.append(f"<h3>{escape(say.STEPS_FROM_UPRIGHT if last is None else say.STEPS)}</h3>")
        figures = "".join(_figure(projections, snapshot, step) for step in steps)
        parts.append(f"<div class='steps'>{figures}</div>")
    way = list(way_of(snapshot, steps, FPS, dark=False))
    seen = seen_from(way, steps, FPS, ASPECT)
    return OfflinePage("".join(parts), recording_of(server, way, seen, dark=False))


def _result_page(server: LocalServer, moment: Moment, snapshot: Snapshot) -> OfflinePage:
    shown = map_html(map_of(snapshot, "now", dark=False))
    html = (
        f"<h2>{escape(say.DOCUMENT_RESULT)}</h2><p>{escape(known_sentence(moment, snapshot))}</p>"
        f"{parameters_html(snapshot)}<div class='v-end-map'>{shown}</div>"
    )
    views = snapshot.views
    still = describe(
        replace(snapshot, target=None, remaining=None, pose=None),
        SceneOptions(dark=False, surroundings=False),
    )
    boards = [
        (*still, *captured_view_shapes(snapshot.board, views[:count], None, dark=False))
        for count in range(len(views) + 1)
    ]
    way = [now for now in boards for _ in range(round(_VIEW_S * FPS))]
    way += [way[-1]] * round(_REST_S * FPS)
    view = view_along(OUTSIDE, content_of(way[-1]).points, ASPECT)
    return OfflinePage(html, recording_of(server, way, view, dark=False))


def _picture(moment: Moment, snapshot: Snapshot) -> str:
    """The view as captured, with its corners and the target."""
    image = picture_of(moment)
    if image is None:
        return f"<p>{escape(say.NO_PICTURE)}</p>"
    rgb = small_picture(image, _PICTURE_WIDTH)
    annotate(rgb, snapshot, moment.seen, 4, step_style(4).colour(True))
    alt = escape(say.DOCUMENT_VIEW.format(number=moment.number), quote=True)
    return f"<img class='lens' alt='{alt}' src='{encoded(rgb)}'>"


def _figure(projections: Projections, snapshot: Snapshot, step: Step) -> str:
    camera, words = snapshot.camera, step_prompt(step)
    size = (_STEP_WIDTH, round(_STEP_WIDTH * camera.height / camera.width))
    picture = projections.of_step(
        step, camera, snapshot.board, size=size, dark=False, header=False
    ).result()
    alt = say.STEP_ALT.format(number=step.number)
    return step_figure(step, picture, alt, translated(words.holder), "", dark=False)
