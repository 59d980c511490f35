"""`venus3d cameras`: what cameras there are, and a picture of each."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import cv2

from venus3d.cli.options import CamerasOptions
from venus3d.cli.report import print_note
from venus3d.engine.errors import SourceError, VenusError
from venus3d.sources.camera_list import list_cameras, sample_picture
from venus3d.sources.v4l2 import CameraControl, CameraFound, CameraMode
from venus3d.storage.folder import prepare
from venus3d.storage.products import write_product


def cameras(options: CamerasOptions) -> None:
    """List the cameras; with a folder, write a picture of each into it.
    Raises `VenusError` if there is none."""
    found = list_cameras()
    if not found:
        raise VenusError(
            "There is no camera at this machine; plug one in, or name a stream's address or a "
            "video as the source."
        )
    for camera in found:
        print(described(camera))
    if options.output is not None:
        _write_pictures(found, prepare(options.output))
    if options.json:
        print(json.dumps({"cameras": [asdict(camera) for camera in found]}))


def described(camera: CameraFound) -> str:
    """A camera in some lines."""
    lines = [camera.name, f"  venus3d guide {camera.device}"]
    if camera.trouble:
        lines.append(f"  {camera.trouble}")
    lines += [_mode_line(mode) for mode in camera.modes]
    lines += [_control_line(control) for control in camera.controls]
    return "\n".join(lines)


def _mode_line(mode: CameraMode) -> str:
    rates = ", ".join(f"{rate:g}" for rate in mode.rates)
    size = f"{mode.size[0]} x {mode.size[1]}"
    return f"  {mode.encoding:<6} {size:>11}" + (f"  at {rates} pictures/s" if rates else "")


def _control_line(control: CameraControl) -> str:
    if control.choices:
        may_be = ", ".join(f"{number}: {name}" for number, name in control.choices)
    elif isinstance(control.value, bool):
        may_be = "on or off"
    else:
        step = "" if control.step == 1 else f" in steps of {control.step}"
        may_be = f"{control.minimum} to {control.maximum}{step}"
    value = (
        {True: "on", False: "off"}[control.value]
        if isinstance(control.value, bool)
        else ("?" if control.value is None else control.value)
    )
    inactive = "" if control.is_active else "; set by an automatic"
    return f"  {control.name} = {value} ({may_be}{inactive})"


def _write_pictures(found: list[CameraFound], folder: Path) -> None:
    for number, camera in enumerate(found):
        if camera.trouble:
            continue
        try:
            picture = sample_picture(camera.device)
        except SourceError as error:
            print_note(str(error))
            continue
        path = folder / f"camera-{number}.png"
        write_product(path, cv2.imencode(".png", picture)[1].tobytes(), "a camera's picture")
        print_note(f"Written: {path}")
