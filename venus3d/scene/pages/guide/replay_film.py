"""A recorded session as a film: each view's picture with its target, under what was known then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import annotate, small_picture
from venus3d.render.film import mp4
from venus3d.render.palette import step_style
from venus3d.render.projections import Picture, with_header
from venus3d.scene.pages.guide import replay_texts as say
from venus3d.scene.pages.guide.replay import Worker, picture_of
from venus3d.storage.session_moments import Moment

_WIDTH, _FPS, _SECONDS = 1280, 10, 2


def replay_film(moments: Sequence[Moment], settings: Settings) -> bytes:
    """MP4, two seconds for each moment; takes as long as the calibrations and searches."""
    with closing(Worker(moments, settings)) as worker:
        snapshots = worker.finish()
    return mp4(_pictures(moments, snapshots), _FPS)


def _pictures(moments: Sequence[Moment], snapshots: Sequence[Snapshot]) -> Iterator[Picture]:
    shape: tuple[int, ...] | None = None
    for moment, snapshot in zip(moments, snapshots, strict=True):
        picture = frame(moment, snapshot)
        shape = picture.shape if shape is None else shape
        yield from [picture[: shape[0], : shape[1]]] * (_SECONDS * _FPS)


def frame(moment: Moment, snapshot: Snapshot) -> Picture:
    """The picture of one moment (RGB), with even sides."""
    width, height = snapshot.camera.image_size
    image = picture_of(moment)
    if image is None:
        image = np.full((height, width, 3), 40, np.uint8)
    step = 4 if snapshot.remaining is None else snapshot.remaining.active
    colour = step_style(step).colour(True)
    rgb = small_picture(image, _WIDTH)
    annotate(rgb, snapshot, moment.seen, step, colour)
    title = say.FILM_TITLES[moment.kind].format(number=moment.number)
    picture = with_header(
        rgb, str(moment.number), colour, title, known_sentence(moment, snapshot), True
    )
    return picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2]


def known_sentence(moment: Moment, snapshot: Snapshot) -> str:
    """What was known then, in figures."""
    known, at = snapshot.calibration, f"{moment.at:%H:%M:%S}"
    if known is None or not all(known.free):
        return say.FILM_UNKNOWN.format(at=at)
    return say.FILM_KNOWN.format(
        at=at,
        views=len(known.views),
        rms=f"{known.rms_px:.3f}",
        fx=f"{known.camera.fx:.1f}",
        sigma=figure(float(known.sigma[0])),
        error=figure(known.uncertainty_px),
    )
