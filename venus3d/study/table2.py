"""Table 2 of the paper: cost of guidance per frame, with and without live detection.

Real 720p frames, every kind of guidance on each of them in turn, in one process:

axes      detect the board, find its pose, draw its axes and the target's (Rojtberg 2018)
steps     paste the four prepared pictures and draw the prepared outline (the paper, 3.4)
region    like axes, but search around the board's last position, as this program does live
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.board_reader import Region
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.decomposition import Step, decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.study.clip import Clip, Image
from venus3d.study.runner import Row, opencv_threads
from venus3d.study.text import table

Guidance = Literal["axes", "steps", "region"]
GUIDANCES: tuple[Guidance, ...] = get_args(Guidance)
FRAME_RATE = 25
"""Of the paper's camera, for the delay per second of video."""
PAPER_MS: dict[Guidance, float] = {"axes": 38.46, "steps": 25.24}


@dataclass(frozen=True, eq=False)
class Prepared:
    """Data of the prepared steps; made once per target."""

    target: Pose
    pictures: tuple[Image, Image, Image, Image]
    """BGR, of the four steps."""
    outlines: tuple[NDArray[np.int32], ...]
    """(4, 1, 2) pixels, the board after each step."""


@dataclass(frozen=True, eq=False)
class Costs:
    """Measured times, milliseconds per frame."""

    clip: Clip
    guiding_ms: dict[Guidance, Array]
    """(frames, 2) each: wall time, and processor time, which other programs do not affect."""
    showing_ms: Array
    """(frames, 2) to decode a frame and encode it for display, common to all guidance."""
    preparing_ms: float
    """To render the four pictures, once per target."""
    threads: int


def prepare_steps(clip: Clip, offscreen: Offscreen, rng: np.random.Generator) -> Prepared:
    """The pictures and outlines of a random target that fits the camera."""
    limits = Limits.for_board(clip.board, clip.camera)
    pose = Pose.from_vector(random_pose(Space(clip.board, clip.camera, limits), rng))
    steps = decompose(pose, clip.camera, clip.board)
    width = clip.camera.width // 4
    size = (width, round(width * clip.camera.height / clip.camera.width))
    projections = Projections(offscreen)
    one, two, three, four = (_picture(projections, step, clip, size) for step in steps)
    outlines = tuple(_outline(clip, step.after) for step in steps)
    return Prepared(pose, (one, two, three, four), outlines)


def measure(clip: Clip, prepared: Prepared, frames: int) -> tuple[dict[Guidance, Array], Array]:
    """Times, ms: (frames, 2) for each kind of guidance, and (frames, 2) for the display.

    They take turns on the same frame, each first in a third of the frames, so that neither caches
    nor machine load favours one of them.
    """
    detector = Detector(clip.board, find_layout=False)
    guides: dict[Guidance, Callable[[Image, Region | None], object]] = {
        "axes": lambda image, _: draw_axes(image, detector, clip, prepared.target, None),
        "steps": lambda image, _: draw_steps(image, prepared, 0),
        "region": lambda image, region: draw_axes(image, detector, clip, prepared.target, region),
    }
    times: dict[Guidance, list[tuple[float, float]]] = {guidance: [] for guidance in GUIDANCES}
    showing: list[tuple[float, float]] = []
    encoded = [cv2.imencode(".jpg", image)[1] for image in clip.images]
    for number in range(-3, frames):  # three to warm up
        index = number % len(clip.images)
        region = clip.region(index)
        for turn in range(len(GUIDANCES)):
            guidance = GUIDANCES[(number + turn) % len(GUIDANCES)]
            image = clip.images[index].copy()
            took = _ms(lambda w=guidance, i=image, r=region: guides[w](i, r))
            if number >= 0:
                times[guidance].append(took)
        took = _ms(lambda i=index: show(encoded[i]))
        if number >= 0:
            showing.append(took)
    return {guidance: np.array(values) for guidance, values in times.items()}, np.array(showing)


def draw_axes(
    image: Image, detector: Detector, clip: Clip, target: Pose, region: Region | None
) -> Pose | None:
    """Guidance with live detection: the board's axes and the target's, drawn into the image."""
    seen = detector.detect(image, region=region)
    pose = estimate_pose(clip.camera, clip.board, seen)
    for shown in (pose, target):
        if shown is not None:
            cv2.drawFrameAxes(
                image,
                clip.camera.K,
                clip.camera.distortion,
                shown.rvec,
                shown.t,
                clip.board.height / 2,
                3,
            )
    return pose


def draw_steps(image: Image, prepared: Prepared, step: int) -> None:
    """Guidance without detection: the four pictures along the bottom, the outline of one step."""
    bottom, left = image.shape[0], 0
    for picture in prepared.pictures:
        height, width = picture.shape[:2]
        image[bottom - height : bottom, left : left + width] = picture
        left += width
    cv2.polylines(image, [prepared.outlines[step]], True, (60, 200, 255), 3, cv2.LINE_AA)


def show(encoded: Any) -> None:
    """Common to every kind of guidance: decode a frame, and encode it for a screen."""
    picture = np.asarray(cv2.imdecode(encoded, cv2.IMREAD_COLOR))
    cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, 75])


def run_table2(clip: Clip, frames: int, threads: int, seed: int) -> Costs:
    """Prepare once, then measure, with `threads` OpenCV threads."""
    rng = np.random.default_rng(seed)
    with opencv_threads(threads), Offscreen() as offscreen:
        prepare_steps(clip, offscreen, rng)  # warms up the renderer
        started = time.perf_counter()
        prepared = prepare_steps(clip, offscreen, rng)
        preparing_ms = 1000 * (time.perf_counter() - started)
        guiding, showing = measure(clip, prepared, frames)
    return Costs(clip, guiding, showing, preparing_ms, threads)


def table2_rows(costs: Costs) -> list[Row]:
    """One row for each frame and guidance."""
    return [
        {
            "source": costs.clip.name,
            "frame": frame,
            "way": guidance,
            "guiding_ms": round(float(costs.guiding_ms[guidance][frame, 0]), 4),
            "guiding_cpu_ms": round(float(costs.guiding_ms[guidance][frame, 1]), 4),
            "showing_ms": round(float(costs.showing_ms[frame, 0]), 4),
            "showing_cpu_ms": round(float(costs.showing_ms[frame, 1]), 4),
        }
        for frame in range(len(costs.showing_ms))
        for guidance in GUIDANCES
    ]


def table2_text(costs: Costs) -> str:
    """A readable table, the paper's figures beside ours."""
    showing, showing_cpu = np.median(costs.showing_ms, axis=0).tolist()
    full_cpu = float(np.median(costs.guiding_ms["axes"][:, 1]))
    lines: list[tuple[str, ...]] = []
    for guidance in GUIDANCES:
        low, middle, high = np.quantile(costs.guiding_ms[guidance][:, 0], [0.25, 0.5, 0.75])
        cpu = float(np.median(costs.guiding_ms[guidance][:, 1]))
        paper = PAPER_MS.get(guidance)
        lines.append(
            (
                _SAID[guidance],
                f"{middle:.2f} ({low:.2f}-{high:.2f})",
                f"{cpu:.2f}",
                f"{middle * FRAME_RATE / 1000:.3f}",
                f"{cpu / full_cpu:.3f}",
                f"{(cpu + showing_cpu) / (full_cpu + showing_cpu):.3f}",
                "-" if paper is None else f"{paper:.2f} ms, {paper / PAPER_MS['axes']:.3f}",
            )
        )
    clip = costs.clip
    width, height = clip.camera.image_size
    head = (
        f"{clip.name}: {len(clip.images)} frames of {width} x {height} px, "
        f"{len(costs.showing_ms)} measurements, {costs.threads} OpenCV "
        f"thread{'' if costs.threads == 1 else 's'}; showing a frame (JPEG in, JPEG out) takes "
        f"{showing:.2f} ms more with every kind of guidance, preparing the four pictures "
        f"{costs.preparing_ms:.0f} ms once for each target"
    )
    return f"{head}\n\n{table(_HEADINGS, lines)}"


_SAID: dict[Guidance, str] = {
    "axes": "live detection and axes",
    "steps": "lazily shown steps",
    "region": "live detection in a region, axes",
}
_HEADINGS = (
    "guidance",
    "ms per frame (quartiles)",
    "processor (ms)",
    f"delay at {FRAME_RATE}/s (s)",
    "ratio (processor)",
    "with showing",
    "paper",
)


def _picture(projections: Projections, step: Step, clip: Clip, size: tuple[int, int]) -> Image:
    rgb = projections.of_step(step, clip.camera, clip.board, size=size).result()
    return np.ascontiguousarray(rgb[:, :, ::-1])


def _outline(clip: Clip, pose: Pose) -> NDArray[np.int32]:
    pixels = clip.camera.without_distortion().project(pose.apply(clip.board.outline))
    return np.rint(pixels).astype(np.int32).reshape(-1, 1, 2)


def _ms(work: Callable[[], object]) -> tuple[float, float]:
    """Wall time, and processor time over all threads of this process."""
    started, worked = time.perf_counter(), time.process_time()
    work()
    return 1000 * (time.perf_counter() - started), 1000 * (time.process_time() - worked)
