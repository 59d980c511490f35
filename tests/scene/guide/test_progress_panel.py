"""The sentences beside the numbers: what they claim must be what happened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from venus3d.engine.guidance.convergence import Convergence, Progress
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.forecast import Forecast
from venus3d.scene.pages.guide.end_panel import unsettled_text
from venus3d.scene.pages.guide.progress_panel import brought_text, progress_html


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


def test_parameters_are_told_to_be_unsettled_only_where_one_is(guided: Snapshot) -> None:
    """The same judgement as in the parameters' tab and the question before the end, also where
    somebody goes on although all have settled."""
    reached = replace(guided, forecast=Forecast(1000.0, views=0, low=0, high=0, looked_ahead=10))
    names = guided.camera.parameter_names
    told = {
        (): "below 1000 px already.",
        ("k3",): "; one parameter is still to settle.",
        ("k2", "k3"): "; 2 of 9 parameters are still to settle.",
        names: "; no parameter has settled yet.",
    }
    for unsettled, words in told.items():
        judged = tuple(name not in unsettled for name in names)
        convergence = Convergence(np.ones(9), judged, "repaired")
        shown = replace(reached, convergence=convergence, phase="guiding")
        assert words in progress_html(shown)
        assert bool(unsettled) == bool(unsettled_text(shown))


def test_the_views_are_counted_from_their_capture(guided: Snapshot) -> None:
    assert guided.captured is not None
    thinking = replace(guided, phase="captured", captured=(*guided.captured, 6))
    assert f"<b>{len(guided.captured) + 1}</b>" in progress_html(thinking)


def test_a_gap_in_the_history_is_not_credited_to_the_last_view() -> None:
    """View 3 of 6 was dropped: two views were known before, five are now."""
    assert brought_text((after(1, np.nan), after(2, 1.77), after(5, 0.54))) == ""
    assert brought_text((after(5, 0.54),)) == "", "the first one was dropped"
