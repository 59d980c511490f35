"""Finds pictures that were turned by 180° among others, by a phone or a program.

In a picture turned about its middle the principal point (cx, cy) is at (w - 1 - cx, h - 1 - cy),
and p1, p2 and a thin prism's s1 to s4 change sign; fx, fy and the radial distortion stay. Fitted
together, such pictures and the others give a principal point in between, and nothing else tells. A
board turned by 180°, or a camera held upside down, turns no picture: the pose takes that up.

Each view has a sign, +1 or -1, by which the four odd parameters (cx and cy from the middle, p1, p2)
are multiplied. Near a fit the cost of any signs is a small sum of normal matrices, so they are
flipped one by one for as long as it falls. Other errors gain by signs too. What tells them apart:

- The signs gain more than the best of so many do by chance, against what is left to the views' own
  odd parameters, with the errors that a view's corners share (`shared_errors`).
- With the pictures turned back, the principal point lies off the middle by `OFF_MIDDLE` standard
  deviations. Nearer than that a turn can't be seen, and does little harm.
- They fit then: neighbouring corners are not off alike, or the signs gain far more.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.calibration import Calibration, LeftOut
from venus3d.engine.calibration.observation import (
    Observation,
    View,
    reprojection_errors,
    rms_distance,
    whole,
)
from venus3d.engine.calibration.residual_patterns import (
    ALIKE,
    least_squares_of,
    neighbour_correlation,
    view_residual,
)
from venus3d.engine.calibration.shared_errors import ViewResidual, corner_errors
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

Mask = NDArray[np.bool_]
FEWEST_VIEWS = 5
"""With fewer views, two kinds can't be told from errors that each view has."""
MANY_VIEWS = 8
UNLIKELY, UNLIKELY_FEW = (18.0, 24.0), (22.0, 36.0)
"""Twice the log-likelihood that signs must gain beyond chance, where the corners of a view share no
errors and where they do; of `MANY_VIEWS` or more, and of fewer, which tell less of what differs
from view to view. Sets with no picture turned reach 10 and 22 where the principal point lies off
the middle, few views of a phone that moves its lens 35."""
UNLIKELY_ALIKE = 50.0
"""The same where neighbouring corners are off alike even with the pictures turned back."""
OFF_MIDDLE = 3.5
"""Standard deviations by which the principal point must lie off the picture's middle."""
CLEAR = 9.0
"""Variances of the noise that a view's own sign must gain for the view to be named."""
FITS = 3.0
"""A view left out is turned if it fits, turned back, with this many times the others' rms."""
_ODD = ("cx", "cy", "p1", "p2", "s1", "s2", "s3", "s4")
_SHAPE = 3
_ROUNDS = 4


def turned(seen: Observation) -> Observation:
    """The observation in the picture turned by 180°."""
    return replace(seen, corners=np.array(seen.image_size) - 1 - seen.corners)


def turned_camera(camera: Camera) -> tuple[Camera, Array]:
    """The camera of the same pictures turned by 180°, and (p,) the derivatives of its parameters
    by those of `camera`, 1 or -1."""
    signs = np.where(_is_odd(camera)[:-_SHAPE], -1.0, 1.0)
    w, h = camera.image_size
    parameters = signs * camera.parameters + [0, 0, w - 1, h - 1, *[0] * len(camera.coefficients)]
    lit = camera.image_circle
    back = Camera.from_parameters(parameters, camera.image_size, camera.lens)
    circle = lit and replace(lit, x=w - 1 - lit.x, y=h - 1 - lit.y)
    return replace(back, image_circle=circle), signs


def turned_views(calibration: Calibration) -> tuple[int, ...]:
    """Numbers of the views whose pictures are turned by 180° against most others (of equally many,
    against the first); none in nearly all cases, and then quickly."""
    if len(calibration.views) < FEWEST_VIEWS or not all(calibration.free):
        return ()
    # Without regard to shared errors first, which is quick: signs that gain nothing end it.
    system = _Signs.of(calibration, shared=False)
    plain = system.best(np.ones(len(calibration.views)))
    if (plain > 0).all():
        return ()
    tried: list[Array] = [plain] if system.gain(plain) > 0 else []
    system = _Signs.of(calibration, shared=True)
    signs = system.best(plain)
    better = (signs < 0).any() and system.gain(signs) >= 0
    if better and not (tried and (signs == plain).all()):
        tried.insert(0, signs)
    # Both, as a turned picture looks like errors that views share until it is turned back.
    for signs in tried:
        with suppress(CalibrationError):
            if found := _told(calibration, signs):
                return found
    return ()


def without_turned(board: Board, calibration: Calibration) -> Calibration:
    """The calibration of `board` without the views whose pictures are turned; the same if none is,
    or if too few others are there."""
    found = set(turned_views(calibration))
    found |= {
        one.number
        for one in calibration.left_out
        if one.reason == "misfit" and fits_turned(calibration, one.observation)
    }
    if not found:
        return calibration
    views = [(view.number, whole(view)) for view in calibration.views]
    views += [
        (one.number, one.observation) for one in calibration.left_out if one.reason == "misfit"
    ]
    others = sorted((view for view in views if view[0] not in found), key=lambda view: view[0])
    try:
        again = calibrate(
            board,
            [seen for _, seen in others],
            lens=calibration.camera.lens,
            numbers=[number for number, _ in others],
        )
    except CalibrationError:
        return calibration
    left_out = [one for one in calibration.left_out if one.reason != "misfit"]
    left_out += [LeftOut(number, seen, "turned") for number, seen in views if number in found]
    left_out += again.left_out
    # The others tell what could not be told while some were among them.
    left_out.sort(key=lambda one: one.number)
    return without_turned(board, replace(again, left_out=tuple(left_out)))


def fits_turned(calibration: Calibration, seen: Observation) -> bool:
    """Whether an observation that was left out fits the camera once its picture is turned."""
    back, camera = turned(seen), calibration.camera
    pose = estimate_pose(camera, calibration.board, back)
    if pose is None:
        return False
    errors = reprojection_errors(camera, calibration.board, back, pose)
    return rms_distance(errors) < FITS * calibration.rms_px


def _told(calibration: Calibration, signs: Array) -> tuple[int, ...]:
    """`turned_views` by a calibration with the pictures turned back as the signs (N,) say, which
    it betters."""
    views, rounds = calibration.views, 0
    while True:
        again = _calibrated(calibration, views, signs)
        fitted = {view.number for view in again.views}
        signs = signs[[view.number in fitted for view in views]]
        views = tuple(view for view in views if view.number in fitted)
        system = _Signs.of(again, shared=True).with_signs(signs)
        better, rounds = system.best(signs), rounds + 1
        if (better == signs).all() or rounds == _ROUNDS:
            break
        signs = better
    if system.gain(signs) < _unlikely(again) or _off_middle(again) < OFF_MIDDLE:
        return ()
    told = (signs < 0) & (system.clear(signs) > CLEAR)
    return tuple(view.number for view, is_told in zip(views, told, strict=True) if is_told)


def _unlikely(again: Calibration) -> float:
    """What signs must gain, by the calibration with the pictures turned back."""
    if neighbour_correlation(again) >= ALIKE:
        return UNLIKELY_ALIKE  # they do not fit either: a rolling shutter, or the like
    least = UNLIKELY if len(again.views) >= MANY_VIEWS else UNLIKELY_FEW
    return least[again.corner_errors.shared_px > 0]


def _calibrated(calibration: Calibration, views: Sequence[View], signs: Array) -> Calibration:
    across, down, stretch = calibration.shape_sigma
    board = calibration.board
    bow = (board.bow[0] * (across == 0), board.bow[1] * (down == 0))
    board = replace(board, bow=bow, stretch=board.stretch * (stretch == 0))
    seen = [whole(view) for view in views]
    return calibrate(
        board,
        [turned(one) if sign < 0 else one for one, sign in zip(seen, signs, strict=True)],
        start=calibration.camera,
        numbers=[view.number for view in views],
    )


def _off_middle(calibration: Calibration) -> float:
    """How far the principal point lies off the picture's middle, in standard deviations."""
    camera = calibration.camera
    index = [2, 3]  # cx, cy
    off = camera.parameters[index] - (np.array(camera.image_size) - 1) / 2
    covariance = calibration.covariance[np.ix_(index, index)]
    return float(np.sqrt(off @ np.linalg.solve(covariance, off)))


@dataclass(frozen=True, eq=False)
class _Signs:
    """The cost of views for any signs, near a calibration."""

    grams: Array
    """(N, q + 1, q + 1) normal matrices of the camera's parameters, the board's shape and, last,
    the residuals that there are with odd parameters of zero; poses eliminated."""
    freedom: int
    """Number of residuals that the poses leave free."""
    is_odd: Mask
    """(q,) which of the parameters are odd."""

    @classmethod
    def of(cls, calibration: Calibration, *, shared: bool) -> _Signs:
        """`shared`: with the errors that the corners of each view share."""
        parts = [view_residual(calibration, view) for view in calibration.views]
        ratio = corner_errors(parts).ratio if shared else 0.0
        camera = calibration.camera
        values = camera.named
        values["cx"] -= (camera.width - 1) / 2
        values["cy"] -= (camera.height - 1) / 2
        is_odd = _is_odd(camera)
        odd = np.where(is_odd, [*values.values(), *[0.0] * _SHAPE], 0.0)
        grams = np.array([_gram(part, odd, ratio) for part in parts])
        return cls(grams, sum(part.freedom for part in parts), is_odd)

    def with_signs(self, signs: Array) -> _Signs:
        """The same for signs that count from these (N,), instead of +1 for each."""
        S = np.where(np.append(self.is_odd, False), signs[:, None], 1.0)
        return replace(self, grams=S[:, :, None] * self.grams * S[:, None])

    def best(self, signs: Array) -> Array:
        """(N,) signs that no single flip betters; most are +1, if equally many the first."""
        cost = self.cost(signs)
        while True:
            flipped = self.flipped(signs)
            index = int(np.argmin(flipped))
            if not flipped[index] < cost * (1 - 1e-9):
                break
            cost = float(flipped[index])
            signs = np.where(np.arange(len(signs)) == index, -signs, signs)
        return signs * np.sign(signs.sum() or signs[0])

    def cost(self, signs: Array) -> float:
        """The least sum of squares for signs (N,)."""
        return float(least_squares_of(self.with_signs(signs).grams.sum(axis=0)[None])[0])

    def flipped(self, signs: Array) -> Array:
        """(N,) the least sums of squares with each of the signs (N,) flipped."""
        each = self.with_signs(signs).grams
        odd = np.append(self.is_odd, False)
        return least_squares_of(each.sum(axis=0) - 2 * each * (odd[:, None] != odd))

    def gain(self, signs: Array) -> float:
        """Twice the log-likelihood that signs (N,) gain, less what the best of as many choices
        gains by chance: against what is left to the odd parameters of each view."""
        n, flips = len(signs), int((signs < 0).sum())
        cost, (own, noise) = self.cost(signs), self._own()
        freedom = int(self.is_odd.sum()) * (n - 1)
        gained = max(self.cost(np.ones(n)) - cost, 0.0)
        ways = gammaln(n + 1) - gammaln(flips + 1) - gammaln(n - flips + 1)
        left = max(cost - own, freedom * noise)
        return float(freedom * np.log1p(gained / left) - 2 * ways)

    def clear(self, signs: Array) -> Array:
        """(N,) how much each of the signs (N,) gains, in variances of the noise."""
        return (self.flipped(signs) - self.cost(signs)) / self._own()[1]

    def _own(self) -> tuple[float, float]:
        """The least sum of squares with odd parameters of each view's own, and the variance that
        it leaves."""
        odd = np.append(self.is_odd, False)
        own, cross = self.grams[:, odd][:, :, odd], self.grams[:, ~odd][:, :, odd]
        scale = 1.0 / np.sqrt(np.maximum(np.einsum("nii->ni", own), 1e-300))
        outer = scale[:, :, None] * scale[:, None]
        inverse = np.linalg.pinv(own * outer, hermitian=True) * outer
        rest = self.grams[:, ~odd][:, :, ~odd] - cross @ inverse @ cross.swapaxes(1, 2)
        least = float(least_squares_of(rest.sum(axis=0)[None])[0])
        fitted = odd.sum() * len(self.grams) + (~odd).sum() - 1
        return least, least / max(self.freedom - fitted, 1)


def _is_odd(camera: Camera) -> Mask:
    return np.array([name in _ODD for name in (*camera.parameter_names, *[""] * _SHAPE)])


def _gram(part: ViewResidual, odd: Array, ratio: float) -> Array:
    """(q + 1, q + 1) of a view's derivatives and of its residuals as they are with the parameters
    `odd` (q,) set to zero, weighed for this `ratio` of shared to independent errors."""
    columns = np.column_stack([part.intrinsics, part.errors + part.intrinsics @ odd])
    return part.gram(columns, ratio)
