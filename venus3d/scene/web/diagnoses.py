"""Picks the diagnosis to report first, and how severe it is."""

from __future__ import annotations

from typing import Literal

from venus3d.engine.calibration.diagnosis import Diagnosis, DiagnosisKind
from venus3d.engine.guidance.snapshot import Snapshot

Severity = Literal["wrong", "weak", "note"]

SEVERITIES: dict[DiagnosisKind, Severity] = {
    "wrong-dictionary": "wrong",
    "swapped-size": "wrong",
    "mirrored": "wrong",
    "other-pattern": "wrong",
    "wrong-polarity": "wrong",
    "unread-markers": "wrong",
    "two-boards": "wrong",
    "small-board": "wrong",
    "impossible-distance": "wrong",
    "fisheye-lens": "wrong",
    "wrong-lens": "wrong",
    "cropped-pictures": "wrong",
    "turned-pictures": "weak",
    "changed-focal-length": "weak",
    "bent-board": "weak",
    "rolling-shutter": "weak",
    "poor-fit": "weak",
    "parallel-views": "weak",
    "weak-focal-length": "weak",
    "folding": "weak",
    "left-out-view": "note",
    "left-out-corners": "weak",
    "repeated-views": "note",
    "outlying-view": "weak",
    "unseen-side": "weak",
    "correlated": "weak",
    "same-depth": "weak",
    "bowed-board": "note",
    "stretched-print": "note",
    "second-board": "note",
    "wrong-layout": "note",
    "other-first-id": "note",
    "wrong-marker-size": "note",
    "thin-border": "note",
}

_UNREAD: tuple[DiagnosisKind, ...] = (
    "wrong-dictionary",
    "swapped-size",
    "mirrored",
    "other-pattern",
    "wrong-polarity",
    "unread-markers",
    "two-boards",
)


def another_board(snapshot: Snapshot) -> Diagnosis | None:
    """The diagnosis that the board in view is not the configured one; None if there is none."""
    unread = (d for d in snapshot.diagnoses if d.kind in _UNREAD)
    return next(unread, None)


def doubt(snapshot: Snapshot) -> Diagnosis | None:
    """The worst diagnosis against the result; None if there is none."""
    against = (d for d in snapshot.diagnoses if SEVERITIES[d.kind] != "note")
    return next(against, None)
