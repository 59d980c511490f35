"""`venus3d doctor`: what this machine has, what is missing, and how to mend it."""

from __future__ import annotations

import os
import shutil
import sys
import webbrowser
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import cv2
from av.codec import codecs_available

from venus3d import __version__
from venus3d.cli.options import DoctorOptions
from venus3d.render.offscreen import Offscreen
from venus3d.scene.web.addresses import check_port, is_free
from venus3d.sources.camera_list import list_cameras

_PACKAGES = ("numpy", "scipy", "viser", "websockets", "pyrender", "trimesh", "av")
_OPENCVS = (
    "opencv-python",
    "opencv-python-headless",
    "opencv-contrib-python",
    "opencv-contrib-python-headless",
)
_OURS = _OPENCVS[-1]
_LEAST_GB, _LITTLE_GB = 0.1, 2.0
_BROWSERS = ("chromium", "google-chrome", "chromium-browser", "firefox", "microsoft-edge")

State = Literal["ok", "without", "missing"]


@dataclass(frozen=True)
class Finding:
    """One line."""

    what: str
    state: State
    """"without": it works all the same, with less; "missing": something does not work."""
    said: str
    cure: str = ""


def doctor(options: DoctorOptions) -> None:
    """Print a line for each thing that is looked at; exit code 1 if one that matters is missing.
    Raises `VenusError` for a port that there is not."""
    check_port(options.port)
    missing: list[str] = []
    for finding in findings(options.port):
        print(line_of(finding), flush=True)
        if finding.state == "missing":
            missing.append(finding.what)
    if missing:
        print(f"Missing: {', '.join(missing)}; the lines above say how to mend it.")
        raise SystemExit(1)


def line_of(finding: Finding) -> str:
    """A finding as it is printed."""
    cure = f"\n{'':21}-> {finding.cure}" if finding.cure else ""
    return f"{finding.state:<8} {finding.what:<11} {finding.said}{cure}"


def findings(port: int) -> Iterator[Finding]:
    """All that is looked at, in order. A look that itself fails is one that found it missing."""
    looks: tuple[tuple[str, Callable[[], Finding]], ...] = (
        ("versions", _versions),
        ("OpenCV", _opencv),
        ("OpenGL", _opengl),
        ("page", _page),
        ("port", lambda: _port(port)),
        ("browser", _browser),
        ("cameras", _cameras),
        ("films", _films),
        ("disk", lambda: _disk(Path.cwd())),
    )
    for what, look in looks:
        try:
            yield look()
        except Exception as error:  # a broken library must not end the search for others
            yield Finding(what, "missing", f"cannot be looked at: {error}", _REINSTALL)


_REINSTALL = "install again: pip install --force-reinstall venus3d"


def _versions() -> Finding:
    python = ".".join(map(str, sys.version_info[:3]))
    found, gone = [f"venus3d {__version__}", f"Python {python}"], list[str]()
    for name in _PACKAGES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            gone.append(name)
    if gone:
        return Finding("versions", "missing", f"not installed: {', '.join(gone)}", _REINSTALL)
    return Finding("versions", "ok", ", ".join(found))


def _opencv() -> Finding:
    installed = [name for name in _OPENCVS if _is_installed(name)]
    said = f"{cv2.__version__} ({', '.join(installed) or 'not from pip'})"
    if not hasattr(cv2, "aruco") or not hasattr(cv2.aruco, "CharucoDetector"):
        cure = f"pip uninstall {' '.join(installed)}; pip install {_OURS}"
        return Finding("OpenCV", "missing", f"{said} has no ChArUco detector", cure)
    if len(installed) > 1:
        cure = f"they write over each other's files: uninstall all, then pip install {_OURS}"
        return Finding("OpenCV", "without", f"{said}: more than one is installed", cure)
    return Finding("OpenCV", "ok", said)


def _is_installed(name: str) -> bool:
    try:
        version(name)
    except PackageNotFoundError:
        return False
    return True


def _opengl() -> Finding:
    with Offscreen() as offscreen:
        backend, note = offscreen.backend, offscreen.note
    if backend == "gl":
        return Finding("OpenGL", "ok", "draws off the screen")
    cure = "Debian, Ubuntu: apt install libegl1 libgl1 libgl1-mesa-dri; else the graphics driver"
    return Finding("OpenGL", "without", note or "OpenCV paints instead, more simply", cure)


def _page() -> Finding:
    spec = find_spec("viser")
    if spec is None or spec.origin is None:
        return Finding("page", "missing", "viser is not installed", _REINSTALL)
    client = Path(spec.origin).parent / "client" / "build" / "index.html"
    if not client.is_file():
        cure = "pip install --force-reinstall viser"
        return Finding("page", "missing", f"viser was installed without {client}", cure)
    return Finding("page", "ok", "viser's client is there; nothing is loaded from the network")


def _port(port: int) -> Finding:
    if is_free("127.0.0.1", port):
        return Finding("port", "ok", f"{port} is free")
    cure = f"end the program that has it, or use the address that is printed, or --port {port + 1}"
    return Finding("port", "without", f"{port} is taken; the next free one is used", cure)


def _browser() -> Finding:
    there = [name for name in _BROWSERS if shutil.which(name)]
    if there:
        return Finding("browser", "ok", ", ".join(there))
    try:
        webbrowser.get()
    except webbrowser.Error:
        cure = "install Chromium or Firefox, or open the page from another machine (--host 0.0.0.0)"
        return Finding("browser", "without", "none is found here", cure)
    return Finding("browser", "ok", "the system's")


def _cameras() -> Finding:
    found = list_cameras()
    if not found:
        cure = "plug one in; a stream, a video or pictures do as well"
        if sys.platform == "linux" and list(Path("/dev").glob("video*")):
            cure = "they may belong to others: sudo usermod -aG video $USER, then log in again"
        return Finding("cameras", "without", "none is found", cure)
    troubled = [camera for camera in found if camera.trouble]
    names = ", ".join(f"{camera.name} ({camera.device})" for camera in found)
    if len(troubled) == len(found):
        return Finding("cameras", "without", f"{names}: {troubled[0].trouble}")
    return Finding("cameras", "ok", names)


def _films() -> Finding:
    if "libx264" not in codecs_available:
        cure = "pip install --force-reinstall --only-binary av av"
        return Finding("films", "without", "PyAV has no H.264 encoder; .mp4 is not written", cure)
    return Finding("films", "ok", "H.264 is written")


def _disk(here: Path) -> Finding:
    free_gb = shutil.disk_usage(here).free / 1e9
    said = f"{free_gb:.1f} GB free in {here}"
    if not os.access(here, os.W_OK):
        cure = "go to a folder of your own, or name one with --output"
        return Finding("disk", "missing", f"{here} cannot be written", cure)
    if free_gb < _LITTLE_GB:
        cure = "a view of 1920 x 1080 takes 3 to 5 MB; make room, or name another --output"
        return Finding("disk", "missing" if free_gb < _LEAST_GB else "without", said, cure)
    return Finding("disk", "ok", said)
