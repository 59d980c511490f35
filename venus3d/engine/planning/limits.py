"""Which poses may be asked of a person, and why another one is refused.

Knows geometry only. What a pose is worth is said by `costs`, which one to take by `search`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.geometry.visibility import Visibility, visibility_of

Mask = NDArray[np.bool_]
# A pose put exactly on a limit must not be lost to rounding.
_SLACK = 1e-9
_REASONS = ("angle", "tilt", "behind", "near", "far", "depth", "outside", "small")

CELL_PX = 2.4
"""Pixels that a marker's cell needs on its short side. Measured on 110 valid poses of the simulated
camera with its noise and blur: of the default board's corners 41 % are found where the smallest
square is 18-21 px wide (2.1 px a cell), 73 % at 21-25 px, 96 % at 25-30 px, all above."""


@dataclass(frozen=True)
class Limits:
    """What a target may ask for. Without limits the best view is absurd: 15 cm away, tilted 75°."""

    max_angle_deg: float = 70.0
    """Each angle of the pose vector, degrees (the paper's solution space, 3.3.1)."""
    max_tilt_deg: float = 55.0
    """Between the board's normal and the line of sight to its centre: beyond, corners blur."""
    nearest: float = 0.2
    """Every corner of the board is at least so far from the lens, metres."""
    farthest: float = 1.2
    """And at most so far, metres."""
    max_depth_ratio: float = 2.2
    """Farthest corner over nearest corner: what a lens can keep in focus at once."""
    margin: float = 0.02
    """Free border around the whole board, as a fraction of the image's width."""
    min_square_px: float = 12.0
    """The shortest side of a square in the image, pixels: below it markers are not read."""

    @staticmethod
    def for_board(board: Board, camera: Camera) -> Limits:
        """The default limits, adapted where they do not suit the board.

        A square is as large as its marker's cells need: `CELL_PX` each, a border of one around the
        dictionary's bits; at least the default's 12 px.

        `z_fill` is the distance at which the frontal board fills the picture, `z_small` the one at
        which its squares become too small. The default 0.2 ... 1.2 m stands where it leaves the
        board room between the two (farthest over nearest usable distance at least 1.6). Otherwise
        the distances become the same multiples of `z_fill` as they are for the default board and
        a usual webcam: 0.75 and 4.5.
        """
        cells = int(board.cv_dictionary.markerSize) + 2
        legible = CELL_PX * cells * board.square / board.marker
        limits = Limits(min_square_px=max(Limits.min_square_px, legible))
        room = 1 - 2 * limits.margin
        height_px = camera.height - 2 * limits.margin * camera.width
        z_fill = max(
            board.width * camera.fx / (room * camera.width), board.height * camera.fy / height_px
        )
        z_small = min(camera.fx, camera.fy) * board.square / limits.min_square_px
        usable = min(limits.farthest, z_small) / max(limits.nearest, z_fill)
        # A far limit below 1.6 z_fill would forbid nearly all; one set by z_small cannot be moved.
        if usable >= 1.6 or (limits.nearest <= z_fill and z_small <= limits.farthest):
            return limits
        return replace(limits, nearest=0.75 * z_fill, farthest=4.5 * z_fill)

    def accepts(self, camera: Camera, board: Board, vectors: ArrayLike) -> Mask:
        """Which of the pose vectors (N, 6) may be asked for: (N,) bool."""
        p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
        # Most candidates of a search fail on what costs little to see; the rest is projected.
        with np.errstate(invalid="ignore", divide="ignore"):
            cosine = np.einsum("ni,ni->n", _normals(p), p[:, 3:]) / np.linalg.norm(p[:, 3:], axis=1)
        good = cosine >= np.cos(np.radians(self.max_tilt_deg)) - _SLACK
        good &= (p[:, 5] > 0) & (p[:, 5] <= self.farthest)
        left = np.flatnonzero(good)
        good[left] = self.within(camera, p[left], visibility_of(camera, board, p[left]))
        return good

    def within(self, camera: Camera, vectors: Array, sight: Visibility) -> Mask:
        """The same of pose vectors (N, 6) whose sight is known."""
        low, high = self.frame(camera)
        near, far = sight.near, sight.far
        good = sight.seen & (sight.cosine >= np.cos(np.radians(self.max_tilt_deg)) - _SLACK)
        for angle in np.abs(vectors[:, :3]).T:
            good &= angle <= self.max_angle_deg + _SLACK
        good &= (near >= self.nearest - _SLACK) & (far <= self.farthest + _SLACK)
        good &= far <= (self.max_depth_ratio + _SLACK) * near
        good &= sight.side >= self.min_square_px - _SLACK
        for axis in range(2):
            good &= sight.low[axis] >= low[axis] - _SLACK
            good &= sight.high[axis] <= high[axis] + _SLACK
        return good

    def excess(self, camera: Camera, board: Board, vectors: ArrayLike) -> Array:
        """By how much the limits are broken, (N,): 0 within them, else a slope to follow back.

        Each limit counts relative to what it allows (a border to the image's width), all together.
        """
        excess, _ = self._excess(camera, board, vectors)
        room = np.array([self.max_angle_deg, self.max_tilt_deg, 1.0, self.nearest, self.farthest])
        room = np.append(room, [self.max_depth_ratio, camera.width, self.min_square_px])
        # Behind the lens nothing can be projected: as bad as a whole limit each.
        return np.where(np.isnan(excess), 1.0, np.maximum(excess / room, 0.0)).sum(axis=1)

    def refusal(self, camera: Camera, board: Board, pose: Pose) -> str | None:
        """One sentence that says why this pose is refused, or None if it is not."""
        excess, figures = self._excess(camera, board, pose.vector()[None])
        broken = np.flatnonzero(~(excess[0] <= 0))
        if broken.size == 0:
            return None
        reason, value = _REASONS[broken[0]], figures[0, broken[0]]
        mm = 1000.0
        return {
            "angle": f"One of the angles is {value:.0f}°; the limit is {self.max_angle_deg:g}°.",
            "tilt": f"The board is tilted by {value:.0f}° away from the line of sight; "
            f"the limit is {self.max_tilt_deg:g}°.",
            "behind": "Part of the board is beside or behind the lens, where it cannot be seen.",
            "near": f"A corner of the board is {value * mm:.0f} mm from the lens; "
            f"the nearest allowed is {self.nearest * mm:.0f} mm.",
            "far": f"A corner of the board is {value * mm:.0f} mm from the lens; "
            f"the farthest allowed is {self.farthest * mm:.0f} mm.",
            "depth": f"The far side of the board is {value:.1f} times as far away as the near one, "
            f"too much to keep in focus; the limit is {self.max_depth_ratio:g}.",
            "outside": f"The board reaches {value:.0f} px past the picture's border less the "
            f"margin of {self.margin * camera.width:.0f} px.",
            "small": f"The smallest square is {value:.1f} px wide in the picture; "
            f"at least {self.min_square_px:g} px are needed.",
        }[reason]

    def _excess(self, camera: Camera, board: Board, vectors: ArrayLike) -> tuple[Array, Array]:
        """By how much each limit is broken, in the order of `_REASONS`, and the figures for it.

        Returns two (N, 8): positive or NaN means broken.
        """
        p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
        sight = visibility_of(camera, board, p)
        tilt = np.degrees(np.arccos(np.clip(sight.cosine, -1.0, 1.0)))
        low, high = self.frame(camera)
        behind = np.where(sight.seen, -1.0, 1.0)
        outside = np.maximum(low[:, None] - sight.low, sight.high - high[:, None]).max(axis=0)
        outside = np.where(sight.seen, outside, np.nan)
        side = np.where(sight.seen, sight.side, np.nan)
        angle = np.abs(p[:, :3]).max(axis=1)
        ratio = sight.far / np.maximum(sight.near, 1e-9)
        figures = np.stack(
            [angle, tilt, behind, sight.near, sight.far, ratio, outside, side], axis=1
        )
        limit = np.array([self.max_angle_deg, self.max_tilt_deg, 0.0, self.nearest, self.farthest])
        limit = np.append(limit, [self.max_depth_ratio, 0.0, self.min_square_px])
        sign = np.array([1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0, -1.0])
        return sign * (figures - limit) - _SLACK, figures

    def frame(self, camera: Camera) -> tuple[Array, Array]:
        """(2,) smallest and (2,) largest pixel the board may reach: the image less a margin."""
        border = self.margin * camera.width - 0.5
        return np.full(2, border), np.array([camera.width - 1, camera.height - 1]) - border


def brought_within(
    board: Board, camera: Camera, limits: Limits, vector: ArrayLike
) -> tuple[Array, str]:
    """The pose vector (6,) brought into the limits by the smallest change, and what changed.

    Looked at are a smaller tilt (X and Y angles scaled together), another distance along the same
    line of sight, and a shift towards the image's centre. Ten degrees weigh as much as ten per
    cent of the distance or a shift by a tenth of the way to the centre. If nothing of this helps,
    the vector comes back unchanged with the reason why it is refused.
    """
    p = np.asarray(vector, dtype=np.float64).copy()
    if limits.accepts(camera, board, p)[0]:
        return p, ""
    cause = limits.refusal(camera, board, Pose.from_vector(p)) or ""
    p[:3] = np.clip(p[:3], -limits.max_angle_deg, limits.max_angle_deg)
    tilt, stretch, centring = (
        axis.ravel()
        for axis in np.meshgrid(
            np.linspace(1, 0, 36), 1.05 ** np.arange(-18, 29), [0, 0.05, 0.1, 0.2, 0.3, 0.5, 1]
        )
    )
    candidates = np.tile(p, (tilt.size, 1))
    candidates[:, :2] *= tilt[:, None]
    candidates[:, 3:] *= stretch[:, None]
    candidates[:, 3:5] *= 1 - centring[:, None]
    change = (1 - tilt) * np.abs(p[:2]).max() / 10 + np.abs(np.log(stretch)) / 0.1 + 10 * centring
    order = np.argsort(change, kind="stable")
    for block in np.array_split(order, 24):
        good = limits.accepts(camera, board, candidates[block])
        if good.any():
            best = candidates[block[int(np.argmax(good))]]
            return best, f"{cause} {_change_told(p, best)}".strip()
    return p, cause


def _change_told(before: Array, after: Array) -> str:
    parts: list[str] = []
    for name, old, new in zip("XY", before[:2], after[:2], strict=True):
        if abs(new - old) > 0.05:
            parts.append(f"turned about {name} by {new:.0f}° instead of {old:.0f}°")
    if abs(after[5] / before[5] - 1) > 1e-6:
        parts.append(f"held at {after[5] * 1000:.0f} mm instead of {before[5] * 1000:.0f} mm")
    if np.linalg.norm(after[3:5] / after[5] - before[3:5] / before[5]) > 1e-6:
        parts.append("moved towards the centre of the picture")
    return f"It is {' and '.join(parts)}." if parts else ""


def _normals(vectors: Array) -> Array:
    """(N, 3) the board's z axes under pose vectors (N, 6): the last column of Rz Ry Rx."""
    (sx, sy, sz), (cx, cy, cz) = (f(np.radians(vectors[:, :3])).T for f in (np.sin, np.cos))
    return np.stack([cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx], axis=1)
