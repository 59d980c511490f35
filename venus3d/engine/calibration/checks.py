"""Signs that a calibration is less trustworthy than its numbers, each with cause and cure.

A small rms and small sigmas mean that the model fits these views, not that the views were good.
`diagnose` looks at the views as a set. docs/diagnoses.md justifies the thresholds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from venus3d.engine.amounts import figure, whole
from venus3d.engine.calibration import fit_checks, picture_checks
from venus3d.engine.calibration.board_shape import FEWEST_VIEWS
from venus3d.engine.calibration.calibration import Calibration, largest_angle_deg
from venus3d.engine.calibration.diagnosis import Diagnosis, DiagnosisKind, worst_first
from venus3d.engine.calibration.legibility import legible_square_px, too_small_px
from venus3d.engine.calibration.other_cameras import other_cameras
from venus3d.engine.geometry.camera import planning_camera
from venus3d.engine.geometry.pose import Array
from venus3d.engine.sentences import Sentence, listed

WEAK_ANGLE_DEG = 20.0
"""If the normals of all views differ by less, the views are nearly parallel."""
TILTED_DEG = 40.0
"""If two normals differ by more, a weak focal length may have another cause than the tilt."""
WEAK_SIGMA = 0.01
"""A focal length whose sigma exceeds this share of it is weak."""
UNSEEN_SIDE = 0.25
"""A strip of this share of the image along one side without any corner is unseen."""
UNSEEN_CORNER = 0.4
"""The same for a rectangle of this share of width and height at an image corner."""
SAME_DEPTH = 1.25
"""Farthest over nearest board corner of all views; below it depth was not varied."""
OUTLYING_RATIO, OUTLYING_SPREADS = 1.75, 5.0
"""An outlying view's rms: this many medians, and this many robust spreads above the median."""
LEAST_OUTLYING_PX = 0.2
"""No view is called outlying below this rms."""
CORRELATED = 0.99
"""Parameters with a larger |correlation| are not separately determined, except for these:"""
CORRELATED_FOCAL = 0.9985
"""fx and fy share one scale; at this value it is known 36 times worse than their ratio."""
CORRELATED_RADIAL = 0.995
"""k1, k2 and k3 are terms of one series: 0.97 to 0.99 in good sets."""
NEAREST_M, FARTHEST_M = 0.04, 20.0
"""Distances from the lens, metres; no board is used nearer or farther. One with squares of 12 mm
fits into a wide picture at 44 mm."""

_BY_THE_LENS: tuple[DiagnosisKind, ...] = ("weak-focal-length", "folding")
"""What a lens model of too few coefficients brings about."""
_TILT_MORE = Sentence("Add views that are tilted by 20-45° and fill the picture.")
_AGREE = Sentence(
    "The views do not agree as their corners would let them: look for a board that is not flat, "
    "motion and blur; more views help, too."
)
_TILT = Sentence("Add views tilted by 20-45° in different directions.")
# Minimum relative spread of the views' rms: corner noise alone gives 8 % (40 corners, two axes).
_LEAST_SPREAD = 0.08


@dataclass(frozen=True)
class _Check:
    """One diagnosis, and the least number of views for it: while views still come, at the end (no
    more than that)."""

    growing: int
    final: int
    find: Callable[[Calibration], Iterable[Diagnosis]]
    needs_full: bool = True
    """Only if all parameters were estimated."""


class Diagnoses(NamedTuple):
    """What is doubtful about a calibration; worst first, empty if nothing is."""

    growing: tuple[Diagnosis, ...] = ()
    """While more views are being taken: what every set lacks at first (coverage of the image,
    several depths) is diagnosed later than for a final set."""
    final: tuple[Diagnosis, ...] = ()

    @staticmethod
    def of(calibration: Calibration) -> Diagnoses:
        """The diagnoses of a calibration; takes up to some tenths of a second."""
        count, full = len(calibration.views), all(calibration.free)
        growing: list[Diagnosis] = []
        final: list[Diagnosis] = []
        for check in _CHECKS:
            if count >= check.final and (full or not check.needs_full):
                found = tuple(check.find(calibration))
                final += found
                growing += found if count >= check.growing else ()
        if any(one.kind == "wrong-lens" for one in final):
            final = [one for one in final if one.kind not in _BY_THE_LENS]
            growing = [one for one in growing if one.kind not in _BY_THE_LENS]
        return Diagnoses(worst_first(growing), worst_first(final))


def diagnose(calibration: Calibration) -> tuple[Diagnosis, ...]:
    """What is doubtful about a calibration to which no more views come; worst first."""
    return Diagnoses.of(calibration).final


def _parallel_or_weak(calibration: Calibration) -> Iterator[Diagnosis]:
    share = 100 * _focal_share(calibration)
    angle = largest_angle_deg(calibration)
    if angle < WEAK_ANGLE_DEG:
        yield Diagnosis(
            "parallel-views",
            Sentence(
                "The views differ by only {angle}° in tilt, so the focal length is weak "
                "(± {share} % at best) and a low rms proves little."
            ).format(angle=whole(angle), share=figure(share)),
            _TILT,
        )
    elif share > 100 * WEAK_SIGMA:
        yield Diagnosis(
            "weak-focal-length",
            Sentence("The focal length is known to {share} % only.").format(share=figure(share)),
            # Were the corners' errors independent, these views would do: tilt is not what lacks.
            _AGREE if angle > TILTED_DEG and _noise_share(calibration) < WEAK_SIGMA else _TILT_MORE,
        )


def _small(calibration: Calibration) -> Iterator[Diagnosis]:
    board = calibration.board
    width = too_small_px(board, [view.observation for view in calibration.views])
    if width is not None:
        yield Diagnosis(
            "small-board",
            Sentence(
                "The board is small in the pictures: its squares are {width} px wide, where "
                "{needed} px are needed to read it reliably; corners are few and less exact."
            ).format(width=whole(width), needed=whole(legible_square_px(board))),
            Sentence("Bring it nearer, take pictures with more pixels, or print larger squares."),
        )


def _folding(calibration: Calibration) -> Iterator[Diagnosis]:
    camera = calibration.camera
    if planning_camera(camera) is camera:
        return
    farthest = float(np.linalg.norm(camera.image_corners - [camera.cx, camera.cy], axis=1).max())
    limit = camera.angle_limit
    if limit < np.pi / 2:
        edge = camera.lens.image(camera.coefficients, np.array([np.sin(limit), 0, np.cos(limit)]))
        where = Sentence("{edge} px from the centre").format(
            edge=whole(float(edge[0]) * (camera.fx + camera.fy) / 2)
        )
    else:
        where = Sentence("by its tangential part")
    yield Diagnosis(
        "folding",
        Sentence(
            "The lens model folds back {where}, and the picture's corners are up to {farthest} "
            "px away: the estimate cannot be used there."
        ).format(where=where, farthest=whole(farthest)),
        Sentence("Add views with the board near the picture's corners."),
    )


_OUTLYING_ONE = (
    Sentence("View {views} fits far worse than the others: rms {rms} px against {median} px."),
    Sentence("Leave it out, and take it again with the board flat and held still."),
)
_OUTLYING_MANY = (
    Sentence("Views {views} fit far worse than the others: rms {rms} px against {median} px."),
    Sentence("Leave them out, and take them again with the board flat and held still."),
)


def _outlying(calibration: Calibration) -> Iterator[Diagnosis]:
    rms = np.array([view.rms_px for view in calibration.views])
    median = float(np.median(rms))
    # 1.4826 median absolute deviations are one standard deviation of a normal distribution.
    spread = max(1.4826 * float(np.median(np.abs(rms - median))), _LEAST_SPREAD * median)
    limit = max(OUTLYING_RATIO * median, median + OUTLYING_SPREADS * spread, LEAST_OUTLYING_PX)
    worst = [view for view in calibration.views if view.rms_px > limit]
    if not worst:
        return
    worst.sort(key=lambda view: -view.rms_px)
    named = [
        f"{v.number} ({v.observation.name})" if v.observation.name else f"{v.number}" for v in worst
    ]
    errors = listed([figure(view.rms_px) for view in worst])
    cause, cure = _OUTLYING_MANY if len(worst) > 1 else _OUTLYING_ONE
    yield Diagnosis(
        "outlying-view",
        cause.format(views=listed(named), rms=errors, median=figure(median)),
        cure,
        tuple(view.number for view in worst),
    )


_SIDES = (Sentence("left"), Sentence("right"), Sentence("top"), Sentence("bottom"))
_SHARE = Sentence("{side} {share} %")
_CORNERS = (
    Sentence("upper left"),
    Sentence("upper right"),
    Sentence("lower left"),
    Sentence("lower right"),
)
_UNSEEN_CORNER = (
    Sentence(
        "The board was never in the picture's {corners} corner (up to {away} % of the picture "
        "away from it), where the lens bends most."
    ),
    Sentence("Add views with the board in the {corners} corner."),
)
_UNSEEN_CORNERS = (
    Sentence(
        "The board was never in the picture's {corners} corners (up to {away} % of the picture "
        "away from it), where the lens bends most."
    ),
    Sentence("Add views with the board in the {corners} corners."),
)


def _unseen(calibration: Calibration) -> Iterator[Diagnosis]:
    seen = np.concatenate([view.observation.corners for view in calibration.views])
    x, y = (seen / np.array(calibration.camera.image_size)).T
    free = (x.min(), 1 - x.max(), y.min(), 1 - y.max())
    sides = [(side, share) for side, share in zip(_SIDES, free, strict=True) if share > UNSEEN_SIDE]
    if sides:
        shares = [_SHARE.format(side=side, share=whole(100 * share)) for side, share in sides]
        yield Diagnosis(
            "unseen-side",
            Sentence(
                "No corner was ever seen in the picture's {shares}, so the lens is only guessed "
                "there."
            ).format(shares=listed(shares)),
            Sentence("Add views with the board at the {sides} of the picture.").format(
                sides=listed([side for side, _ in sides])
            ),
        )
        return
    places = {
        corner: float(np.maximum(abs(x - i % 2), abs(y - i // 2)).min())
        for i, corner in enumerate(_CORNERS)
    }
    corners = [place for place, share in places.items() if share > UNSEEN_CORNER]
    if corners:
        cause, cure = _UNSEEN_CORNERS if len(corners) > 1 else _UNSEEN_CORNER
        away = 100 * max(places[place] for place in corners)
        yield Diagnosis(
            "unseen-side",
            cause.format(corners=listed(corners), away=whole(away)),
            cure.format(corners=listed(corners)),
        )


def _same_depth(calibration: Calibration) -> Iterator[Diagnosis]:
    depths = _depths(calibration)
    ratio = float(depths.max() / depths.min())
    if ratio < SAME_DEPTH:
        yield Diagnosis(
            "same-depth",
            Sentence(
                "The board was always about {cm} cm away, and its tilt does not make up for "
                "it: the farthest corner is only {ratio:.2f} times as far as the nearest."
            ).format(cm=whole(100 * depths.mean()), ratio=ratio),
            Sentence("Add views from nearer and from farther away, and tilt the board."),
        )


_FOCAL_TOGETHER = (
    Sentence(
        "{one} and {other} are known only together (correlation {correlation:.4f}): there is "
        "little perspective in the views, so errors that all of them share, as of a board not "
        "quite flat, move the focal length by more than its sigma of {share} %."
    ),
    Sentence("Add views that are tilted more, by 30-45° in different directions."),
)
_SAME_GROUP = (
    Sentence(
        "{one} and {other} can hardly be told apart (correlation {correlation:.4f}): each by "
        "itself means little."
    ),
    Sentence("Add views with the board in the picture's corners, where the lens bends most."),
)
_TWO_GROUPS = (
    Sentence(
        "{one} and {other} can hardly be told apart (correlation {correlation:.4f}): an error of "
        "one hides in the other."
    ),
    Sentence("Add views tilted to the opposite side, and in the picture's corners."),
)


def _correlated(calibration: Calibration) -> Iterator[Diagnosis]:
    sigma = calibration.sigma
    correlation = np.abs(calibration.covariance / np.outer(sigma, sigma))
    # Each pair's distance from |correlation| 1 over the least allowed; below 1: too near.
    names = calibration.camera.parameter_names
    groups = [_group(name) for name in names]
    pairs = [
        ((1 - float(correlation[i, j])) / (1 - _allowed(groups[i], groups[j])), i, j)
        for i, j in combinations(range(len(names)), 2)
    ]
    tight = [pair for pair in sorted(pairs) if pair[0] < 1]
    if _focal_share(calibration) > WEAK_SIGMA or largest_angle_deg(calibration) < WEAK_ANGLE_DEG:
        tight = [pair for pair in tight if pair[1:] != (0, 1)]  # reported as a weak focal length
    if not tight:
        return
    i, j = tight[0][1:]
    if groups[i] == "f" == groups[j]:
        cause, cure = _FOCAL_TOGETHER
    else:
        cause, cure = _SAME_GROUP if groups[i] == groups[j] else _TWO_GROUPS
    cause = cause.format(
        one=names[i],
        other=names[j],
        correlation=correlation[i, j],
        share=figure(100 * _focal_share(calibration)),
    )
    yield Diagnosis("correlated", cause, cure)


def _group(name: str) -> str:
    return name[0] if name[0] in "fks" else name


def _allowed(one: str, other: str) -> float:
    """The largest |correlation| of parameters of two groups in good sets."""
    if one != other:
        return CORRELATED
    return CORRELATED_FOCAL if one == "f" else CORRELATED_RADIAL


_TOO_NEAR = Sentence(
    "With squares of {square:g} mm the board was {distance} mm from the lens, which is hardly "
    "possible: perhaps centimetres or inches were given as millimetres."
)
_TOO_FAR = Sentence(
    "With squares of {square:g} mm the board was {distance} m away, which is hardly possible: "
    "perhaps another unit was given as millimetres."
)


def _impossible(calibration: Calibration) -> Iterator[Diagnosis]:
    depths = _depths(calibration)
    if depths.min() >= NEAREST_M and depths.max() <= FARTHEST_M:
        return
    is_near = depths.min() < NEAREST_M
    yield Diagnosis(
        "impossible-distance",
        (_TOO_NEAR if is_near else _TOO_FAR).format(
            square=1000 * calibration.board.square,
            distance=whole(1000 * depths.min() if is_near else depths.max()),
        ),
        Sentence(
            "Measure a square and start again with --board.square-mm and --board.marker-mm; the "
            "camera's parameters stay as they are, but every distance is wrong."
        ),
    )


def _focal_share(calibration: Calibration) -> float:
    """Relative sigma of the focal length, the larger of the two axes."""
    return float(np.max(calibration.sigma[:2] / calibration.camera.parameters[:2]))


def _noise_share(calibration: Calibration) -> float:
    """The same if the errors of all corners were independent."""
    sigma = calibration.sigma_noise_only[:2]
    return float(np.max(sigma / calibration.camera.parameters[:2]))


def _depths(calibration: Calibration) -> Array:
    """(N,) depths of all corners of all views, metres; for a wide lens distances."""
    points_of = calibration.board.points_of
    points = np.concatenate([v.pose.apply(points_of(v.observation.ids)) for v in calibration.views])
    if not calibration.camera.lens.is_perspective:
        return np.asarray(np.linalg.norm(points, axis=1))
    return points[:, 2]


_CHECKS = (
    _Check(1, 1, _impossible, needs_full=False),
    _Check(3, 3, _small),
    _Check(3, 2, picture_checks.blurred),
    _Check(5, 2, _parallel_or_weak),
    _Check(5, 3, _folding),
    _Check(2, 2, other_cameras),
    _Check(2, 2, picture_checks.left_out),
    _Check(2, 2, picture_checks.turned),
    _Check(2, 2, picture_checks.repeats),
    _Check(1, 1, fit_checks.shape),
    _Check(FEWEST_VIEWS, FEWEST_VIEWS, fit_checks.pattern),
    _Check(4, 4, _outlying),
    _Check(6, 3, _unseen),
    _Check(6, 3, _same_depth),
    _Check(6, 4, _correlated),
)
