"""Poses that break the limits are brought onto them: the best poses of a search lie there.

Another answer to a broken limit, a sentence for a person, is `Limits.refusal`'s; one single pose
changed as little as possible is `limits.brought_within`'s.
"""

from __future__ import annotations

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, angles_of
from venus3d.engine.geometry.visibility import Visibility, visibility_of
from venus3d.engine.planning.limits import Limits, Mask

# Each correction is a Newton step. It aims a little inside, or the next one never gets through.
_TILT_DEG = 0.05
_SHARE = 1e-3
_PX = 0.2


def onto_limits(
    limits: Limits, camera: Camera, board: Board, vectors: Array, *, steps: int = 2
) -> tuple[Array, Mask]:
    """Pose vectors (N, 6) moved onto the limits they break, and which (N,) are within them now.

    Poses within the limits stay as they are. A step clips the angles, moves the board along its
    line of sight until size, distances and depth ratio fit, moves it sideways into the image and
    turns its normal towards the line of sight if it is tilted too far. These disturb each other a
    little: of the Gaussian neighbours of valid poses (0.1 of the unit cube), 41 % are valid at
    once, 61, 89 and 96 % after one, two and three steps.
    """
    moved = np.array(vectors, dtype=np.float64)
    accepted = np.zeros(len(moved), dtype=bool)
    left = np.arange(len(moved))
    for step in range(steps + 1):
        p = moved[left]
        sight = visibility_of(camera, board, p)
        good = limits.within(camera, p, sight)
        accepted[left[good]] = True
        bad = np.flatnonzero(~good)
        left = left[bad]
        if step == steps or not left.size:
            break
        moved[left] = _step(limits, camera, p[bad], sight.of(bad))
    return moved, accepted


def _step(limits: Limits, camera: Camera, p: Array, sight: Visibility) -> Array:
    """One correction of vectors (N, 6)."""
    with np.errstate(all="ignore"):
        factor = _distance_factor(limits, camera, sight)
        t = p[:, 3:].T * factor
        t[:2] += _sideways(limits, camera, sight, t, factor)
        p[:, 3:] = t.T
        _cut_tilt(limits, p, sight.R.transpose(2, 0, 1))
    p[:, :3] = np.clip(p[:, :3], -limits.max_angle_deg, limits.max_angle_deg)
    return p


def _distance_factor(limits: Limits, camera: Camera, sight: Visibility) -> Array:
    """(N,) by which the distance must change: nearer limits come before farther ones."""
    low, high = limits.frame(camera)
    extent = (sight.high - sight.low) / (high - low)[:, None]
    # far - near hardly changes with the distance, so the ratio asks for a nearest distance.
    nearest = np.maximum(limits.nearest, (sight.far - sight.near) / (limits.max_depth_ratio - 1))
    grow = np.maximum(extent.max(axis=0), nearest / sight.near)
    shrink = np.minimum(sight.side / limits.min_square_px, limits.farthest / sight.far)
    closer = np.where(shrink < 1, shrink * (1 - _SHARE), 1.0)
    factor = np.where(grow > 1, grow * (1 + _SHARE), closer)
    # Beyond the model's radius the pixels mean nothing: away from the lens, within reason.
    return np.where(sight.seen, np.clip(factor, 0.5, 2.0), 1.3)


def _sideways(limits: Limits, camera: Camera, sight: Visibility, t: Array, factor: Array) -> Array:
    """(2, N) metres that bring the points outside the frame back into it, at the new distance.

    A pixel of a point at depth Z is Z / f metres; a factor on the distance draws the pixels
    together about the centre's.
    """
    low, high = (bound[:, None, None] for bound in limits.frame(camera))
    f, c = np.array([[camera.fx], [camera.fy]]), np.array([[camera.cx], [camera.cy]])
    centre = (f * t[:2] / t[2] + c)[:, None]
    pixels = centre + (sight.pixels - centre) / factor
    depth = sight.depth * factor
    below = np.max(np.maximum(low + _PX - pixels, 0) * depth, axis=1)
    above = np.max(np.maximum(pixels - (high - _PX), 0) * depth, axis=1)
    # A board that is not seen as a whole is led towards the optical axis.
    return np.where(sight.seen, (below - above) / f, -0.3 * t[:2])


def _cut_tilt(limits: Limits, p: Array, R: Array) -> None:
    """Cut the tilt of vectors (N, 6) with rotations (N, 3, 3) down to the limit, by the least turn.

    In place. In the plane of the normal n and the line of sight l (both unit), the new normal is
    `cos(a) l + sin(a) m`, a the limit and m the part of n that is normal to l. The least turn that
    takes a unit vector n to n' is `1 + S + S^2 / (1 + n.n')`, S = n' n^T - n n'^T.
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
