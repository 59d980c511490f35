"""A page's 3D scene as a recording for viser's own player, offline too. A recording has no panels,
so labels carry what the scene must say; `offline_document` adds the words."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import zstandard

from venus3d.render.shapes import Shape
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.web.camera_rig import FAR, NEAR
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer, start_server

FPS = 15
_FIRST_PORT = 8900
_BEFOREHAND = 8  # moments; every step is longer
ASPECT = 1.3
"""Minimum aspect of the scene in the document, where the view cannot be adapted."""
_LOADER = re.compile(
    r'<script data-p="([^"]*)" data-ss="(\d+)" data-cs="(\d+)">'
    r'(.*?const A=("(?:[^"\\]|\\.)*");.*?)</script>',
    re.DOTALL,
)
"""Pattern of the player's only script: packed data, sizes of the style sheet and the script in it,
the unpacker, and its digits."""


@contextmanager
def recording_server() -> Generator[LocalServer]:
    """A server for recording only; nobody is told of it."""
    server, _ = start_server("127.0.0.1", _FIRST_PORT)
    try:
        yield server
    finally:
        server.stop()


def recording_of(
    server: LocalServer, moments: Sequence[tuple[Shape, ...]], view: SceneCamera, *, dark: bool
) -> str:
    """The base64 recording of these moments, `FPS` a second, seen from `view`. The server needs no
    browser."""
    server.scene.reset()
    scene = SceneView(server, plain_labels=True)
    _look(server, view)
    # Created hidden beforehand: a new shape appears at the camera for a moment.
    for now in (*moments[::_BEFOREHAND], moments[0]):
        scene.draw(now, dark=dark)
    serializer = server.get_scene_serializer()
    for now in moments[1:]:
        scene.draw(now, dark=dark)
        serializer.insert_sleep(1 / FPS)
    return base64.b64encode(serializer.serialize()).decode("ascii")


def player() -> str:
    """viser's client as one HTML document that takes a recording before it starts. Raises
    `FileNotFoundError` if viser was installed without it."""
    spec = find_spec("viser")
    assert spec is not None and spec.origin is not None
    return (Path(spec.origin).parent / "client" / "build" / "index.html").read_text("utf-8")


def player_scripts(player: str) -> tuple[str, ...]:
    """All scripts of the player: the document's own, and the one it unpacks; empty if it is packed
    differently from viser 1.1."""
    loader = _LOADER.search(player)
    if loader is None:
        return ()
    packed, style_size, size, script, alphabet = loader.groups()
    try:
        content = zstandard.ZstdDecompressor().decompress(
            _bytes_of(packed, json.loads(alphabet)), max_output_size=int(style_size) + int(size)
        )
        return script, content[int(style_size) :].decode()
    except (ValueError, OverflowError, zstandard.ZstdError):
        return ()


def _bytes_of(digits: str, alphabet: str) -> bytes:
    """Decodes viser's text encoding of bytes: four as five digits."""
    values = {digit: value for value, digit in enumerate(alphabet)}
    content = bytearray()
    for start in range(0, len(digits), 5):
        group, number = digits[start : start + 5], 0
        for digit in group:
            number = number * len(alphabet) + values.get(digit, 0)
        content += number.to_bytes(len(group) - 1, "big")
    return bytes(content)


def _look(server: LocalServer, view: SceneCamera) -> None:
    camera = server.initial_camera
    x, y, z = (float(value) for value in view.position)
    camera.position = (x, y, z)
    x, y, z = (float(value) for value in view.look_at)
    camera.look_at = (x, y, z)
    camera.fov, camera.near, camera.far = view.fov_rad, NEAR, FAR
