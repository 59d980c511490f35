"""The commands that serve a page, attacked from outside by whoever can open a websocket to them.

Seen before: thirty ordinary tabs, one forged message, or a camera that looks nowhere ended guide
and teach, and what had been captured was lost. Longer crowds: `python -m tests.attacks.crowd`.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import repeat
from pathlib import Path
from typing import Any

import msgspec
import pytest
from viser import _messages
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.frames import Frame, Opcode
from websockets.sync.client import connect

from tests.attacks.crowd import burst, stay
from tests.ports import free_port
from tests.scene.raw_client import AHEAD, RawClient, every_message, instance
from tests.waiting import wait_until

pytestmark = pytest.mark.slow

PAGES = {
    "guide": "guide sim --autopilot --speed 3 --camera-size 640x360 --no-tour --output {folder}"
    " --port {port}",
    "trial": "trial sim --autopilot --camera-size 640x360 --output {folder} --port {port}",
    "audience": "guide sim --autopilot --speed 3 --camera-size 640x360 --output {folder}"
    " --port {other} --audience {port}",
    "teach": "teach --port {port}",
    "practice": "practice --output {folder} --port {port}",
    "measure": "measure --port {port}",
}
LAID_OUT_FOR_EACH_TAB = ("teach", "practice")
_TABS = 8
_AT_ONCE, _PER_S = 400, 200  # messages that the server takes of a tab, as of `web/connection.py`
_FLOOD_S = float(os.environ.get("VENUS3D_FLOOD_S", "3"))
_TABS_S = float(os.environ.get("VENUS3D_CROWD_S", "3"))


class Program:
    """One of the commands, running."""

    def __init__(self, page: str, folder: Path) -> None:
        self.page, self.folder, self.port = page, folder, free_port()
        words = PAGES[page].format(port=self.port, other=free_port(), folder=folder).split()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "venus3d", *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        assert self.process.stdout is not None and self.process.stderr is not None
        self.said: list[str] = []
        watch = threading.Timer(60, self.process.kill)
        watch.start()
        wanted = re.compile(rf"http://\S+:{self.port}\b")
        while not any(wanted.search(line) for line in self.said):
            line = self.process.stdout.readline()
            assert line, self.process.stderr.read()
            self.said.append(line)
        watch.cancel()
        self.complaints: list[str] = []
        self._readers = [
            threading.Thread(target=self._read, args=pair, daemon=True)
            for pair in (
                (self.process.stdout, self.said),
                (self.process.stderr, self.complaints),
            )
        ]
        for reader in self._readers:
            reader.start()

    @staticmethod
    def _read(stream: Any, lines: list[str]) -> None:
        lines.extend(stream)

    def goes_on(self) -> bool:
        """Whether a new tab gets the page, and something moves on it."""
        if self.process.poll() is not None:
            return False
        with RawClient(self.port) as tab:
            tab.look()
            came = list[dict[str, Any]]()
            while not any(message["type"] == "ReplayDoneMessage" for message in came):
                came += tab.window(timeout=30)
            if self.page in ("teach", "practice"):  # where nothing moves but what one moves
                slider = a_slider(tab, came)
                for end in ("max", "min"):
                    tab.send(value(slider["uuid"], slider[end]))
            return bool(tab.window(timeout=30))

    def resources(self) -> tuple[int, int, int]:
        """Memory in MiB, threads, open handles (Linux)."""
        at = Path(f"/proc/{self.process.pid}")
        status = dict(line.split(":", 1) for line in (at / "status").read_text().splitlines())
        memory = int(status["VmRSS"].split()[0]) // 1024
        return memory, int(status["Threads"]), len(list((at / "fd").iterdir()))

    def end(self) -> str:
        """Ctrl-C; what it said on stderr."""
        self.process.send_signal(signal.SIGINT)
        assert self.process.wait(timeout=60) in (0, 130)
        for reader in self._readers:
            reader.join(timeout=10)
        return "".join(self.complaints)


@pytest.fixture(scope="module", params=list(PAGES))
def program(request: pytest.FixtureRequest, tmp_path_factory: Any) -> Iterator[Program]:
    program = Program(request.param, tmp_path_factory.mktemp(request.param))
    yield program
    program.process.kill()
    program.process.wait()


def value(uuid: str, value: Any) -> dict[str, Any]:
    return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}


def a_slider(tab: RawClient, came: list[dict[str, Any]]) -> dict[str, Any]:
    """One that may be moved, once the page is all there."""
    while True:
        with contextlib.suppress(TimeoutError):
            while True:
                came += tab.window(timeout=0.5)
        sliders = {m["uuid"]: m["props"] for m in came if m["type"] == "GuiSliderMessage"}
        for message in came:
            if message["type"] == "GuiUpdateMessage":
                sliders.get(message["uuid"], {}).update(message["updates"])
        for uuid, props in sliders.items():
            if props["visible"] and not props["disabled"]:
                return {**props, "uuid": uuid}


FORGED: tuple[dict[str, Any], ...] = (
    {"removed": True},
    {"props": None},
    {"props": {"value": 1}},
    {"options": []},
    {"label": 7},
    {"visible": "no"},
    {"order": "last"},
    {"is_button": False},
    {"sync_cb": None},
    {"update_cb": []},
    {"update_timestamp": "now"},
    {"uuid": "another"},
    {"value": {"a": [1, 2, {}]}},
    {"value": float("nan")},
    {"value": 1e308},
    {"value": -(2**62)},
    {"value": "x" * 2000},
    {"value": None},
    {"value": []},
    {},
    {"value": "nothing of the list", "options": ["nothing of the list"]},
)
CAMERAS: tuple[dict[str, Any], ...] = (
    {"up_direction": (0, 0, 0)},
    {"position": (0, 0, 1), "look_at": (0, 0, 1)},
    {"wxyz": (0, 0, 0, 0)},
    {"position": (float("nan"), 0, 0)},
    {"position": (1e308, 0, 0)},
    {"position": ("a", "b", "c")},
    {"position": ("nan", "0", "1e300")},
    {"up_direction": ("nan", "0", "1")},
    {"image_width": "1" * 310, "image_height": "1"},
    {"look_at": (1, 2)},
    {"fov": None},
    {"fov": 0.0},
    {"image_width": 0},
    {"image_height": -5},
)
# A person may do these: they would only end the session, or take the board out of the hand.
ALLOWED = re.compile("GuiUpdateMessage|CommandTriggerMessage|TransformControls(Update|Drag).*")
BYTES = (
    b"",
    b"\xc1",
    b"\x80",
    b"\x81\xa4type\xc0",
    b"\x81\xa4type\xa1x",
    b"\x91" * 16_000,
    b"\x81\xa4type\xb3ViewerCameraMessage",
    bytes(range(256)) * 60,
)


def test_forged_messages_change_nothing(program: Program) -> None:
    """Every property of every widget, uploads to what is none, cameras that cannot be, noise.

    Several tabs say it, each of some of the widgets: of one the server takes 200 messages a second.
    """
    with contextlib.ExitStack() as stack, ThreadPoolExecutor(_TABS) as speakers:
        tabs = [stack.enter_context(RawClient(program.port)) for _ in range(_TABS)]
        said = max(speakers.map(forge, tabs, range(_TABS), repeat(program.page)))
        assert program.goes_on()
        # Until all is heard, and what is raised in a thread of ours comes a moment later.
        time.sleep(1.0 + max(0, said - _AT_ONCE) / _PER_S)
    assert program.goes_on()


def forge(tab: RawClient, number: int, page: str) -> int:
    """Say all that nobody may, of this tab's share of widgets and scene nodes; returns how many
    messages it was."""
    backlog = tab.backlog()
    tab.look()
    if page in LAID_OUT_FOR_EACH_TAB:  # with a slider, and whatever comes beside it
        while not any(message["type"] == "GuiSliderMessage" for message in backlog):
            backlog += tab.window(timeout=60)
        with contextlib.suppress(TimeoutError):
            while True:
                backlog += tab.window(timeout=1.0)
    # In the order of the page: tabs that have a page each have other names for the same widget.
    uuids = list(dict.fromkeys(m["uuid"] for m in backlog if "uuid" in m))
    names = list(dict.fromkeys(m["name"] for m in backlog if "name" in m))
    assert len(uuids) > 5 or page == "trial"
    assert names or page == "audience"
    uuids, names = uuids[number::_TABS], names[number::_TABS]
    threading.Thread(target=read_all, args=(tab,), daemon=True).start()
    said = list[dict[str, Any]]()
    for uuid in uuids:
        said += [
            {"type": "GuiUpdateMessage", "uuid": uuid, "updates": updates} for updates in FORGED
        ]
        said += [
            {
                "type": "FileTransferStartUpload",
                "source_component_uuid": uuid,
                "transfer_uuid": uuid,
                "filename": "../x",
                "mime_type": "text/plain",
                "part_count": parts,
                "size_bytes": 0,
            }
            for parts in (0, 1)
        ]
    said += [m for m in every_message(uuids, names) if not ALLOWED.fullmatch(m["type"])]
    for message in said:
        tab.send(message)
    for camera in CAMERAS:
        tab.look(**camera)
    for raw in (*BYTES, "a text"):
        tab.send_raw(raw)
    tab.look(position=(0.0, 0.0, -1.0))
    return len(said) + len(CAMERAS) + len(BYTES) + 2


def read_all(tab: RawClient) -> None:
    with contextlib.suppress(ConnectionClosed):
        while True:
            tab.window()


def test_a_large_message_ends_that_connection_only(program: Program) -> None:
    with RawClient(program.port) as tab, pytest.raises(ConnectionClosed):
        tab.send_raw(b"x" * 20_000_000)
        read_large(tab)
    assert program.goes_on()


def read_large(tab: RawClient) -> None:
    while True:
        tab.window(timeout=20)


def test_another_page_does_not_connect(program: Program) -> None:
    for headers in ({"Origin": "http://example.org"}, {"Origin": "null"}):
        with (
            pytest.raises(InvalidStatus, match="403"),
            connect(f"ws://127.0.0.1:{program.port}", additional_headers=headers),
        ):
            pass


def test_a_flood_of_messages_holds_nobody_up(program: Program) -> None:
    """Three senders say what is heard and what is not, as fast as they can; the page goes on for
    the others, and neither memory nor threads nor handles stay taken. Before, another tab was sent
    less than one message a second meanwhile, and waited up to 6 s."""
    with RawClient(program.port) as tab:
        backlog = tab.backlog()
        tab.look()
        uuids = [m["uuid"] for m in backlog if m["type"] in ("GuiSliderMessage", "GuiTextMessage")]
    before = program.resources()
    end = time.monotonic() + _FLOOD_S
    senders = [threading.Thread(target=flood, args=(program.port, uuids, end)) for _ in range(3)]
    ping, part = Frame(Opcode.PING, b"x" * 125), Frame(Opcode.CONT, b"", fin=False)
    frames = [[ping], [Frame(Opcode.BINARY, b"", fin=False), part]]
    senders += [threading.Thread(target=stream, args=(program.port, f, end)) for f in frames]
    for sender in senders:
        sender.start()
    begun = time.monotonic()
    assert program.goes_on()
    assert time.monotonic() - begun < 20.0
    for sender in senders:
        sender.join()
    assert program.goes_on()
    memory, threads, _ = program.resources()
    assert memory - before[0] < 150  # MiB
    assert threads - before[1] <= 40  # viser answers on up to 32
    wait_until(lambda: program.resources()[2] - before[2] <= 5, "handles are closed", within_s=60)


def flood(port: int, uuids: list[str], end: float) -> None:
    camera = {**instance(_messages.ViewerCameraMessage, {}), **AHEAD}
    size = {"image_width": 1280, "image_height": 720}
    said = [
        *(msgspec.msgpack.encode(value(uuid, v)) for uuid in uuids for v in (0, 1, 0.5, "x")),
        *(msgspec.msgpack.encode({**camera, **size, "position": (0, 0, -z)}) for z in (1, 2, 3)),
        b"",
        b"x" * 16_000,
    ]
    with contextlib.suppress(ConnectionClosed, TimeoutError), RawClient(port) as tab:
        threading.Thread(target=read_all, args=(tab,), daemon=True).start()
        while time.monotonic() < end:
            for raw in said:
                tab.send_raw(raw)


def stream(port: int, frames: list[Frame], end: float) -> None:
    """Send the last of these frames as fast as possible, and again whenever it is thrown out.
    Before, answers to pings took 94 MiB in 8 s, and the parts of a message that never ends 232."""
    first, many = frames[0].serialize(mask=True), frames[-1].serialize(mask=True) * 500
    while time.monotonic() < end:
        with contextlib.suppress(ConnectionClosed, OSError), RawClient(port) as tab:
            tab.line.settimeout(1.0)
            tab.line.sendall(first)
            while time.monotonic() < end:
                tab.line.sendall(many)


def test_connections_that_say_nothing_are_counted(program: Program) -> None:
    """Lines that never finish a request leave the program handles enough for its files."""
    before = program.resources()[2]
    lines = list[socket.socket]()
    try:
        for number in range(900):
            if number % 90 == 0:
                # The system lets 100 wait until they are accepted; the next would wait a second.
                time.sleep(0.05)
            line = socket.create_connection(("127.0.0.1", program.port), timeout=10)
            line.send(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n")
            lines.append(line)
        time.sleep(1.0)
        # Sooner than the ten seconds after which any of them is closed.
        wait_until(lambda: program.resources()[2] - before <= 450, "others are turned away", 8)
    finally:
        for line in lines:
            line.close()
    wait_until(lambda: program.resources()[2] - before <= 5, "handles are closed", within_s=30)
    assert program.goes_on()


def test_a_crowd_is_served(program: Program) -> None:
    """Three hundred connections in a burst, then thirty tabs that stay."""
    for crowd, tabs in ((burst(program.port, 300), 300), (stay(program.port, 30, _TABS_S), 30)):
        assert crowd.closed == 0
        assert crowd.complete == crowd.connected == tabs
    assert program.goes_on()


def test_after_all_this_it_ends_as_ever(program: Program) -> None:
    """The last one: nothing was printed but what it says of its result, which is there."""
    if program.page in ("guide", "audience"):
        result = program.folder / "result.json"
        wait_until(result.exists, "a result", within_s=90)
        assert json.loads(result.read_text())["views"] >= 1
    complaints = program.end()
    assert "Traceback" not in complaints and "Warning" not in complaints, complaints
