"""Opens the source that the user typed. `sim` is left to the caller, who has its options."""

from __future__ import annotations

import os
import re
from pathlib import Path

from venus3d.engine.errors import SourceError
from venus3d.sources.bag import Bag, is_bag
from venus3d.sources.camera_device import open_camera, open_pipeline
from venus3d.sources.camera_settings import CameraSettings
from venus3d.sources.folder import Folder
from venus3d.sources.images import UNREAD_PICTURES, is_image, shown
from venus3d.sources.live import Live
from venus3d.sources.served_video import ServedVideo
from venus3d.sources.stream import StreamCapture, connected
from venus3d.sources.video import Video
from venus3d.sources.watched_folder import WatchedFolder

OpenedSource = Folder | Live | Video | Bag | WatchedFolder
_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")


def open_frame_source(
    spec: str,
    *,
    size: tuple[int, int] | None = None,
    settings: CameraSettings | None = None,
    realtime: bool = False,
    flip: bool = False,
) -> OpenedSource:
    """Open what `spec` names.

    A number or /dev/... is a camera; something:// a stream (or a video on a server); what has a !
    between spaces a GStreamer pipeline; watch:DIR a folder that is still being filled; BAG or
    BAG:/topic a ROS bag; a directory or a pattern with * ? [ ] images; a file an image or a video.

    Args:
        spec: what the user typed.
        size: (width, height) to request from a camera; recordings have their own.
        settings: of a camera; nothing else has any.
        realtime: play a video at its own rate instead of as fast as it can be read.
        flip: exchange left and right: for mirrored pictures.

    Raises `SourceError`, one sentence with cause and cure, for whatever cannot be opened.
    """
    source = _opened(spec, size, settings, realtime)
    source.flip = flip
    return source


def is_live(spec: str) -> bool:
    """Whether what the user typed is a camera, or the address of a stream, by its form."""
    spec = spec.strip()
    address = _ADDRESS.match(spec) and not spec.startswith("file://")
    return spec.isdecimal() or spec.startswith("/dev/") or bool(address)


def _opened(
    spec: str, size: tuple[int, int] | None, settings: CameraSettings | None, realtime: bool
) -> OpenedSource:
    spec = spec.removeprefix("file://").strip()
    if not spec:
        raise SourceError("The source is empty; name a camera, a video, a folder, or sim.")
    if spec.isdecimal() or spec.startswith("/dev/"):
        return open_camera(spec, size, settings)
    if settings is not None and settings.wanted():
        raise SourceError(
            f"{shown(spec)} is no camera at this machine: nothing can be set; leave out --camera."
        )
    if " ! " in spec:
        return open_pipeline(spec)
    if _ADDRESS.match(spec):
        return _open_address(spec, realtime)
    if spec.startswith("watch:"):
        return WatchedFolder(Path(os.path.expanduser(spec.removeprefix("watch:"))))
    bag, _, topic = spec.partition(":/")
    if is_bag(bag_path := Path(os.path.expanduser(bag))):
        return Bag(bag_path, f"/{topic}" if topic else None, realtime=realtime)
    path = Path(os.path.expanduser(spec))
    if path.is_dir():
        return Folder.of_directory(path)
    if path.is_file():
        return _open_file(path, realtime)
    if path.is_symlink():
        raise SourceError(f"{shown(path)} is a link that leads to no file; name the file itself.")
    if any(character in spec for character in "*?["):
        return Folder.of_pattern(str(path))
    raise SourceError(
        f"There is no file or folder {shown(spec)}; give an existing video, image or folder, a "
        "pattern of images, a camera's number or a stream's address (guide also takes sim)."
    )


def _open_address(address: str, realtime: bool) -> Live | Video:
    container = connected(address)
    if container.duration:
        return Video(address, realtime=realtime, served=ServedVideo(container))
    opened = StreamCapture(address, container)
    return Live(lambda: StreamCapture(address), address, opened=opened)


def _open_file(path: Path, realtime: bool) -> Folder | Video:
    if not os.access(path, os.R_OK):
        raise SourceError(f"The file {shown(path)} may not be read by you; check its permissions.")
    if path.stat().st_size == 0:
        raise SourceError(f"The file {shown(path)} is empty; record or copy it again.")
    # Files named or starting like an image are images; anything else must be a video.
    if is_image(path):
        return Folder([path])
    if path.suffix.lower() in UNREAD_PICTURES:
        raise SourceError(
            f"{shown(path)} is a kind of picture that is not read; save it as a JPEG or PNG file "
            "of full size."
        )
    return Video(path, realtime=realtime)
