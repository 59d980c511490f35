"""Many browsers at once, by hand: they connect, say where they look from, and read what comes.

    python -m tests.attacks.crowd PORT [--tabs 30] [--seconds 300] [--burst 300]

prints what they got; `tests/attacks` runs the same, shorter.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import time
from dataclasses import dataclass

import msgspec
import viser
from viser import _messages
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.typing import Subprotocol

from tests.scene.raw_client import AHEAD, instance, messages_of

_CAMERA = msgspec.msgpack.encode(
    {**instance(_messages.ViewerCameraMessage, {}), **AHEAD}
    | {"image_width": 1280, "image_height": 720}
)


@dataclass
class Crowd:
    """What came of many browsers."""

    connected: int = 0
    closed: int = 0
    """How many were closed by the server."""
    windows: int = 0
    """How many bundles of messages they got in all."""
    complete: int = 0
    """How many got everything that a new browser is sent."""


def stay(port: int, tabs: int, seconds: float) -> Crowd:
    """So many tabs, all open for so long."""
    return asyncio.run(_stay(port, tabs, seconds))


def burst(port: int, tabs: int) -> Crowd:
    """So many tabs at one moment; each goes when it has been sent everything."""
    return asyncio.run(_stay(port, tabs, 0.0))


async def _stay(port: int, tabs: int, seconds: float) -> Crowd:
    crowd = Crowd()
    await asyncio.gather(*(_tab(port, crowd, seconds) for _ in range(tabs)))
    return crowd


async def _tab(port: int, crowd: Crowd, seconds: float) -> None:
    with contextlib.suppress(InvalidHandshake, OSError, TimeoutError):
        async with connect(
            f"ws://127.0.0.1:{port}",
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=None,
            compression=None,
            open_timeout=60,
            ping_timeout=None,
        ) as tab:
            crowd.connected += 1
            try:
                await tab.send(_CAMERA)
                await _read(tab, crowd, time.monotonic() + seconds)
            except ConnectionClosed:
                crowd.closed += 1


async def _read(tab: ClientConnection, crowd: Crowd, end: float) -> None:
    complete = False
    while not complete or time.monotonic() < end:
        try:
            async with asyncio.timeout(60 if not complete else max(0.01, end - time.monotonic())):
                raw = await tab.recv()
        except TimeoutError:
            return
        crowd.windows += 1
        if not complete and isinstance(raw, bytes):
            complete = any(m["type"] == "ReplayDoneMessage" for m in messages_of(raw))
            crowd.complete += complete


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("port", type=int)
    parser.add_argument("--tabs", type=int, default=30)
    parser.add_argument("--seconds", type=float, default=300.0)
    parser.add_argument("--burst", type=int, default=300)
    given = parser.parse_args()
    print("burst:", burst(given.port, given.burst))
    print("tabs:", stay(given.port, given.tabs, given.seconds))
    print("burst:", burst(given.port, given.burst))


if __name__ == "__main__":
    main()
