"""`venus3d export`: a calibrated camera in another program's format."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

from venus3d.cli.options import ExportOptions
from venus3d.cli.report import print_note
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.resize import resize_to
from venus3d.options import image_size_of
from venus3d.regular_file import read_regular
from venus3d.storage.folder import write_bytes
from venus3d.storage.formats import (
    FORMATS,
    encode,
    format_called,
    format_of_name,
    record_in,
)
from venus3d.storage.formats.record import CameraFormat, CameraRecord
from venus3d.storage.places import free_place

_TIME = re.compile(rb"calibration_time.*")


def export_command(options: ExportOptions) -> None:
    """Read, resize, write, and say what is lost. Raises `VenusError` for a user's mistake."""
    target = _target(options)
    record = _resized(options, record_in(options.source, options.format, options.name))
    encoded = encode(record, target, without_k3=options.without_k3, undistorted=options.undistorted)
    place = Path(target.file_name) if options.output is None else options.output
    if place.is_dir():
        place /= target.file_name
    free_place(place, options.source, replaces=_holds(place, encoded.content))
    for loss in encoded.losses:
        print_note(loss)
    print(f"Written: {write_bytes(place, encoded.content)}")


def _target(options: ExportOptions) -> CameraFormat:
    if options.to is not None:
        return format_called(options.to)
    found = None if options.output is None else format_of_name(options.output)
    if found is None:
        raise VenusError(f"Say which format with --to: {', '.join(FORMATS)}.")
    return found


def _resized(options: ExportOptions, record: CameraRecord) -> CameraRecord:
    if options.size is None:
        if options.by is not None or options.offset is not None:
            raise VenusError("--by and --offset go with --size WIDTHxHEIGHT.")
        return record
    old, new = record.camera.image_size, image_size_of(options.size)
    resize = resize_to(old, new, options.by, _offset_of(options.offset))
    if options.by is None and old != new:
        print_note(
            f"Scaled from {old[0]}x{old[1]} px, as for pictures of the same field of view; if the "
            "camera crops its sensor at this size, give --by crop."
        )
    return record.resized(resize)


def _offset_of(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    x, comma, y = text.partition(",")
    if not (comma and x.strip().isdecimal() and y.strip().isdecimal()):
        raise VenusError(f"An offset is X,Y in whole pixels, such as 320,0, not {text!r}.")
    return int(x), int(y)


def _holds(place: Path, content: bytes) -> bool:
    """Whether a file holds this already, whenever it was written."""
    with suppress(OSError):
        return _TIME.sub(b"", read_regular(place)) == _TIME.sub(b"", content)
    return False
