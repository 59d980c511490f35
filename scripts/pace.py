"""How steadily the page is served while a calibration and searches run: `make pace`.

Starts the program on the simulated camera, connects to it as a browser would, but reads the bare
messages, and measures the gaps between them: those that move the board and those that bring the
live picture. A stall of the server is a gap, whatever caused it. The simulated camera renders its
pictures on the same processor, which a real one does not: a recording tells more of real cameras.
Meanwhile it presses C (capture: a calibration and a search) and G (another target: a search) in
turn, so that a calibration or a search begins that often. With --updates it goes on and tells the
program's memory; a recording, which starts again at its end, suits that best. A benchmark, no test:
it prints figures and fails at nothing.

    python scripts/pace.py [--seconds 40] [--press-every 1.7] [--json]
    python scripts/pace.py -- recording.mp4 --board.columns 12 ...
    python scripts/pace.py --updates 10000 -- recording.mp4
"""

from __future__ import annotations

import argparse
import itertools
import json
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import msgspec
import numpy as np
import psutil
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Subprotocol

_WARM_UP_S = 8.0
STALL_MS = 100.0
CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": (1, 0, 0, 0),
    "position": (0, 0, 0),
    "look_at": (0, 0, 1),
    "up_direction": (0, -1, 0),
    "fov": 1.0,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 1080,
    "image_width": 1920,
}
SIMULATED = ["sim", "--autopilot", "--speed", "2"]


@dataclass
class Tab:
    """What a tab has been sent, and its keyboard."""

    socket: Connection
    raw: SimpleQueue[tuple[float, bytes]] = field(default_factory=SimpleQueue)
    """As it came, with the time, seconds."""
    scene: list[float] = field(default_factory=list)
    """When the board was moved."""
    picture: list[float] = field(default_factory=list)
    """When the live picture came."""
    commands: dict[str, str] = field(default_factory=dict)
    """Their names in the protocol, by key."""

    def receive(self) -> None:
        """Note when things come, and nothing else, which would delay the next one."""
        with suppress(ConnectionClosed):
            for raw in self.socket:
                self.raw.put((time.monotonic(), bytes(raw)))  # type: ignore[arg-type]

    def read(self) -> None:
        """Look at all that has come."""
        while not self.raw.empty():
            now, raw = self.raw.get()
            batch = messages(raw)
            for message in batch:
                if message["type"] == "RegisterCommandMessage":
                    props = message["props"]
                    if not props["modifier"]:
                        self.commands[props["hotkey"]] = message["uuid"]
            kinds = {kind_of(message) for message in batch}
            self.scene += [now] * ("scene" in kinds)
            self.picture += [now] * ("picture" in kinds)

    def press(self, key: str) -> None:
        """Do what the page does when somebody presses this key."""
        self.send({"type": "CommandTriggerMessage", "uuid": self.commands[key]})

    def send(self, message: dict[str, Any]) -> None:
        """One message to the program."""
        self.socket.send(msgspec.msgpack.encode(message))


@contextmanager
def opened(address: str) -> Generator[Tab]:
    """A tab on this page."""
    with connect(
        address.replace("http", "ws"),
        subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
        max_size=None,
        compression=None,
    ) as socket:
        tab = Tab(socket)
        tab.send(CAMERA)  # a tab that has not said where it looks from is not heard
        threading.Thread(target=tab.receive, daemon=True).start()
        yield tab


def messages(raw: bytes) -> list[dict[str, Any]]:
    """The messages in one frame of viser's protocol, binary parts left out."""
    whole, packed = (int.from_bytes(raw[i : i + 8], "little") for i in (0, 8))
    inner = zstandard.ZstdDecompressor().decompress(raw[16 : 16 + packed], max_output_size=whole)
    return list(msgspec.msgpack.decode(inner)["messages"])


def kind_of(message: dict[str, Any]) -> str:
    """scene: the board as it is now moved; picture: the frustum's live picture came."""
    if message.get("name") == "/board/live" and message["type"] == "SetPositionMessage":
        return "scene"
    updated = message.get("updates", {})
    if message.get("name") == "/camera/frustum" and "_image_data" in updated:
        return "picture"
    return ""


def gaps_told(name: str, times: list[float], since: float, until: float) -> dict[str, float]:
    """Rate and gaps of the messages between two times; that none came any more is a gap, too."""
    kept = [moment for moment in times if since <= moment <= until]
    gaps = 1000 * np.diff([since, *kept, until])
    told = {
        "per_second": len(kept) / (until - since),
        "median_ms": float(np.median(gaps)),
        "p99_ms": float(np.percentile(gaps, 99)),
        "longest_ms": float(gaps.max()),
        "stalls": int((gaps > STALL_MS).sum()),
    }
    print(
        f"{name:8} {told['per_second']:5.1f} a second, gaps {told['median_ms']:.0f} ms median, "
        f"{told['p99_ms']:.0f} ms in 99 %, {told['longest_ms']:.0f} ms longest, "
        f"{told['stalls']} above {STALL_MS:.0f} ms"
    )
    return told


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seconds", type=float, default=40.0, help="how long gaps are measured")
    parser.add_argument("--updates", type=int, default=0, help="scene updates for the memory")
    parser.add_argument(
        "--press-every", type=float, default=1.7, help="seconds between C and G; 0: never"
    )
    parser.add_argument("--port", type=int, default=8440)
    parser.add_argument("--json", action="store_true")
    parser.add_argument(
        "arguments", nargs="*", default=SIMULATED, help="of venus3d guide, after --"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as output:
        # So many views that the search goes on whatever is captured.
        where = ["--port", str(options.port), "--output", output, "--max-views", "1000"]
        program = subprocess.Popen(
            [sys.executable, "-m", "venus3d", "guide", *options.arguments, *where],
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            assert program.stdout is not None
            address = next(
                found.group()
                for line in program.stdout
                if (found := re.search(r"http://\S+", line))
            )
            with opened(address) as tab:
                told = measured(tab, program, options)
        finally:
            program.terminate()
            program.wait(timeout=30)
        results = sorted(Path(output).rglob("result.json"))
        if results:
            told["views"] = json.loads(results[-1].read_text())["views"]
            print(f"views    {told['views']}")
    if options.json:
        print(json.dumps(told))


def measured(
    tab: Tab, program: subprocess.Popen[str], options: argparse.Namespace
) -> dict[str, Any]:
    """The figures of a running program."""
    keys = itertools.cycle("CG")
    read_for(tab, _WARM_UP_S)
    since = time.monotonic()
    while time.monotonic() < since + options.seconds:
        time.sleep(options.press_every or 1.0)
        if options.press_every:
            tab.press(next(keys))
    until = time.monotonic()
    tab.read()  # only now: unpacking it meanwhile would take the processor from what is measured
    told: dict[str, Any] = {
        "scene": gaps_told("scene", tab.scene, since, until),
        "picture": gaps_told("picture", tab.picture, since, until),
    }
    sizes: list[tuple[int, float]] = []
    while len(tab.scene) < options.updates and program.poll() is None:
        sizes.append((len(tab.scene), psutil.Process(program.pid).memory_info().rss / 2**20))
        tab.press("G")  # no C: another view is rightly kept
        read_for(tab, 5.0)
    told["memory_mib"] = sizes
    if sizes:
        each = sizes[:: max(1, len(sizes) // 8)] + sizes[-1:]
        print("memory   " + ", ".join(f"{size:.0f} MiB at {count}" for count, size in each))
    return told


def read_for(tab: Tab, seconds: float) -> None:
    """Let the program work, and look at what comes."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        time.sleep(0.1)
        tab.read()


if __name__ == "__main__":
    main()
