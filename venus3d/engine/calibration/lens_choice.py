"""Which lens it is: models from simple to rich, judged by how well they predict held-out views.

Each model is fitted to all views. Without a view v, the intrinsics differ to first order by
d = (H - H_v)^-1 M_v^T e_v, where M_v is the Jacobian of v with its pose projected out, e_v its
residual likewise, and H the sum of all M^T M. Under these intrinsics the view's residual is
e_v + M_v d with its best pose: the leave-one-out prediction (PRESS, Allen 1974), without a refit.

A richer model must predict better by more than what differs from view to view by chance, and fit
better too: with few views the fewer parameters predict better, whatever the lens is. brown5 is the
simplest that is chosen, since its five coefficients are what other programs expect, and what is
undetermined of them is told by the covariance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.adjustment import CroppedError, calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.shared_errors import ViewResidual
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera, planning_camera
from venus3d.engine.geometry.field_of_view import fields_of_view_deg
from venus3d.engine.geometry.lenses import BROWN5, FISHEYE, RATIONAL, LensModel
from venus3d.engine.geometry.pose import Array
from venus3d.engine.sentences import Sentence

CANDIDATES: tuple[LensModel, ...] = (BROWN5, FISHEYE, RATIONAL)
"""From simple to rich: the fisheye has fewer coefficients than the rational lens, and those that
are wide."""
BETTER = 0.94
"""Rms of fit and of prediction that a richer model must have, as a share of the simpler one's."""
CERTAIN = 2.5
"""Standard errors of the difference from view to view by which it must predict better."""
FEWEST_VIEWS = 5
"""With fewer views, prediction says nothing, and only a model that does not fit is replaced."""
NARROW_DEG = 75.0
"""From corner to corner: five coefficients describe a lens that sees less."""
WIDE_DEG = 100.0
"""Across the picture, from which on a model that folds back in it is replaced."""
FOLDED = 1.1
"""A model that folds back in the picture gives way to a richer one up to this share of its rms."""
HOPELESS = 1.7
"""A model whose rms is this many times that of a richer one does not fit."""
GOOD_PX = 1.0
"""Rms above which a richer model explains nothing."""
_KEPT = 0.97
"""Share of the corners that a model may leave out more than another one."""
_OPEN_PX = 1.0
"""Projection uncertainty above which a richer model is not believed if a simpler one has less."""

_FISHEYE = Sentence(
    "This lens bends like a fisheye: {angle}° across; with five coefficients the corners would be "
    "{rms} px off."
)
_FISHEYE_ONLY = Sentence(
    "This lens bends like a fisheye: {angle}° across; with five coefficients nothing fits."
)
_RATIONAL = Sentence(
    "This lens needs eight coefficients (rational): with five the corners would be {rms} px off."
)
_RATIONAL_ONLY = Sentence("This lens needs eight coefficients (rational): with five nothing fits.")


@dataclass(frozen=True, eq=False)
class _Tried:
    calibration: Calibration
    squares: Array
    """(N,) sum of each view's squared residuals, px^2."""
    held_out: Array
    """(N,) the same of its prediction from the other views."""
    corners: int
    numbers: tuple[int, ...]


def calibrate_with_any_lens(
    board: Board,
    observations: Sequence[Observation],
    *,
    numbers: Sequence[int] | None = None,
) -> Calibration:
    """`calibrate` with the simplest of the lens models that predicts the views as well as any.
    `Calibration.lens_reason` says why, if it is not the first. Raises the first one's
    `CalibrationError` if the views determine none of them."""

    def fitted(lens: LensModel) -> Calibration:
        return calibrate(board, observations, lens=lens, numbers=numbers)

    return chosen_lens(fitted)


def chosen_lens(
    fitted: Callable[[LensModel], Calibration], candidates: Sequence[LensModel] = CANDIDATES
) -> Calibration:
    """The same, for any way to calibrate with a lens."""
    best: _Tried | None = None
    first: _Tried | None = None
    failed: CalibrationError | None = None
    for lens in candidates:
        try:
            tried = _tried(fitted(lens))
        except CalibrationError as error:
            failed = failed or error
            continue
        if lens is candidates[0]:
            first = tried
        usable = best is None and (lens is candidates[0] or tried.calibration.rms_px < GOOD_PX)
        if usable or (best is not None and _is_better(tried, best)):
            best = tried
        if first is tried and _is_narrow(tried.calibration.camera):
            break
    if best is None:
        raise failed or CalibrationError("There is no lens model to try.")
    # The edge of a larger picture bends to one side, which a fisheye follows a little.
    if isinstance(failed, CroppedError) and HOPELESS * failed.rms_px < best.calibration.rms_px:
        raise failed
    lens = best.calibration.camera.lens
    if lens is candidates[0]:
        return best.calibration
    return replace(best.calibration, lens_reason=_reason(best, first))


def _is_narrow(camera: Camera) -> bool:
    diagonal = np.hypot(camera.width / camera.fx, camera.height / camera.fy)
    return bool(np.degrees(2 * np.arctan(diagonal / 2)) < NARROW_DEG)


def start_with_any_lens(
    board: Board,
    observations: Sequence[Observation],
    *,
    lens: LensModel | None = None,
    numbers: Sequence[int] | None = None,
) -> Calibration:
    """`calibrate` with the start-up model, of a pinhole or an equidistant lens, whichever fits.
    `lens`: the one that is wanted; None: it is found out. Raises `CalibrationError` likewise."""

    def started(which: LensModel) -> Calibration:
        return calibrate(board, observations, model="startup", lens=which, numbers=numbers)

    if lens is not None:
        return started(BROWN5 if lens.is_perspective else lens)
    plain = started(BROWN5)
    if _is_narrow(plain.camera):
        return plain
    try:
        wide = started(FISHEYE)
    except CalibrationError:
        return plain
    return wide if wide.rms_px * HOPELESS < plain.rms_px else plain


def held_out_squares(calibration: Calibration) -> Array:
    """(N,) sum of squares of each view's corners, predicted from the other views, px^2."""
    parts = [_residual(calibration, index) for index in range(len(calibration.views))]
    grams = np.array([part.intrinsics.T @ part.intrinsics for part in parts])
    total = grams.sum(axis=0)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(total), 1e-300))
    outer = scale[:, None] * scale
    found: list[float] = []
    for part, gram in zip(parts, grams, strict=True):
        others = (total - gram) * outer + 1e-13 * np.eye(len(total))
        gradient = scale * (part.intrinsics.T @ part.errors)
        moved = scale * np.linalg.solve(others, gradient)
        predicted = part.errors + part.intrinsics @ moved
        found.append(float(predicted @ predicted))
    return np.array(found)


def _residual(calibration: Calibration, index: int) -> ViewResidual:
    view, board = calibration.views[index], calibration.board
    points = board.points_of(view.observation.ids)
    J = calibration.camera.jacobians(points, view.pose.R[None], view.pose.t[None])[0]
    return ViewResidual.of(board, points, view.errors.T, J)


def _tried(calibration: Calibration) -> _Tried:
    return _Tried(
        calibration,
        np.array([float((view.errors**2).sum()) for view in calibration.views]),
        held_out_squares(calibration),
        sum(view.observation.count for view in calibration.views),
        tuple(view.number for view in calibration.views),
    )


def _is_better(rich: _Tried, simple: _Tried) -> bool:
    camera = rich.calibration.camera
    if planning_camera(camera) is not camera:
        return False  # folds back within the picture
    rms = rich.calibration.rms_px
    if rms > GOOD_PX or rich.corners < _KEPT * simple.corners:
        return False
    # No lens folds back within its picture: such a model has only not been shown where it fails.
    # A narrower lens is brown5 all the same, and gets a diagnosis.
    folds = planning_camera(simple.calibration.camera) is not simple.calibration.camera
    if (
        folds
        and fields_of_view_deg(camera)[0] > WIDE_DEG
        and rms < FOLDED * simple.calibration.rms_px
    ):
        return True
    # What a model leaves out, it does not describe.
    describes_more = simple.corners < _KEPT * rich.corners
    if HOPELESS * rms < simple.calibration.rms_px or (
        describes_more and rms < HOPELESS * simple.calibration.rms_px
    ):
        return True
    open_px = rich.calibration.uncertainty_px
    if open_px > _OPEN_PX and open_px > 2 * simple.calibration.uncertainty_px:
        return False
    if len(rich.squares) < FEWEST_VIEWS or rms > BETTER * simple.calibration.rms_px:
        return False
    common = sorted(set(rich.numbers) & set(simple.numbers))
    ours = rich.held_out[[rich.numbers.index(n) for n in common]]
    theirs = simple.held_out[[simple.numbers.index(n) for n in common]]
    # Of the logarithms: one view that a model predicts badly must not decide alone.
    gain = np.log(np.maximum(theirs, 1e-30) / np.maximum(ours, 1e-30))
    chance = float(gain.std(ddof=1)) / np.sqrt(len(gain))
    return bool(ours.sum() < BETTER**2 * theirs.sum() and gain.mean() > max(CERTAIN * chance, 0.0))


def _reason(best: _Tried, first: _Tried | None) -> Sentence:
    camera = best.calibration.camera
    fits = first is not None and first.corners >= _KEPT * best.corners
    rms = f"{first.calibration.rms_px:.2g}" if first is not None else ""
    if camera.lens.is_perspective:
        return _RATIONAL.format(rms=rms) if fits else _RATIONAL_ONLY
    angle = f"{fields_of_view_deg(camera)[0]:.0f}"
    return _FISHEYE.format(angle=angle, rms=rms) if fits else _FISHEYE_ONLY.format(angle=angle)
