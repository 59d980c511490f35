"""The space of allowed poses, its map from the unit cube, and the way back onto its limits.

A search's best poses lie on the limits. `onto_limits` is for the thousands of poses of a search;
`brought_within` changes a single one as little as possible and reports the change.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.amounts import degrees, size_mm
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.repeats import SAME
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose, angles_of, rotations_of
from venus3d.engine.geometry.visibility import Visibility, visibility_of
from venus3d.engine.planning.limits import WIDEST, Limits, Mask, refusals
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import PlanningSettings
from venus3d.engine.sentences import Sentence, listed

SKIPPED_DEG = 15.0
SKIPPED_FRACTION = 0.1
REPEATED = 2 * SAME
"""Mean shift of the corners up to which a target would repeat a view, as a share of the image's
width: twice what a calibration takes for the same, since nobody hits a target exactly."""
_NEAR_A_VIEW, _AS_FAR = 4, 0.25
"""Where a repeat is looked for: the board's centre has moved by less than so many times that limit
and its distance has changed by less than this share."""
_ROUGH_MARGIN = 0.06
"""Free border, as a share of the image's width, around a board that is read only as a whole, while
the views do not determine how a wide lens bends: at its target it may be beyond the border."""
_TRIES = 50  # batches of 64 poses drawn for a random one within the limits
# Aim a little inside: each correction is a Newton step and would otherwise approach forever.
_TILT_DEG = 0.05
_SHARE = 1e-3
_PX = 0.2


@dataclass(frozen=True, eq=False)
class Space:
    """The allowed poses: within the limits, not near a skipped one, no repeats of a view."""

    board: Board
    camera: Camera
    limits: Limits
    skipped: tuple[Pose, ...] = ()
    """Poses within 15 degrees and a tenth of the distance are not offered again."""
    views: tuple[View, ...] = ()
    """Captured so far. One that repeats another counts once (`repeats`), and so brings nothing."""

    @staticmethod
    def of(
        posterior: Posterior,
        settings: PlanningSettings,
        skipped: Iterable[Pose] = (),
        views: Iterable[View] = (),
    ) -> Space:
        """The space for a plan with these settings."""
        board, camera = posterior.board, posterior.camera
        limits = settings.limits_for(board, camera)
        roughly = not (posterior.settled or camera.lens.is_perspective)
        if roughly and not board.of_kind.partial and "margin" not in settings.limits:
            limits = replace(limits, margin=_ROUGH_MARGIN)
        return Space(board, camera, limits, tuple(skipped), tuple(views))

    def accepts(self, vectors: ArrayLike) -> Mask:
        """Which pose vectors (N, 6) are in the space: (N,) bool."""
        p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
        good = self.limits.accepts(self.camera, self.board, p)
        good[good] = ~self._is_taken(p[good])
        return good

    def bring_inside(self, vectors: Array) -> tuple[Array, Mask]:
        """Pose vectors (N, 6) moved onto the limits they break, and which (N,) are now inside."""
        moved, good = onto_limits(self.limits, self.camera, self.board, vectors)
        # Only those: the others may be anywhere, even beyond the range of floats.
        good[good] = ~self._is_taken(moved[good])
        return moved, good

    def excess(self, vectors: Array) -> Array:
        """(N,) how far pose vectors (N, 6) are outside: 0 inside, else a slope that leads back.
        By how much they break the limits (`Limits.excess`), plus 1 where `_is_taken`."""
        total = self.limits.excess(self.camera, self.board, vectors)
        return total + self._is_taken(vectors)

    def _is_taken(self, vectors: Array) -> Mask:
        """Which pose vectors (N, 6) are near a skipped pose, or would repeat a view."""
        taken = np.zeros(len(vectors), dtype=bool)
        for pose in self.skipped:
            taken |= _near(vectors, pose)
        if self.views:
            with np.errstate(all="ignore"):
                taken |= self._repeats(vectors)
        return taken

    def _repeats(self, vectors: Array) -> Mask:
        """Which pictures of the whole board under pose vectors (N, 6) would repeat a view."""
        camera, board = self.camera, self.board
        limit = REPEATED * camera.width
        here, there = vectors[:, 3:].T, np.array([view.pose.t for view in self.views]).T
        apart = camera.pixels_of(here)[:, :, None] - camera.pixels_of(there)[:, None]  # (2, N, V)
        farther = np.linalg.norm(here, axis=0)[:, None] / np.linalg.norm(there, axis=0) - 1
        likely = (np.abs(apart) < _NEAR_A_VIEW * limit).all(axis=0) & (np.abs(farther) < _AS_FAR)
        repeated = np.zeros(len(vectors), dtype=bool)
        which, of = np.nonzero(likely)
        if which.size:
            R, t = rotations_of(vectors[which]), vectors[which, 3:]
            shifts = camera.project_board(board.corners, R, t) - self._seen[of]  # (K, M, 2)
            common = np.isfinite(shifts[:, :, 0])
            total = np.nansum(np.linalg.norm(shifts, axis=2), axis=1)
            enough = 2 * common.sum(axis=1) >= board.corner_count
            repeated[which[enough & (total < limit * common.sum(axis=1))]] = True
        return repeated

    @cached_property
    def _seen(self) -> Array:
        """(V, M, 2) each point's place in each view, pixels; NaN where it is not seen."""
        places = np.full((len(self.views), self.board.corner_count, 2), np.nan)
        for one, view in enumerate(self.views):
            places[one, view.observation.ids] = view.observation.corners
        return places

    def from_unit(self, unit: Array) -> Array:
        """Points (N, 6) of the unit cube to pose vectors (N, 6), most of them not in the space.

        Three angles over their range, the board's centre over the image, its distance over the
        logarithm of its range.
        """
        limits, camera = self.limits, self.camera
        angles = (2 * unit[:, :3] - 1) * limits.max_angle_deg
        z = limits.nearest * (limits.farthest / limits.nearest) ** unit[:, 5]
        if not camera.lens.is_perspective:
            pixels = unit[:, 3:5] * camera.image_size - 0.5
            return np.column_stack([angles, z[:, None] * rays_towards(camera, pixels)])
        x = (unit[:, 3] * camera.width - 0.5 - camera.cx) / camera.fx * z
        y = (unit[:, 4] * camera.height - 0.5 - camera.cy) / camera.fy * z
        return np.column_stack([angles, x, y, z])

    def to_unit(self, vectors: Array) -> Array:
        """The inverse of `from_unit`."""
        limits, camera = self.limits, self.camera
        z = vectors[:, 5]
        if not camera.lens.is_perspective:
            z = np.linalg.norm(vectors[:, 3:], axis=1)
            uv = (camera.pixels_of(vectors[:, 3:].T).T + 0.5) / camera.image_size
            far = np.log(z / limits.nearest) / np.log(limits.farthest / limits.nearest)
            return np.column_stack([(vectors[:, :3] / limits.max_angle_deg + 1) / 2, uv, far])
        return np.column_stack(
            [
                (vectors[:, :3] / limits.max_angle_deg + 1) / 2,
                (vectors[:, 3] / z * camera.fx + camera.cx + 0.5) / camera.width,
                (vectors[:, 4] / z * camera.fy + camera.cy + 0.5) / camera.height,
                np.log(z / limits.nearest) / np.log(limits.farthest / limits.nearest),
            ]
        )


def rays_towards(camera: Camera, pixels: Array) -> Array:
    """(N, 3) rays of a wide lens from pixels (N, 2), or from the nearest of its image circle."""
    centre, f = np.array([camera.cx, camera.cy]), np.array([camera.fx, camera.fy])
    edge = min(0.98 * camera.angle_limit, WIDEST)
    radius = camera.lens.image(camera.coefficients, np.array([np.sin(edge), 0.0, np.cos(edge)]))[0]
    image = (pixels - centre) / f
    length = np.maximum(np.linalg.norm(image, axis=1, keepdims=True), 1e-12)
    rays = camera.lens.rays(camera.coefficients, image * np.minimum(1.0, radius / length))
    return np.where(np.isfinite(rays), rays, [0.0, 0.0, 1.0])


def random_pose(space: Space, rng: np.random.Generator) -> Array:
    """(6,) a random pose vector of the space. Raises `VenusError` if none is found."""
    for _ in range(_TRIES):
        vectors = space.from_unit(rng.random((64, 6)))
        good = np.flatnonzero(space.accepts(vectors))
        if good.size:
            return vectors[good[0]]
    raise nothing_fits(space)


def _near(vectors: Array, pose: Pose) -> Mask:
    """Which vectors (N, 6) are within 15 degrees and a tenth of the distance of a pose."""
    shift = np.linalg.norm(vectors[:, 3:] - pose.t, axis=1)
    trace = np.einsum("nij,ij->n", rotations_of(vectors), pose.R)
    angle = np.degrees(np.arccos(np.clip((trace - 1) / 2, -1.0, 1.0)))
    near = shift < SKIPPED_FRACTION * np.linalg.norm(pose.t)
    return near & (angle < SKIPPED_DEG)


_NOTHING_FITS = Sentence(
    "No pose of this board fits the limits on a target; widen them (the distances {near:g} to "
    "{far:g} m, the tilt, the smallest square)."
)
_BECAUSE = Sentence("{cause} {changed}")
_CHANGED = Sentence("It is {parts}.")
_TURNED = Sentence("turned about {axis} by {new} instead of {old}")
_HELD = Sentence("held at {new} instead of {old}")
_CENTRED = Sentence("moved towards the centre of the picture")


def nothing_fits(space: Space) -> VenusError:
    """The error to raise if no pose of the space was found."""
    return VenusError(_NOTHING_FITS.format(near=space.limits.nearest, far=space.limits.farthest))


def onto_limits(
    limits: Limits, camera: Camera, board: Board, vectors: Array, *, steps: int = 2
) -> tuple[Array, Mask]:
    """Pose vectors (N, 6) moved onto the limits they break, and which (N,) are now within.

    Valid poses are unchanged. A step clips the angles, moves the board along its line of sight
    until size, distances and depth ratio fit, moves it sideways into the image and reduces its
    tilt. These interact a little: of the Gaussian neighbours of valid poses (0.1 of the unit cube),
    41 % are valid at once, 61, 89 and 96 % after one, two and three steps.
    """
    moved = np.array(vectors, dtype=np.float64)
    accepted = np.zeros(len(moved), dtype=bool)
    left = np.arange(len(moved))
    for step in range(steps + 1):
        p = moved[left]
        seen = visibility_of(camera, board, p)
        good = limits.within(camera, p, seen)
        accepted[left[good]] = True
        bad = np.flatnonzero(~good)
        left = left[bad]
        if step == steps or not left.size:
            break
        moved[left] = _step(limits, camera, p[bad], seen.of(bad))
    return moved, accepted


def brought_within(
    board: Board, camera: Camera, limits: Limits, vector: ArrayLike
) -> tuple[Array, str]:
    """The pose vector (6,) brought within the limits by the smallest change, and what changed.

    Tries a smaller tilt (X and Y angles scaled together), another distance along the line of sight,
    and a shift towards the image's centre. Ten degrees weigh as much as ten per cent of the
    distance or a tenth of the way to the centre. If none helps, the vector is unchanged, with the
    reason.
    """
    p = np.asarray(vector, dtype=np.float64).copy()
    if limits.accepts(camera, board, p)[0]:
        return p, ""
    cause = refusals(limits, camera, board, p)[0].text
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
            changed = _change_in_words(p, best)
            return best, _BECAUSE.format(cause=cause, changed=changed) if changed else cause
    return p, cause


def _change_in_words(before: Array, after: Array) -> str:
    parts: list[str] = []
    for name, old, new in zip("XY", before[:2], after[:2], strict=True):
        if abs(new - old) > 0.05:
            parts.append(_TURNED.format(axis=name, new=degrees(new), old=degrees(old)))
    if abs(after[5] / before[5] - 1) > 1e-6:
        new, old = size_mm(1000 * after[5]), size_mm(1000 * before[5])
        parts.append(_HELD.format(new=new, old=old))
    if np.linalg.norm(after[3:5] / after[5] - before[3:5] / before[5]) > 1e-6:
        parts.append(_CENTRED)
    return _CHANGED.format(parts=listed(parts)) if parts else ""


def _step(limits: Limits, camera: Camera, p: Array, seen: Visibility) -> Array:
    """One correction of vectors (N, 6)."""
    with np.errstate(all="ignore"):
        factor = _distance_factor(limits, camera, seen)
        t = p[:, 3:].T * factor
        t[:2] += _sideways(limits, camera, seen, t, factor)
        p[:, 3:] = t.T
        _cut_tilt(limits, p, seen.R.transpose(2, 0, 1))
    p[:, :3] = np.clip(p[:, :3], -limits.max_angle_deg, limits.max_angle_deg)
    return p


def _distance_factor(limits: Limits, camera: Camera, seen: Visibility) -> Array:
    """(N,) factors on the distance; nearer limits take precedence over farther ones."""
    low, high = limits.frame(camera)
    extent = (seen.high - seen.low) / (high - low)[:, None]
    # far - near hardly depends on the distance, so the ratio requires a nearest distance.
    nearest = np.maximum(limits.nearest, (seen.far - seen.near) / (limits.max_depth_ratio - 1))
    grow = np.maximum(extent.max(axis=0), nearest / seen.near)
    shrink = np.minimum(seen.side / limits.min_square_px, limits.farthest / seen.far)
    closer = np.where(shrink < 1, shrink * (1 - _SHARE), 1.0)
    factor = np.where(grow > 1, grow * (1 + _SHARE), closer)
    # Beyond the model's radius pixels are meaningless: move away from the lens, within reason.
    return np.where(seen.seen, np.clip(factor, 0.5, 2.0), 1.3)


def _sideways(limits: Limits, camera: Camera, seen: Visibility, t: Array, factor: Array) -> Array:
    """(2, N) metres that bring points outside the frame back into it, at the new distance.
    At depth Z a pixel is Z / f metres; a factor on the distance scales about the centre's pixel."""
    low, high = (bound[:, None, None] for bound in limits.frame(camera))
    f, c = np.array([[camera.fx], [camera.fy]]), np.array([[camera.cx], [camera.cy]])
    centre = (f * t[:2] / t[2] + c)[:, None]
    pixels = centre + (seen.pixels - centre) / factor
    if not camera.lens.is_perspective:
        # By the same pixels, at the same distance from the lens.
        right = np.max(np.maximum(low + _PX - seen.pixels, 0), axis=1)
        left = np.max(np.maximum(seen.pixels - (high - _PX), 0), axis=1)
        moved = rays_towards(camera, (camera.pixels_of(t) + right - left).T)
        aside = (np.linalg.norm(t, axis=0)[:, None] * moved).T[:2] - t[:2]
        return np.where(seen.seen, aside, -0.3 * t[:2])
    depth = seen.depth * factor
    below = np.max(np.maximum(low + _PX - pixels, 0) * depth, axis=1)
    above = np.max(np.maximum(pixels - (high - _PX), 0) * depth, axis=1)
    # Move a board that is not seen whole towards the optical axis.
    return np.where(seen.seen, (below - above) / f, -0.3 * t[:2])


def _cut_tilt(limits: Limits, p: Array, R: Array) -> None:
    """Cut the tilt of vectors (N, 6) with rotations (N, 3, 3) to the limit, by the smallest turn.

    In place. In the plane of the normal n and the line of sight l (both unit), the new normal is
    `cos(a) l + sin(a) m`, a the limit and m the part of n perpendicular to l. The smallest turn
    from n to n' is `1 + S + S^2 / (1 + n.n')`, S = n' n^T - n n'^T.
    """
    n, t = R[:, :, 2], p[:, 3:]
    line = t / np.sqrt(np.einsum("ni,ni->n", t, t))[:, None]
    cosine = np.einsum("ni,ni->n", n, line)
    tilted = np.flatnonzero(cosine < np.cos(np.radians(limits.max_tilt_deg)))
    if not tilted.size:
        return
    R, n, line = R[tilted], n[tilted], line[tilted]
    across = n - cosine[tilted, None] * line
    across /= np.maximum(np.sqrt(np.einsum("ni,ni->n", across, across)), 1e-9)[:, None]
    allowed = np.radians(limits.max_tilt_deg - _TILT_DEG)
    wanted = np.cos(allowed) * line + np.sin(allowed) * across
    skew = wanted[:, :, None] * n[:, None] - n[:, :, None] * wanted[:, None]
    turn = skew + skew @ skew / (1 + np.einsum("ni,ni->n", n, wanted))[:, None, None]
    p[tilted, :3] = angles_of(R + turn @ R)
