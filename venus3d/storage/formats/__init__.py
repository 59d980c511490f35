"""Camera files of other programs: one small module a format, and the two functions that use them.

docs/formats.md is the table of what each format keeps.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.camera_plausibility import lost_share
from venus3d.engine.errors import CalibrationError, StorageError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import BROWN5, LENSES
from venus3d.engine.geometry.nearest_camera import nearest_without_k3
from venus3d.regular_file import read_regular
from venus3d.storage.damaged import DAMAGED
from venus3d.storage.folder import reason, write_bytes
from venus3d.storage.formats.blender import BLENDER
from venus3d.storage.formats.colmap import COLMAP
from venus3d.storage.formats.kalibr import KALIBR
from venus3d.storage.formats.matlab import MATLAB
from venus3d.storage.formats.mrcal import MRCAL
from venus3d.storage.formats.nerfstudio import NERFSTUDIO
from venus3d.storage.formats.opencv import OPENCV_JSON, OPENCV_XML, OPENCV_YAML
from venus3d.storage.formats.plain_json import JSON
from venus3d.storage.formats.record import CameraFormat, CameraRecord
from venus3d.storage.formats.ros import ROS
from venus3d.storage.formats.unity import UNITY

FORMATS: dict[str, CameraFormat] = {
    one.name: one
    for one in (
        OPENCV_YAML,
        OPENCV_JSON,
        OPENCV_XML,
        ROS,
        KALIBR,
        COLMAP,
        MRCAL,
        NERFSTUDIO,
        MATLAB,
        BLENDER,
        UNITY,
        JSON,
    )
}
LARGEST_FILE = 64 * 2**20
"""Bytes; a result.json with thousands of views or a .cameramodel with its solve is smaller."""


@dataclass(frozen=True)
class Encoded:
    """A camera in a format: the file's content, and what it does not hold, in sentences."""

    content: bytes
    losses: tuple[str, ...]


def format_called(name: str) -> CameraFormat:
    """The format of this name. Raises `StorageError`, which names all."""
    if name not in FORMATS:
        raise StorageError(f"There is no format {name!r}; it is one of {', '.join(FORMATS)}.")
    return FORMATS[name]


def format_of_name(path: Path) -> CameraFormat | None:
    """The format that a file's name alone tells, or None."""
    name = path.name.lower()
    fitting = [
        one for one in FORMATS.values() if any(fnmatchcase(name, pattern) for pattern in one.names)
    ]
    return fitting[0] if len(fitting) == 1 else None


def encode(
    record: CameraRecord,
    target: CameraFormat,
    *,
    without_k3: bool = False,
    undistorted: bool = False,
) -> Encoded:
    """The content of a file of this format. Raises `StorageError` for a distortion that the format
    cannot hold, unless it may be approximated or left out; `export_camera` explains both."""
    losses: list[str] = []
    if undistorted:
        record = replace(_camera_alone(record), camera=record.camera.without_distortion())
        losses.append("Without distortion: this file is for pictures undistorted to this camera.")
    record = _held(record, target)
    if undistorted:
        pass
    elif target.coefficients == 0 and not record.camera.is_pinhole:
        raise StorageError(
            f"{_start(target)} has no lens distortion, and this camera has; undistort the pictures "
            "(venus3d undistort) and say so with --undistorted."
        )
    elif (
        target.coefficients == 4
        and record.camera.lens == BROWN5
        and (k3 := record.camera.named["k3"])
    ):
        if not without_k3:
            raise StorageError(
                f"{_start(target)} has no k3, and this camera has k3 = {k3:.4g}; "
                "export to ros or opencv-yaml, or take the nearest camera without k3 "
                "(--without-k3)."
            )
        camera, largest = nearest_without_k3(record.camera)
        record = replace(_camera_alone(record), camera=camera)
        losses.append(f"The nearest camera without k3: up to {largest:.2g} px off in the picture.")
    lost = (
        "covariance"
        if record.covariance is not None and not target.keeps_covariance
        else "standard deviations"
        if record.sigma is not None and not target.keeps_sigma
        else ""
    )
    if lost:
        place = (
            " (it stands in a comment)" if target.name == "mrcal" and lost == "covariance" else ""
        )
        losses.append(f"{_start(target)} has no place for the {lost}{place}; --to json keeps it.")
    return Encoded(target.write(record), tuple(losses))


def export_camera(
    source: Calibration | Camera | CameraRecord,
    path: Path | str,
    format: str | None = None,
    *,
    without_k3: bool = False,
    undistorted: bool = False,
) -> Path:
    """Write a camera in another program's format, and give the path.

    Args:
        source: what `calibrate`, `read_result(...).calibration`, `import_camera` give, or a camera.
        format: "opencv-yaml", "ros", "kalibr" ...; None takes it from the file's name.
        without_k3: for a format without k3, the nearest camera that has none.
        undistorted: the file is for undistorted pictures; the distortion is left out.

    What the format does not hold is told as a `UserWarning`. Raises `StorageError` if it cannot
    hold the camera's distortion or if the file cannot be written.
    """
    place = Path(path)
    target = format_called(format) if format else format_of_name(place)
    if target is None:
        raise StorageError(
            f"The name {place.name} does not tell its format; name it: {', '.join(FORMATS)}."
        )
    encoded = encode(
        CameraRecord.of(source), target, without_k3=without_k3, undistorted=undistorted
    )
    for loss in encoded.losses:
        warnings.warn(loss, stacklevel=2)
    return write_bytes(place, encoded.content)


def import_camera(
    path: Path | str, format: str | None = None, *, name: str | None = None
) -> CameraRecord:
    """Read a camera from another program's file; `.camera` is the camera.

    Args:
        format: "opencv-yaml", "ros", "kalibr" ...; None finds it out from name and content.
        name: which camera, where a file has several (Kalibr's `cam1`, COLMAP's id).

    Raises `StorageError` if there is no such file, no camera in it, or one of another model.
    """
    place = Path(path)
    content = _content_of(place)
    source = format_called(format) if format else _format_of(place, content)
    if name is not None and source not in (KALIBR, COLMAP):
        raise StorageError(f"{_start(source)} holds one camera, without a name; leave out --name.")
    try:
        return source.read(content, name)
    except (*DAMAGED, CalibrationError) as error:
        raise _none_in(place, source) from error
    except (RecursionError, MemoryError) as error:
        raise _none_in(place, source) from error


def record_in(path: Path | str, format: str | None = None, name: str | None = None) -> CameraRecord:
    """The camera of a file, or of a folder's result.json or camera.yaml. Raises `StorageError`."""
    place = Path(path)
    if place.is_dir():
        found = _files_in(place)
        if not found:
            raise _no_file(place)
        place = found[0]
    return import_camera(place, format, name=name)


def camera_in(path: Path | str) -> CameraRecord:
    """`record_in` for a camera to look through: raises `CalibrationError` for one that cannot have
    taken a picture of a board."""
    record = record_in(path)
    lost_share(record.camera)
    return record


def _files_in(folder: Path) -> list[Path]:
    """What a calibration's folder holds of its camera, the most telling first."""
    paths = (folder / name for name in ("result.json", "camera.yaml"))
    return [path for path in paths if path.is_file()]


def _no_file(folder: Path) -> StorageError:
    found = _files_in(folder)
    if not found:
        return StorageError(
            f"{folder} is a folder with neither a result.json nor a camera.yaml; give the file "
            "itself."
        )
    more = ", which holds the covariance as well" * (found[0].suffix == ".json")
    return StorageError(f"{folder} is a folder; give its {found[0].name}{more}: {found[0]}.")


def _content_of(path: Path) -> bytes:
    if path.is_dir():
        raise _no_file(path)
    try:
        content = read_regular(path, LARGEST_FILE + 1)
    except OSError as error:
        raise StorageError(
            f"The camera file {path} cannot be read ({reason(error)}); give another."
        ) from error
    if len(content) > LARGEST_FILE:
        raise StorageError(
            f"{path} has more than {LARGEST_FILE >> 20} MiB and is no camera file; give another."
        )
    return content


def _format_of(path: Path, content: bytes) -> CameraFormat:
    """By the content, and where that does not tell, by the name."""
    looks = [one for one in FORMATS.values() if one.recognises(content)]
    named = format_of_name(path)
    if named is not None and (named in looks or not looks):
        return named
    if not looks:
        raise StorageError(
            f"The format of {path} cannot be told; name it with --format (venus3d import makes a "
            f"camera.yaml of it): {', '.join(FORMATS)}."
        )
    return looks[0]


def _none_in(path: Path, source: CameraFormat) -> StorageError:
    return StorageError(
        f"There is no camera in {path} as {source.title} holds it; docs/formats.md says what it "
        "must hold. If it is of another format, name that with --format (venus3d import makes a "
        "camera.yaml of it)."
    )


def _held(record: CameraRecord, target: CameraFormat) -> CameraRecord:
    """The record with a lens model that the format has. Raises `StorageError` if there is none."""
    own = record.camera.lens
    for name in target.lenses:
        lens = LENSES[name]
        same = own.is_perspective == lens.is_perspective
        if own == lens or (same and set(own.coefficient_names) <= set(lens.coefficient_names)):
            return record if own == lens else record.with_lens(lens)
    others = [
        one.name for one in FORMATS.values() if own.name in one.lenses and one.name != target.name
    ]
    raise StorageError(
        f"{_start(target)} has no lens model that holds this camera's, {own.name}; export to "
        f"{', '.join(others)}, or undistort the pictures (venus3d undistort) and say so with "
        "--undistorted."
    )


def _camera_alone(record: CameraRecord) -> CameraRecord:
    # Neither the rms nor the covariance is that of another model.
    return replace(record, covariance=None, sigma=None, rms_px=None, views=None)


def _start(target: CameraFormat) -> str:
    return target.title[0].upper() + target.title[1:] if target.name == "json" else target.title
