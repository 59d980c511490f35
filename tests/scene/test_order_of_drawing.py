"""What a tab is sent first when the board moves and a new target comes in the same moment."""

from __future__ import annotations

import time
from typing import Any

from tests.scene.raw_client import RawClient
from venus3d.engine.snapshot import Snapshot
from venus3d.scene.guide.viewer import Viewer
from venus3d.scene.offscreen import Offscreen
from venus3d.scene.projections import Projections


def test_the_board_moves_before_maps_and_pictures_come(
    guided: Snapshot, painter: Offscreen
) -> None:
    """These take longer than all the rest, and nobody waits for them. All come, too, though no
    frame comes any more."""
    viewer = Viewer("127.0.0.1", 8310, projections=Projections(painter))
    try:
        with RawClient(viewer.port) as tab:
            tab.look()
            tab.backlog()
            viewer.show(guided)
            came: list[dict[str, Any]] = []
            until = time.monotonic() + 20
            while time.monotonic() < until and not (
                first(came, "class='v-map'") and first(came, "<img alt='Step 4")
            ):
                came += tab.window(timeout=20)
        board = next(
            place for place, message in enumerate(came) if message.get("name") == "/board/live"
        )
        drawn = first(came, "class='v-map'"), first(came, "<img alt='Step 4")
        assert board < min(drawn) < len(came), [message["type"] for message in came]
    finally:
        viewer.close()


def first(came: list[dict[str, Any]], text: str) -> int:
    """Place of the first message that puts this on the page; 0 if none came yet."""
    for place, message in enumerate(came):
        if text in str(message.get("updates", {}).get("content", "")):
            return place
    return 0
