"""The sentences beside the numbers: what they claim must be what happened."""

from __future__ import annotations

import numpy as np

from venus3d.engine.guidance.convergence import Progress
from venus3d.scene.pages.guide.progress_panel import brought_text


def after(views: int, uncertainty_px: float, promised_px: float = float("nan")) -> Progress:
    return Progress(
        views, 0.4, np.ones(9), np.ones(9), uncertainty_px, predicted_uncertainty_px=promised_px
    )


def test_what_the_last_view_brought() -> None:
    history = (after(4, 0.75), after(5, 0.60, 0.56))
    assert brought_text(history) == "The last view: 0.75 → 0.60 px (promised 0.56)."
    assert (
        brought_text((after(1, np.nan), after(2, 1.7)))
        == "The last view brought the uncertainty to 1.7 px."
    )
    assert brought_text((after(1, np.nan),)) == "" == brought_text(())


def test_a_gap_in_the_history_is_not_credited_to_the_last_view() -> None:
    """View 3 of 6 was dropped: two views were known before, five are now."""
    assert brought_text((after(1, np.nan), after(2, 1.77), after(5, 0.54))) == ""
    assert brought_text((after(5, 0.54),)) == "", "the first one was dropped"
