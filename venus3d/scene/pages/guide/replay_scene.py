"""The scene of a recorded session: how the board came to each view."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.engine.guidance.remaining import RemainingStep, RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.describe import SceneOptions, describe
from venus3d.render.framing import best_direction, content_of
from venus3d.render.shapes import Shape
from venus3d.render.step_shapes import pose_during
from venus3d.render.viewpoints import SceneCamera, view_along

_STEP_S, _REST_S = 1.2, 1.4


def steps_to(snapshot: Snapshot, last: Snapshot | None) -> Steps | None:
    """The four steps from the board in the view before, or from the upright one; None without a
    target."""
    if snapshot.target is None:
        return None
    start = None if last is None else last.pose
    return decompose(snapshot.target.pose, snapshot.camera, snapshot.board, start)


def way_of(
    snapshot: Snapshot, steps: Steps | None, fps: int, *, dark: bool
) -> Iterator[tuple[Shape, ...]]:
    """The scene, `fps` a second: the board through the steps, then as it was captured."""
    for step in steps or ():
        if step.is_idle:
            continue
        assert steps is not None
        remaining = _remaining(steps, step.number)
        options = SceneOptions(step=step.number, dark=dark)
        for share in np.linspace(0, 1, round(_STEP_S * fps)):
            pose = pose_during(step, float(share))
            yield describe(replace(snapshot, pose=pose, remaining=remaining), options)
    there = describe(replace(snapshot, remaining=None), SceneOptions(dark=dark))
    yield from [there] * round(_REST_S * fps)


def _remaining(steps: Steps, active: int) -> RemainingSteps:
    one, two, three, four = (
        RemainingStep(step, step.is_idle or step.number < active, step_prompt(step))
        for step in steps
    )
    return RemainingSteps((one, two, three, four), active, None)


def seen_from(
    way: Sequence[tuple[Shape, ...]], steps: Steps | None, fps: int, aspect: float
) -> SceneCamera:
    """From where all of this, the board on its way through these steps, is seen well."""
    content = content_of([*way[0], *way[-1]], steps or ())
    points = np.concatenate([content_of(now).points for now in way[::fps]])
    return view_along(best_direction(content, aspect), points, aspect)
