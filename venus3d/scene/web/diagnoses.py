"""What speaks against a calibration at one moment: how bad it is, and which is told first."""

from __future__ import annotations

from typing import Literal

from venus3d.engine.calibration.diagnosis import Diagnosis, DiagnosisKind
from venus3d.engine.guidance.snapshot import Snapshot

Severity = Literal["wrong", "weak", "note"]

SEVERITIES: dict[DiagnosisKind, Severity] = {
    "wrong-dictionary": "wrong",
    "swapped-size": "wrong",
    "impossible-distance": "wrong",
    "parallel-views": "weak",
    "weak-focal-length": "weak",
    "folding": "weak",
    "outlying-view": "weak",
    "unseen-side": "weak",
    "correlated": "weak",
    "same-depth": "weak",
    "wrong-layout": "note",
}


def another_board(snapshot: Snapshot) -> Diagnosis | None:
    """What says that another board is held up than the one asked for; None if nothing does."""
    unread = (d for d in snapshot.diagnoses if d.kind in ("wrong-dictionary", "swapped-size"))
    return next(unread, None)


def doubt(snapshot: Snapshot) -> Diagnosis | None:
    """The worst diagnosis that speaks against the result; None if none does."""
    against = (d for d in snapshot.diagnoses if SEVERITIES[d.kind] != "note")
    return next(against, None)
