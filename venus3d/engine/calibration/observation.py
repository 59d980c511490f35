"""An observation, the board's corners in one image, and a view, a captured observation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.discs import disc_shifts
from venus3d.engine.geometry.image_circle import ImageCircle
from venus3d.engine.geometry.pose import Array, Pose


@dataclass(frozen=True, eq=False)
class Observation:
    """Corners of one board found in one image; none if `count` is 0."""

    ids: NDArray[np.intp] = field(repr=False)
    """(N,) corner ids, ascending."""
    corners: Array = field(repr=False)
    """(N, 2) pixels."""
    image_size: tuple[int, int]
    """(width, height)."""
    sharpness: float = 0.0
    """Contrast of the board's edges per pixel, 0 ... 1; higher is sharper."""
    time_s: float = 0.0
    """When the frame was taken, by the source's clock."""
    name: str = ""
    """File name or frame number."""
    board: Board | None = None
    """The board with the layout found so far; None: as given."""
    board_diagnoses: tuple[Diagnosis, ...] = ()
    """How the board in the images so far differs from the one given."""
    detect_s: float = float("nan")
    """How long the detection took, seconds; NaN if it was not measured."""
    centroids: Array | None = field(default=None, repr=False)
    """(N, 2) centroids of the discs whose centres are the corners, pixels (see `discs`); None of
    boards without discs."""
    image: NDArray[np.uint8] | None = field(default=None, repr=False)
    """(H, W[, 3]) the image, if it is kept."""
    image_circle: ImageCircle | None = None
    """What the lens lights of the image; None: all of it, or it was not looked for."""

    @property
    def count(self) -> int:
        """Number of corners found."""
        return int(self.ids.size)

    def without_image(self) -> Observation:
        """A copy without the image, for long-term storage."""
        return self if self.image is None else replace(self, image=None)

    def only(self, used: NDArray[np.bool_]) -> Observation:
        """A copy with some of the corners, by a mask (N,)."""
        centroids = None if self.centroids is None else self.centroids[used]
        return replace(self, ids=self.ids[used], corners=self.corners[used], centroids=centroids)

    @staticmethod
    def nothing(image_size: tuple[int, int], time_s: float = 0.0, name: str = "") -> Observation:
        """The observation of an image in which no board was found."""
        return Observation(
            np.zeros(0, np.intp), np.zeros((0, 2)), image_size, time_s=time_s, name=name
        )


@dataclass(frozen=True, eq=False)
class View:
    """A captured observation with its pose and error in the current calibration."""

    number: int
    """Counts from 1 in the order of capture; unchanged when another view is dropped."""
    observation: Observation
    """The corners that the calibration is fitted to."""
    pose: Pose
    rms_px: float
    """Root mean square of the corners' reprojection distance, pixels."""
    errors: Array = field(repr=False)
    """(N, 2) observed minus projected corners, pixels."""
    left_out: Observation | None = None
    """Corners of the same image that fit no pose of the board; they do not count in anything."""


def whole(view: View) -> Observation:
    """A view's observation with the corners that the calibration leaves out."""
    seen, gone = view.observation, view.left_out
    if gone is None:
        return seen
    ids = np.append(seen.ids, gone.ids)
    order = np.argsort(ids)
    corners = np.concatenate([seen.corners, gone.corners])[order]
    centroids = None
    if seen.centroids is not None and gone.centroids is not None:
        centroids = np.concatenate([seen.centroids, gone.centroids])[order]
    return replace(seen, ids=ids[order], corners=corners, centroids=centroids)


def with_centres(camera: Camera, board: Board, seen: Observation, pose: Pose) -> Observation:
    """The observation with the centres of the board's discs as they are seen by this camera; where
    a disc is beyond its model's reach, as it was."""
    if seen.centroids is None:
        return seen
    with np.errstate(all="ignore"):
        centres = seen.centroids - disc_shifts(camera, board, seen.ids, pose)
    known = np.isfinite(centres).all(axis=1, keepdims=True)
    return replace(seen, corners=np.where(known, centres, seen.corners))


def determines_homography(points: Array) -> bool:
    """Whether points (N, 2 or 3) of the board fix a homography: not if all lie on one line, or all
    but one. Judged on the board, since a lens bends a line's image."""
    n = len(points)
    if n < 4:
        return False
    xy = points[:, :2] - points[:, :2].mean(axis=0)
    # The scatter without each of the points in turn; its smaller eigenvalue is the width of a line.
    scatter = xy.T @ xy - n / (n - 1) * xy[:, :, None] * xy[:, None, :]
    values = np.linalg.eigvalsh(scatter)
    return bool((values[:, 0] > 1e-3 * values[:, 1]).all())


def rms_distance(errors: Array) -> float:
    """Root mean square length of vectors (N, 2)."""
    return float(np.sqrt((errors**2).sum(axis=1).mean()))


def reprojection_errors(camera: Camera, board: Board, seen: Observation, pose: Pose) -> Array:
    """(N, 2) observed minus projected corners under a pose, pixels."""
    return seen.corners - camera.project(pose.apply(board.points_of(seen.ids)))
