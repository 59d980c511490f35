"""What makes the numbers doubtful: an area above the progress, absent while there is nothing.

Each diagnosis has a title, its cause and its cure. How bad it is can be told without colours, by
the sign, its shape and a word.
"""

from __future__ import annotations

from html import escape
from typing import Literal

from venus3d.engine.snapshot import Diagnosis, DiagnosisKind, Snapshot

Severity = Literal["wrong", "weak", "note"]

SHOWN = 2
"""So many are told in full; of the others only the number."""
TITLES: dict[DiagnosisKind, tuple[Severity, str]] = {
    "wrong-dictionary": ("wrong", "other markers than asked for"),
    "swapped-size": ("wrong", "rows and columns do not fit"),
    "impossible-distance": ("wrong", "impossible distance"),
    "parallel-views": ("weak", "views nearly parallel"),
    "weak-focal-length": ("weak", "focal length uncertain"),
    "folding": ("weak", "lens model folds back"),
    "outlying-view": ("weak", "one view stands out"),
    "unseen-side": ("weak", "part of the picture never used"),
    "correlated": ("weak", "parameters not told apart"),
    "same-depth": ("weak", "always the same distance"),
    "wrong-layout": ("note", "another layout of the board"),
}
"""How bad it is, and what it is in a few words."""
_SIGNS: dict[Severity, tuple[str, str]] = {
    "wrong": ("✕", "Wrong"),
    "weak": ("!", "Weak"),
    "note": ("i", "Note"),
}


def diagnoses_html(snapshot: Snapshot | None) -> str:
    """The diagnoses of a moment, worst first; empty if there are none."""
    if snapshot is None or not snapshot.diagnoses:
        return ""
    items = "".join(_item(diagnosis) for diagnosis in snapshot.diagnoses[:SHOWN])
    more = len(snapshot.diagnoses) - SHOWN
    rest = f"<div class='v-more'>and {more} more</div>" if more > 0 else ""
    return f"<div class='v-progress v-diagnoses'><h3>Before you trust this</h3>{items}{rest}</div>"


def another_board(snapshot: Snapshot) -> Diagnosis | None:
    """What says that another board is held up than the one asked for; None if nothing does."""
    unread = (d for d in snapshot.diagnoses if d.kind in ("wrong-dictionary", "swapped-size"))
    return next(unread, None)


def doubt(snapshot: Snapshot) -> Diagnosis | None:
    """The worst diagnosis that speaks against the result; None if none does."""
    against = (d for d in snapshot.diagnoses if TITLES[d.kind][0] != "note")
    return next(against, None)


def _item(diagnosis: Diagnosis) -> str:
    severity, title = TITLES[diagnosis.kind]
    sign, word = _SIGNS[severity]
    return (
        f"<div class='v-diagnosis v-is-{severity}' data-kind='{diagnosis.kind}'>"
        f"<div class='v-named'><b class='v-sign'>{sign}</b>{word}: {escape(title)}</div>"
        f"<div>{escape(diagnosis.cause)}</div>"
        f"<div class='v-cure'>→ {escape(diagnosis.cure)}</div></div>"
    )
