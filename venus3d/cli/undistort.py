"""`venus3d undistort`: pictures and videos without lens distortion, and their camera beside."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, suppress
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
from av.error import FFmpegError
from numpy.typing import NDArray

from venus3d.cli.options import UndistortOptions
from venus3d.cli.report import print_note
from venus3d.engine.calibration.camera_plausibility import folds_back, lost_share
from venus3d.engine.errors import StorageError, VenusError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.undistortion import Undistortion
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Frame
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.video import Video
from venus3d.storage.folder import prepare, reason, write_bytes
from venus3d.storage.formats import OPENCV_YAML, CameraRecord, encode, record_in
from venus3d.storage.places import free_place

_CLOCK = 90_000
"""Ticks per second of the written video."""


def undistort_command(options: UndistortOptions) -> int:
    """Undistort all pictures, write them and their camera; the exit code is 1 if some could not be
    read. Raises `VenusError` for a user's mistake."""
    undistortion = Undistortion(record_in(options.camera).camera, options.alpha)
    _check_lens(undistortion.source)
    with closing(open_frame_source(options.source)) as source:
        if not isinstance(source, (Folder, Video)):
            raise VenusError("Only pictures and videos are undistorted; record the camera first.")
        place = Path(options.source).expanduser()
        if options.output.resolve() in (place.resolve(), place.resolve().parent):
            raise VenusError(
                f"The results would lie among their sources in {options.output}; choose another "
                "folder with --output."
            )
        again = _wrote_before(options.output)
        read = (options.camera, options.camera / "camera.yaml")
        free_place(options.output / "camera.yaml", *read, replaces=again)
        folder = prepare(options.output)
        if isinstance(source, Folder):
            count = _write_pictures(source, undistortion, folder, again)
            counted = "1 picture" if count == 1 else f"{count} pictures"
            print(f"Written: {counted} in {folder}")
        else:
            video = free_place(folder / f"{place.stem}.mp4", replaces=again)
            print(f"Written: {_write_video(source, undistortion, video)}")
        for note in source.notes:
            print_note(note)
        unread = isinstance(source, Folder) and source.unread > 0
    camera = encode(CameraRecord(undistortion.camera), OPENCV_YAML).content
    print(f"Written: {write_bytes(folder / 'camera.yaml', camera)}")
    return int(unread)


def _check_lens(camera: Camera) -> None:
    """Say how much of the pictures a lens model loses; raise `CalibrationError` if most."""
    lost = lost_share(camera)
    if lost:
        said = folds_back(camera, lost)
        print_note(f"Mind: {said}, which is lost; calibrate again with views up to the border.")


def _wrote_before(folder: Path) -> bool:
    """Whether a folder is one of earlier results: a camera without distortion lies there."""
    with suppress(VenusError):
        return not record_in(folder / "camera.yaml").camera.distortion.any()
    return False


def _write_pictures(source: Folder, undistortion: Undistortion, folder: Path, again: bool) -> int:
    used: set[str] = set()
    for frame in _frames(source):
        # a.jpg and a.tif both become PNG files.
        name = f"{Path(frame.name).stem}.png"
        name = f"{frame.name}.png" if name in used else name
        used.add(name)
        _, content = cv2.imencode(".png", undistortion(frame.image))
        write_bytes(free_place(folder / name, replaces=again), content.tobytes())
    return len(used)


def _write_video(source: Video, undistortion: Undistortion, path: Path) -> Path:
    """H.264 in MP4, each frame at its own time; written beside, then renamed."""
    beside = path.with_name(f".{path.name}.part")
    try:
        with av.open(str(beside), "w", format="mp4") as container:
            stream = _stream(container, undistortion)
            last = -1
            for frame in _frames(source):
                picture = av.VideoFrame.from_ndarray(
                    _colours(undistortion(frame.image)), format="bgr24"
                )
                last = max(last + 1, round(frame.time_s * _CLOCK))
                picture.pts, picture.time_base = last, Fraction(1, _CLOCK)
                container.mux(stream.encode(picture))
            container.mux(stream.encode())
        beside.replace(path)
    except (OSError, FFmpegError) as error:
        cause = reason(error) if isinstance(error, OSError) else str(error)
        raise StorageError(
            f"{path} cannot be written ({cause}); choose another --output."
        ) from error
    finally:
        beside.unlink(missing_ok=True)
    return path


def _stream(container: Any, undistortion: Undistortion) -> Any:
    stream = container.add_stream("libx264", rate=30, options={"crf": "14"})
    stream.width, stream.height = undistortion.camera.image_size
    # The usual 4:2:0 has colours for two by two pixels.
    even = stream.width % 2 == 0 and stream.height % 2 == 0
    stream.pix_fmt = "yuv420p" if even else "yuv444p"
    stream.codec_context.time_base = Fraction(1, _CLOCK)
    return stream


def _frames(source: Folder | Video) -> Iterator[Frame]:
    while (frame := source.read()) is not None:
        yield frame


def _colours(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    if picture.ndim == 2:
        picture = np.repeat(picture[..., None], 3, axis=2)
    return np.ascontiguousarray(picture)
