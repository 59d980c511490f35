"""The second monitor's address: what is asked for, told, and refused in one sentence."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from venus3d.cli.guide import open_audience
from venus3d.engine.errors import VenusError
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.controls import AudienceControls
from venus3d.scene.pages.audience.run import announcement
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.monitor import audience_address


@pytest.mark.parametrize(
    ("text", "host", "port"),
    [
        ("8090", "127.0.0.1", 8090),
        ("0.0.0.0:8090", "0.0.0.0", 8090),
        ("localhost:9000", "localhost", 9000),
        ("[::1]:9000", "::1", 9000),
    ],
)
def test_an_address_is_a_port_with_or_without_a_host(text: str, host: str, port: int) -> None:
    assert audience_address(text, 8080) == (host, port)


@pytest.mark.parametrize("text", ["", "host", "host:", ":8090", "8090x", "-1", "1.5", "a:b:c"])
def test_what_is_no_address_is_said_with_an_example(text: str) -> None:
    with pytest.raises(VenusError, match=r"0\.0\.0\.0:8090"):
        audience_address(text, 8080)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (GuideOptions(audience="8080"), "a port of its own"),
        (GuideOptions(audience="0.0.0.0:8080"), "a port of its own"),
        (GuideOptions(audience="8090", headless=True), "--headless"),
        (GuideOptions(audience_mirror=False), "--audience"),
        (GuideOptions(audience_view="lens"), "--audience"),
    ],
)
def test_what_does_not_go_together_is_refused(options: GuideOptions, said: str) -> None:
    with pytest.raises(VenusError, match=said):
        options.check()


def test_a_taken_port_is_refused_and_not_replaced() -> None:
    """Whoever sits at the other monitor was told this address."""
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = holder.getsockname()[1]
        with pytest.raises(VenusError, match=f"Port {port} is taken"):
            open_audience(GuideOptions(audience=str(port)))


@pytest.mark.parametrize("text", ["203.0.113.7:8378", "no.such.host.invalid:8378", "70000"])
def test_an_address_that_cannot_be_had_is_one_sentence(text: str) -> None:
    with pytest.raises(VenusError, match=r"127\.0\.0\.1|70000"):
        open_audience(GuideOptions(audience=text))


def test_who_can_look_is_told() -> None:
    """For this machine only unless asked; otherwise an address that others can type."""
    assert open_audience(GuideOptions()) is None
    port = free_port()
    options = GuideOptions(audience=str(port), audience_view="lens", audience_light=True)
    options.check()
    alone = open_audience(options)
    assert alone is not None
    try:
        assert alone.state == AudienceState(lens=True, light=True)
        assert f"http://127.0.0.1:{port} " in announcement(alone)
        assert "ther machines" not in announcement(alone)
    finally:
        alone.close()
    everybody = open_audience(replace(options, audience=f"0.0.0.0:{free_port()}"))
    assert everybody is not None
    try:
        said = announcement(everybody)
        assert "without a password" in said and "0.0.0.0" not in said and "token" not in said
    finally:
        everybody.close()
    some = open_audience(replace(options, audience=f"0.0.0.0:{free_port()}", audience_token=True))
    assert some is not None
    try:
        assert announcement(some).count("?token=") == 2 and "password" not in announcement(some)
    finally:
        some.close()


def test_the_second_monitors_keys_are_nobody_elses_and_stand_in_the_help() -> None:
    """A key that does two things at once was seen before this was checked."""
    audience = Audience("127.0.0.1", free_port())
    viewer = Viewer(port=free_port(), draggable_board=True)
    try:
        viewer.extend(lambda server: AudienceControls(server, audience).commands)
        with pytest.raises(ValueError, match="two commands for one key"):
            viewer.extend(lambda server: AudienceControls(server, audience).commands)
    finally:
        viewer.close()
        audience.close()


@pytest.mark.slow
def test_the_program_shows_both_pages_the_same_calibration(tmp_path: Path) -> None:
    """A picture, the steps and a captured view arrive at the second page; Ctrl-C ends both."""
    port = free_port()
    words = f"sim --autopilot --speed 3 --camera-size 640x360 --audience {port}"
    words += f" --port {free_port()}"
    words += " --audience-view lens --output"
    program = subprocess.Popen(
        [sys.executable, "-m", "venus3d", "guide", *words.split(), str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    try:
        assert program.stdout is not None
        assert any(f"http://127.0.0.1:{port}" in line for line in program.stdout)
        seen: set[str] = set()
        deadline = time.monotonic() + 120
        with RawClient(port) as looking:
            looking.look()
            while seen < {"picture", "step", "captured", "3D"} and time.monotonic() < deadline:
                for message in looking.window(timeout=60):
                    html = str(message.get("updates", {}).get("content", ""))
                    seen |= {"picture"} if "_data" in message.get("updates", {}) else set()
                    seen |= {"step"} if "v-is-step" in html else set()
                    seen |= {"captured"} if texts.CAPTURED[2] in html else set()
                    seen |= {"3D"} if str(message.get("name")).startswith("/steps/") else set()
        assert seen == {"picture", "step", "captured", "3D"}
        program.send_signal(signal.SIGINT)
        _, err = program.communicate(timeout=60)
        assert "Traceback" not in err, err
    finally:
        program.kill()
