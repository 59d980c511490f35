"""The German sentences of the steps are true: sign, amount and the holder's side, by scipy.

As in tests/scene/guide/test_one_truth.py, on the real guide page and second monitor. The oracle is
written from the meaning of the turns and knows neither the engine's sentences nor their table.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.ports import free_port
from tests.scene.guide.test_one_truth import Recorded, a_pair, cards_say, monitor_says
from tests.waiting import wait_until
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.snapshot import pose_snapshot
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.guide.viewer import Viewer

PAIRS = 30


@pytest.fixture(scope="module")
def pages() -> Iterator[tuple[Viewer, Audience]]:
    viewer = Viewer(port=free_port(), projections=Recorded(), language="de")
    audience = Audience("127.0.0.1", free_port(), language="de")
    yield viewer, audience
    audience.close()
    viewer.close()


def sentences(now: Any, target: Any, board: Board, wording: str) -> tuple[str, ...]:
    """What is to be done, from R' = Rz Ry Rx R (scipy's "xyz") and the way of the centre."""
    (R0, t0), (R1, t1) = now or (np.eye(3), np.array([0, 0, 0.5])), target
    rest = Rotation.from_matrix(R1) * Rotation.from_matrix(R0).inv()
    x, y, z = rest.as_euler("xyz", degrees=True)
    mm = 1000 * (t1 - t0)
    # The holder faces the camera: the picture's right is their left.
    side = ("rechts", "links") if (mm[0] > 0) == (wording == "camera") else ("links", "rechts")
    seen = "im Bild " if wording == "camera" else ""
    ways = (
        f"{seen}nach {side[0]}",
        f"nach {'unten' if mm[1] > 0 else 'oben'}",
        "von der Kamera weg" if mm[2] > 0 else "zur Kamera",
    )
    limit_mm = 35 * min(board.width, board.height)
    near_mm = 0 if now is None else limit_mm / np.sqrt(3)  # what is right already is left out
    far = [abs(v) > near_mm and abs(v) >= 0.5 for v in mm]
    told = [f"{abs(v):.0f} mm {way}" for v, way in zip(mm, ways, strict=True)]
    parts = [part for part, is_far in zip(told, far, strict=True) if is_far]
    parts = parts if len(parts) < 2 else [f"{', '.join(parts[:-1])} und {parts[-1]}"]
    edge = "rechte" if (y > 0) == (wording == "camera") else "linke"
    clockwise = (z > 0) == (wording == "camera")
    said = (
        f"Das Brett {parts[0] if parts else ''}.",
        f"Die {'Ober' if x > 0 else 'Unter'}kante um {abs(x):.0f}° zur Kamera kippen.",
        f"Die {seen}{edge} Kante um {abs(y):.0f}° zur Kamera schwenken.",
        f"Das Brett um {abs(z):.0f}° {'im' if clockwise else 'gegen den'} Uhrzeigersinn drehen.",
    )
    done = (np.linalg.norm(mm) <= limit_mm, *(abs(np.array([x, y, z])) <= 2.5))
    return tuple(
        "Dieser Schritt ist fertig; so lassen." if d and now is not None else s
        for d, s in zip(done, said, strict=True)
    )


@pytest.mark.parametrize("wording", ["holder", "camera"])
def test_german_steps_agree_with_scipy(
    wording: str, pages: tuple[Viewer, Audience], paper_camera: Camera, default_board: Board
) -> None:
    (viewer, audience), rng, before = pages, np.random.default_rng(21), None
    viewer.change(lambda state: replace(state, camera_words=wording == "camera"))
    monitored = 0
    for case in range(PAIRS):
        now, target = a_pair(rng, case)
        pose = None if now is None else Pose(*now)
        before = pose_snapshot(default_board, paper_camera, pose, Pose(*target), before)
        viewer.show(before)
        audience.show(before)
        shall = sentences(now, target, default_board, wording)
        wait_until(
            lambda shall=shall: tuple(words for _, _, words in cards_say(viewer)["cards"]) == shall,
            f"{case}: {shall}, not {cards_say(viewer)['cards']}",
        )
        held = sentences(now, target, default_board, "holder")
        open_steps = [s for s in held if not s.startswith("Dieser Schritt")]
        if now is not None and open_steps:
            monitored += 1
            wait_until(
                lambda held=open_steps[0]: monitor_says(audience)["sentence"] == held,
                f"{case}: {open_steps[0]}, not {monitor_says(audience)['sentence']}",
            )
    assert monitored > PAIRS // 2
