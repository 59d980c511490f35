"""How well views like a given one determine the focal length; shown live in lessons.
For teaching only: guidance uses `information` and `costs`."""

from __future__ import annotations

import numpy as np

from venus3d.engine.calibration.information import covariance_of, view_information
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose, turn
from venus3d.engine.sentences import Sentence

NOISE_PX = 0.1**0.5
"""Corner noise of the paper's simulation (4.1.2), per axis: a variance of 0.1 px²."""
VIEWS = 4
"""Of them it is told what they say together."""
EDGE_ON_DEG = 80.0
"""At a larger tilt to the line of sight a board shows no pattern."""


def views_like(pose: Pose) -> tuple[Pose, ...]:
    """Poses of the same tilt in `VIEWS` directions, spread evenly about the optical axis.

    The direction of the tilt turns but the board does not roll: `Rz(a) R Rz(-a)`, about the board's
    centre. A frontal board has no tilt direction: its poses are equal.
    """
    turns = [turn("z", 360.0 * k / VIEWS) for k in range(VIEWS)]
    return tuple(Pose(Rz @ pose.R @ Rz.T, pose.t.copy()) for Rz in turns)


def focal_sigma(camera: Camera, board: Board, pose: Pose) -> float:
    """Standard deviation of fx, pixels, from a calibration with `views_like` this pose.

    All parameters and every view's pose are unknown, as in `cv2.calibrateCamera`; every corner
    counts, with noise of `NOISE_PX` per axis, whether or not it is in the image.

    inf if the views do not determine the focal length, so that by this sigma it could be zero: for
    a frontal board, where a longer lens farther away gives the same image, and for one seen edge on
    or from behind.
    """
    likes = views_like(pose)
    R, t = np.stack([p.R for p in likes]), np.stack([p.t for p in likes])
    # Nothing is visible edge on, whatever the formula says.
    cosines = np.einsum("ni,ni->n", R[:, :, 2], t) / np.linalg.norm(t, axis=1)
    if cosines.min() < np.cos(np.radians(EDGE_ON_DEG)) or not _in_front(board, R, t):
        return float("inf")
    information = view_information(camera, board.corners, R, t).sum(axis=0)
    scale = 1 / np.sqrt(np.diag(information))
    if np.linalg.eigvalsh(information * np.outer(scale, scale))[0] < 1e-12:
        return float("inf")
    sigma = float(np.sqrt(covariance_of(information, NOISE_PX)[0, 0]))
    return sigma if sigma < camera.fx else float("inf")


_NOTHING = Sentence("{views} pictures like this say nothing about the focal length.")
_SIGMA = Sentence(
    "{views} pictures tilted like this, each to another side, tell the focal length to ± {sigma} "
    "px of {focal:.0f} ({share} %)."
)


def focal_words(sigma_px: float, camera: Camera) -> str:
    """The meaning of `focal_sigma` in one sentence."""
    if not sigma_px < camera.fx:
        return _NOTHING.format(views=VIEWS)
    share = 100 * sigma_px / camera.fx
    return _SIGMA.format(
        views=VIEWS,
        sigma=f"{sigma_px:.{sigma_px < 10:d}f}",
        focal=camera.fx,
        share=f"{share:.{share < 10:d}f}",
    )


def _in_front(board: Board, R: Array, t: Array) -> bool:
    depths = (R[:, 2] @ board.outline.T) + t[:, 2, None]
    return bool((depths > 0.01).all())
