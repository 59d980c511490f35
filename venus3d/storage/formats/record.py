"""What a camera file holds, and what a file format is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import LensModel
from venus3d.engine.geometry.pose import Array
from venus3d.engine.geometry.resize import Resize


@dataclass(frozen=True, eq=False)
class CameraRecord:
    """A camera and what a file says about how well it is known. None: the file does not say."""

    camera: Camera
    covariance: Array | None = None
    """(p, p) of the camera's parameters; zero rows and columns for parameters held fixed."""
    sigma: Array | None = None
    """(p,) standard deviations of the parameters; with a covariance, the root of its diagonal."""
    rms_px: float | None = None
    """Root mean square reprojection distance of the calibration, pixels."""
    views: int | None = None
    """How many views it had."""
    board: Board | None = None

    @staticmethod
    def of(source: CameraRecord | Calibration | Camera) -> CameraRecord:
        """The record of a calibration or of a camera alone."""
        if isinstance(source, Camera):
            return CameraRecord(source)
        if isinstance(source, CameraRecord):
            return source
        return CameraRecord(
            source.camera,
            source.covariance,
            source.sigma,
            source.rms_px,
            len(source.views),
            source.board,
        )

    def with_lens(self, lens: LensModel) -> CameraRecord:
        """The same camera with a lens model that has all of its coefficients, and more."""
        camera = self.camera.with_lens(lens)
        place = [camera.parameter_names.index(name) for name in self.camera.parameter_names]
        covariance, sigma = self.covariance, self.sigma
        if covariance is not None:
            wider = np.zeros((len(camera.parameters),) * 2)
            wider[np.ix_(place, place)] = covariance
            covariance = wider
        if sigma is not None:
            longer = np.zeros(len(camera.parameters))
            longer[place] = sigma
            sigma = longer
        return replace(self, camera=camera, covariance=covariance, sigma=sigma)

    def resized(self, resize: Resize) -> CameraRecord:
        """The same camera for pictures of another size. The rms stays that of the calibration's
        pixels, so it is left out if pixels change their size."""
        by = resize.derivatives(self.camera)
        return replace(
            self,
            camera=resize.camera(self.camera),
            covariance=None if self.covariance is None else self.covariance * np.outer(by, by),
            sigma=None if self.sigma is None else self.sigma * by,
            rms_px=self.rms_px if resize.scale == (1.0, 1.0) else None,
        )


@dataclass(frozen=True)
class CameraFormat:
    """A file format for cameras."""

    name: str
    """As given to `--to`."""
    title: str
    """As a sentence calls it."""
    file_name: str
    """The usual name of such a file."""
    names: tuple[str, ...]
    """Patterns of file names, in small letters, that are of this format and no other."""
    write: Callable[[CameraRecord], bytes]
    read: Callable[[bytes, str | None], CameraRecord]
    """Takes the content, and which of several cameras is meant. Raises `ValueError`, `LookupError`
    or `TypeError` for what is not of this format, `StorageError` with a sentence for a camera that
    cannot be held here."""
    recognises: Callable[[bytes], bool]
    """Whether a file's content looks like this format."""
    coefficients: int = 5
    """Distortion coefficients of brown5 that it holds: 5, 4 (no k3) or 0."""
    lenses: tuple[str, ...] = ("brown5",)
    """Names of the lens models that it holds; others are written as one that has all of their
    coefficients."""
    keeps_covariance: bool = False
    keeps_sigma: bool = False
