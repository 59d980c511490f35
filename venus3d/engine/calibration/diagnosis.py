"""One sentence on a possible problem with a calibration or the board: cause and cure."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, get_args

DiagnosisKind = Literal[
    "wrong-dictionary",
    "swapped-size",
    "mirrored",
    "other-pattern",
    "wrong-polarity",
    "unread-markers",
    "two-boards",
    "small-board",
    "thin-border",
    "blurred-pictures",
    "impossible-distance",
    "fisheye-lens",
    "wrong-lens",
    "cropped-pictures",
    "turned-pictures",
    "changed-focal-length",
    "bent-board",
    "rolling-shutter",
    "poor-fit",
    "parallel-views",
    "weak-focal-length",
    "folding",
    "left-out-view",
    "left-out-corners",
    "repeated-views",
    "outlying-view",
    "unseen-side",
    "correlated",
    "same-depth",
    "bowed-board",
    "stretched-print",
    "second-board",
    "wrong-layout",
    "other-first-id",
    "wrong-marker-size",
]
"""Worst first: a wrong number given, a model that does not fit, weak views, views left out; last,
what the calibration allows for."""
_WORST_FIRST: tuple[DiagnosisKind, ...] = get_args(DiagnosisKind)


@dataclass(frozen=True)
class Diagnosis:
    """A reason why a calibration is less trustworthy than its numbers."""

    kind: DiagnosisKind
    cause: str
    """One sentence: the problem, with figures."""
    cure: str
    """One sentence: the remedy."""
    views: tuple[int, ...] = ()
    """Numbers of the views concerned; empty for all."""

    def __str__(self) -> str:
        """Both in one sentence."""
        return f"{self.cause.removesuffix('.')}; {self.cure[:1].lower()}{self.cure[1:]}"


def joined(by_picture: Iterable[Diagnosis], by_fit: Iterable[Diagnosis]) -> tuple[Diagnosis, ...]:
    """What single pictures and what a calibration say, worst first; on the markers' size the
    calibration knows better."""
    fit = tuple(by_fit)
    measured = any(one.kind == "wrong-marker-size" for one in fit)
    pictures = [one for one in by_picture if not (measured and one.kind == "wrong-marker-size")]
    return worst_first(dict.fromkeys((*pictures, *fit)))


def worst_first(found: Iterable[Diagnosis]) -> tuple[Diagnosis, ...]:
    """In the order of `DiagnosisKind`."""
    return tuple(sorted(found, key=lambda diagnosis: _WORST_FIRST.index(diagnosis.kind)))
