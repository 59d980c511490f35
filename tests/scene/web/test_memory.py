"""A page that is open all day must not grow.

Held down: a server keeps one message for each thing that can be seen, whatever number of updates
there was, and Python's own memory stays where it was. `scripts/pace.py` measures the same of the
whole program over 10 000 updates.
"""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.frames import Frame, Opcode

from tests.scene.raw_client import RawClient
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import HOLD_STILL
from venus3d.engine.guidance.remaining import remaining_steps
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.target import Target
from venus3d.render.describe import SceneOptions, describe
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer

_ROUND = 60
_TARGETS = 10


def moments(
    camera: Camera, board: Board, count: int, rng: np.random.Generator
) -> Iterator[Snapshot]:
    """A board that moves on every frame, and another target now and then."""
    targets: list[Target] = []
    nothing = np.full(9, np.nan)
    for number in range(count):
        pose = Pose.from_vector([*rng.uniform(-40, 40, 3), *rng.uniform(-0.05, 0.05, 2), 0.5])
        if number < _TARGETS:
            steps = decompose(pose, camera, board)
            targets.append(
                Target(number, pose, steps, "global", "trace", (), "", nothing, np.nan, 1, 0.0)
            )
        target = targets[number % _TARGETS]
        yield Snapshot(
            number,
            "guiding",
            board,
            camera,
            Observation.nothing(camera.image_size),
            pose,
            target,
            None,
            remaining_steps("guiding", target, None),
            None,
            None,
            (),
            "",
            HOLD_STILL,
        )


def messages_kept(server: LocalServer) -> int:
    """How many messages a tab that opens now would be sent."""
    return len(server._websock_server._broadcast_buffer.message_from_id)


@pytest.mark.slow
def test_memory_stays_flat(
    server: LocalServer, paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """After 300 more updates nothing is kept that was not kept before."""
    view = SceneView(server)
    still = list(moments(paper_camera, default_board, _ROUND, rng))

    def draw() -> None:
        for snapshot in still:
            options = SceneOptions(step=snapshot.number % 4 + 1, strip=snapshot.number % 10 == 9)
            moved = replace(snapshot, pose=Pose.from_vector([*rng.uniform(-40, 40, 3), 0, 0, 0.5]))
            view.draw(describe(moved, options), dark=True)

    draw()  # everything that can be seen has been seen
    tracemalloc.start()
    draw()
    gc.collect()
    before, (held, _) = messages_kept(server), tracemalloc.get_traced_memory()
    for _ in range(5):
        draw()
    gc.collect()
    grown = tracemalloc.get_traced_memory()[0] - held
    tracemalloc.stop()
    assert messages_kept(server) == before
    assert grown < 300_000  # bytes; one snapshot kept a time would be more


@pytest.mark.parametrize("kind", [Opcode.PING, Opcode.PONG, Opcode.CONT])
def test_frames_that_no_browser_sends_end_the_connection(server: LocalServer, kind: Opcode) -> None:
    """Each ping is answered into a buffer; a message's empty parts have no size to be limited."""
    port = server.get_port()
    with RawClient(port) as tab, RawClient(port) as other:
        tab.backlog()
        other.backlog()
        tab.line.sendall(Frame(Opcode.PING, b"").serialize(mask=True) * 20)
        tab.look()
        with pytest.raises(ConnectionClosed):
            if kind is Opcode.CONT:
                tab.line.sendall(Frame(Opcode.BINARY, b"", fin=False).serialize(mask=True))
            whole = kind is not Opcode.CONT
            tab.line.sendall(Frame(kind, b"", fin=whole).serialize(mask=True) * 200)
            tab.window(timeout=10)
        other.look()
        server.scene.add_frame("/anything")
        server.flush()
        assert other.window(timeout=10)
