"""How steadily the page is served while a calibration and searches run: `make pace`.

Starts the program on the simulated camera, connects to it as a browser would, but reads the bare
messages, and measures the gaps between them: those that move the board and those that bring the
live picture. A stall of the server is a gap, whatever caused it. The simulated camera renders its
pictures on the same processor, which a real one does not: a recording tells more of real cameras.
With --updates it goes on and tells the program's memory; a recording, which starts again at its
end, suits that best. A benchmark, no test: it prints figures and fails at nothing.

    python scripts/pace.py [--seconds 40] [--json]
    python scripts/pace.py -- recording.mp4 --board.columns 12 ...
    python scripts/pace.py --updates 10000 -- recording.mp4
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
import psutil
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

_WARM_UP_S = 8.0
STALL_MS = 100.0
SIMULATED = ["sim", "--autopilot", "--speed", "2"]


@dataclass
class Arrivals:
    """When messages of each kind came, seconds."""

    scene: list[float] = field(default_factory=list)
    picture: list[float] = field(default_factory=list)


def messages(raw: bytes) -> list[dict[str, Any]]:
    """The messages in one frame of viser's protocol, binary parts left out."""
    whole, packed = (int.from_bytes(raw[i : i + 8], "little") for i in (0, 8))
    inner = zstandard.ZstdDecompressor().decompress(raw[16 : 16 + packed], max_output_size=whole)
    return list(msgspec.msgpack.decode(inner)["messages"])


def frames(address: str, stop: threading.Event) -> Iterator[tuple[float, list[dict[str, Any]]]]:
    """What a tab on this page receives, with the time it came."""
    protocol: Any = f"viser-v{viser.__version__}"
    with connect(
        address.replace("http", "ws"), subprotocols=[protocol], max_size=None, compression=None
    ) as socket:
        while not stop.is_set():
            try:
                raw = socket.recv(timeout=0.5)
            except TimeoutError:
                continue
            except ConnectionClosed:
                return
            yield time.monotonic(), messages(bytes(raw))  # type: ignore[arg-type]


def listen(address: str, arrivals: Arrivals, stop: threading.Event) -> None:
    """Note when the board was moved and when the live picture came."""
    for now, batch in frames(address, stop):
        kinds = {kind for message in batch if (kind := kind_of(message))}
        if "scene" in kinds:
            arrivals.scene.append(now)
        if "picture" in kinds:
            arrivals.picture.append(now)


def kind_of(message: dict[str, Any]) -> str:
    """scene: the board as it is now moved; picture: the frustum's live picture came."""
    if message.get("name") == "/board/live" and message["type"] == "SetPositionMessage":
        return "scene"
    updated = message.get("updates", {})
    if message.get("name") == "/camera/frustum" and "_image_data" in updated:
        return "picture"
    return ""


def gaps_told(name: str, times: list[float], since: float) -> dict[str, float]:
    """Rate and gaps of the messages that came after `since`."""
    kept = np.array([moment for moment in times if moment >= since])
    gaps = 1000 * np.diff(kept)
    if gaps.size == 0:
        return {}
    told = {
        "per_second": float(len(gaps) / (kept[-1] - kept[0])),
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
    parser.add_argument("--port", type=int, default=8440)
    parser.add_argument("--json", action="store_true")
    parser.add_argument(
        "arguments", nargs="*", default=SIMULATED, help="of venus3d guide, after --"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as output:
        where = ["--port", str(options.port), "--output", output]
        program = subprocess.Popen(
            [sys.executable, "-m", "venus3d", "guide", *options.arguments, *where],
            stdout=subprocess.PIPE,
            text=True,
        )
        stop, arrivals = threading.Event(), Arrivals()
        try:
            assert program.stdout is not None
            address = next(
                found.group()
                for line in program.stdout
                if (found := re.search(r"http://\S+", line))
            )
            told = measured(address, program.pid, arrivals, stop, options)
        finally:
            stop.set()
            program.terminate()
            program.wait(timeout=30)
    if options.json:
        print(json.dumps(told))


def measured(
    address: str,
    pid: int,
    arrivals: Arrivals,
    stop: threading.Event,
    options: argparse.Namespace,
) -> dict[str, Any]:
    """The figures of a running program."""
    process = psutil.Process(pid)
    threading.Thread(target=listen, args=(address, arrivals, stop), daemon=True).start()
    time.sleep(_WARM_UP_S)
    since = time.monotonic()
    time.sleep(options.seconds)
    told: dict[str, Any] = {
        "scene": gaps_told("scene", arrivals.scene, since),
        "picture": gaps_told("picture", arrivals.picture, since),
    }
    sizes: list[tuple[int, float]] = []
    while len(arrivals.scene) < options.updates and psutil.pid_exists(pid):
        sizes.append((len(arrivals.scene), process.memory_info().rss / 2**20))
        time.sleep(5.0)
    told["memory_mib"] = sizes
    if sizes:
        each = sizes[:: max(1, len(sizes) // 8)] + sizes[-1:]
        print("memory   " + ", ".join(f"{size:.0f} MiB at {count}" for count, size in each))
    return told


if __name__ == "__main__":
    main()
