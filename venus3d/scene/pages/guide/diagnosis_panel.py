"""The diagnoses against the result, above the progress; hidden while there are none. Each has a
title, a cause and a cure. Sign, shape and word give the severity without colours."""

from __future__ import annotations

from html import escape

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import translated
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.web.diagnoses import SEVERITIES, Severity

SHOWN = 2
"""Number of diagnoses shown in full; the others are only counted."""
_SIGNS: dict[Severity, str] = {"wrong": "✕", "weak": "!", "note": "i"}


def diagnoses_html(snapshot: Snapshot | None) -> str:
    """The diagnoses of a moment, worst first; empty without any."""
    if snapshot is None or not snapshot.diagnoses:
        return ""
    items = "".join(_item(diagnosis) for diagnosis in snapshot.diagnoses[:SHOWN])
    more = len(snapshot.diagnoses) - SHOWN
    rest = say.DIAGNOSES_MORE.format(count=more) if more > 0 else ""
    rest = f"<div class='v-more'>{rest}</div>" if rest else ""
    title = f"<h3>{say.DIAGNOSES_TITLE}</h3>"
    return f"<div class='v-progress' data-panel='diagnoses'>{title}{items}{rest}</div>"


def _item(diagnosis: Diagnosis) -> str:
    severity, title = SEVERITIES[diagnosis.kind], say.DIAGNOSIS_TITLES[diagnosis.kind]
    sign, word = _SIGNS[severity], say.SEVERITIES[severity]
    return (
        f"<div class='v-diagnosis v-is-{severity}' data-kind='{diagnosis.kind}'>"
        f"<div class='v-named'><b class='v-sign'>{sign}</b>{word}: {escape(title)}</div>"
        f"<div>{escape(translated(diagnosis.cause))}</div>"
        f"<div class='v-cure'>→ {escape(translated(diagnosis.cure))}</div></div>"
    )
