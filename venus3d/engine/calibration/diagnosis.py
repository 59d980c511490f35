"""A sentence on what may be wrong with a calibration or with the board, its cause and its cure."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, get_args

DiagnosisKind = Literal[
    "wrong-dictionary",
    "swapped-size",
    "impossible-distance",
    "parallel-views",
    "weak-focal-length",
    "folding",
    "outlying-view",
    "unseen-side",
    "correlated",
    "same-depth",
    "wrong-layout",
]
"""Worst first: a wrong number given, then weak views, then a layout that is read rightly."""
_WORST_FIRST: tuple[DiagnosisKind, ...] = get_args(DiagnosisKind)


@dataclass(frozen=True)
class Diagnosis:
    """Something about a calibration that makes its numbers less trustworthy than they look."""

    kind: DiagnosisKind
    cause: str
    """One sentence: what is the matter, with figures."""
    cure: str
    """One sentence: what to do about it."""
    views: tuple[int, ...] = ()
    """Numbers of the views concerned; empty for all."""

    def __str__(self) -> str:
        """Both in one sentence."""
        return f"{self.cause.removesuffix('.')}; {self.cure[:1].lower()}{self.cure[1:]}"


def worst_first(found: Iterable[Diagnosis]) -> tuple[Diagnosis, ...]:
    """In the order of `DiagnosisKind`."""
    return tuple(sorted(found, key=lambda diagnosis: _WORST_FIRST.index(diagnosis.kind)))
