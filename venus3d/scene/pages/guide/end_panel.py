"""The end of a calibration: the question before it, its buttons, and the result in large figures
to read off and copy."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

import numpy as np
import viser

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.geometry.field_of_view import fields_of_view_deg
from venus3d.engine.guidance.prompts import Phase
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.sentences import listed
from venus3d.languages import translated
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import Intent, PageAction
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.pages.guide.uncertainty.maps import map_html, map_of
from venus3d.scene.pages.guide.uncertainty.parameters import figures
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.copy_button import copy_button
from venus3d.scene.web.step_card import Note, guide_card, second_line
from venus3d.scene.web.theme import Theme

OVER: tuple[Phase, ...] = ("converged", "finished")
"""The phases in which no more views are asked for."""
_FEW = 9
"""So many parameters fit below each other in large letters."""


class EndButtons:
    """What can be chosen when a calibration ends: end it now, go on, begin a new one."""

    def __init__(self, gui: viser.GuiApi, ask: Callable[[Intent], None]) -> None:
        """Make them in the current panel; `ask` is called on viser's threads."""
        title, hint = say.ROWS["end"]
        labels = _end_labels(asked=True, over=False)
        self._row = ButtonRow[Intent](gui, title, labels, lambda intent, _: ask(intent), hint=hint)
        self._row.visible = False

    def show(self, state: ViewState, phase: Phase) -> None:
        """Show those that mean something now."""
        if state.other_size:
            self._row.show({PageAction.NEW_SESSION: say.NEW_SESSION})
        else:
            self._row.show(_end_labels(asked=state.asked_to_end, over=phase in OVER))


def _end_labels(*, asked: bool, over: bool) -> dict[Intent, str]:
    if asked:
        return {PageAction.END_NOW: say.END_NOW, PageAction.GO_ON: say.GO_ON}
    return {PageAction.GO_ON: say.GO_ON, PageAction.NEW_SESSION: say.NEW_SESSION} if over else {}


class EndMap:
    """How well the camera is known over the picture, once the calibration is over."""

    def __init__(self, gui: viser.GuiApi) -> None:
        """Make it in the current panel, hidden."""
        self._shown: tuple[object, ...] = ()
        self._map = gui.add_html("", visible=False)

    def show(self, snapshot: Snapshot, theme: Theme) -> None:
        """Draw it once for each calibration that is over; slow."""
        over = snapshot.phase in OVER and snapshot.uncertainty is not None
        self._map.visible = over
        if over and (snapshot.calibration, theme) != self._shown:
            self._shown = (snapshot.calibration, theme)
            shown = map_html(map_of(snapshot, "now", dark=theme.dark))
            self._map.content = f"<div class='v-end-map'>{shown}</div>"


def question_card(snapshot: Snapshot, theme: Theme, note: Note) -> str:
    """What it means to end the calibration now."""
    if snapshot.calibration is None:
        return guide_card(theme.quiet, "?", say.END_QUESTION, say.END_WITHOUT_RESULT, note=note)
    below = second_line(unsettled_text(snapshot) or say.ALL_SETTLED)
    sentence = _focal_text(snapshot, snapshot.calibration)
    return guide_card(theme.quiet, "?", say.END_QUESTION, sentence, below=below, note=note)


def ended_card(snapshot: Snapshot, theme: Theme, note: Note) -> str:
    """The card of a calibration that was ended by hand; with a tick only if all has settled."""
    if snapshot.calibration is None:
        return guide_card(theme.quiet, "■", say.ENDED, say.ENDED_WITHOUT_RESULT, note=note)
    missing, sentence = unsettled_text(snapshot), _focal_text(snapshot, snapshot.calibration)
    if missing:
        below = second_line(f"{missing} {say.UNSETTLED_NEXT}")
        return guide_card(theme.quiet, "■", say.UNSETTLED, sentence, below=below, note=note)
    return guide_card(theme.reached, "✓", say.FINISHED, sentence, note=note)


def unsettled_text(snapshot: Snapshot) -> str:
    """Which parameters have not settled, in a sentence; empty if all have."""
    judged, known = snapshot.convergence, snapshot.calibration
    if known is None:
        return ""
    names = known.camera.parameter_names if judged is None else judged.unsettled
    return say.NOT_SETTLED.format(names=translated(listed(names))) if names else ""


def _focal_text(snapshot: Snapshot, calibration: Calibration) -> str:
    value, sigma = figures(calibration.camera.fx, float(calibration.sigma[0]), 0)
    return say.FOCAL.format(value=value, sigma=sigma, views=_views_text(snapshot))


def _views_text(snapshot: Snapshot) -> str:
    """How many views the calibration is of; those captured too, if some of them do not count."""
    count, captured = len(snapshot.views), snapshot.captured_count
    if count < captured:
        return say.FROM_SOME_VIEWS.format(count=count, all=captured)
    return say.FROM_VIEW if count == 1 else say.FROM_VIEWS.format(count=count)


def result_html(snapshot: Snapshot, saved: str, measure_url: str = "") -> str:
    """The result of a calibration that is over: parameters to copy, field of view, where it is
    saved, the page on which one measures with it; empty before."""
    known = snapshot.calibration
    if known is None or snapshot.phase not in OVER:
        return ""
    wide, high, across = fields_of_view_deg(known.camera)
    view = say.FIELD_OF_VIEW.format(wide=wide, high=high, across=across)
    copies = "".join(
        copy_button(text, label, hint) for text, (label, hint) in _copies(known, snapshot)
    )
    last = snapshot.history[-1]
    line = say.RESULT_LINE.format(
        views=_views_text(snapshot), rms=figure(known.rms_px), error=figure(last.uncertainty_px)
    )
    where = f"<div class='v-line'>{escape(translated(saved))}</div>" if saved else ""
    lens = known.lens_reason
    lens = f"<div class='v-line'>{escape(translated(lens))}</div>" if lens else ""
    title = f"<h3 title='{escape(say.RESULT_HINT)}'>{say.RESULT_TITLE}</h3>"
    return (
        f"<div class='v-progress' data-panel='result'>{title}{_figures(known)}"
        f"<div class='v-line' title='{escape(say.FIELD_OF_VIEW_HINT)}'>{view}</div>"
        f"{lens}<div class='v-line' title='{escape(say.UNCERTAINTY_HINT)}'>{line}</div>"
        f"<div class='v-copies'>{copies}{_measure_link(measure_url)}</div>{where}</div>"
    )


def _measure_link(url: str) -> str:
    if not url:
        return ""
    return (
        f"<a href='{escape(url, quote=True)}' target='_blank' rel='noopener' "
        f"title='{escape(say.MEASURE_HINT)}'>{escape(say.MEASURE)} ↗</a>"
    )


def _figures(known: Calibration) -> str:
    """All parameters, the pinhole's and the lens's: below each other, large, where both fit into
    the window, else side by side."""
    count = len(known.free)
    halves = "".join(
        f"<div>{''.join(_cell(known, index) for index in half)}</div>"
        for half in (range(4), range(4, count))
    )
    return f"<div class='v-figures' {'data-few' if count <= _FEW else ''}>{halves}</div>"


def _cell(known: Calibration, index: int) -> str:
    value, sigma = figures(float(known.camera.parameters[index]), float(known.sigma[index]), index)
    extra = f" <i>± {sigma}</i>" if sigma else f" <i>{say.HELD}</i>"
    exact = f"{known.camera.parameters[index]:.10g}"
    name = known.camera.parameter_names[index]
    return (
        f"<div class='v-parameter'><b>{name}</b><span>{value}{extra}</span>"
        f"{copy_button(exact, hint=say.COPY_ONE.format(name=name))}</div>"
    )


def _copies(known: Calibration, snapshot: Snapshot) -> list[tuple[str, tuple[str, str]]]:
    camera = known.camera
    matrix = np.array2string(camera.K, separator=", ", precision=6, suppress_small=True)
    lens = np.array2string(camera.distortion, separator=", ", precision=8)
    python = say.PYTHON.format(matrix=" ".join(matrix.split()), lens=lens)
    lines = [
        f"{name}\t{value:.10g}\t{sigma:.4g}"
        for name, value, sigma in zip(
            camera.parameter_names, camera.parameters, known.sigma, strict=True
        )
    ]
    error = snapshot.history[-1].uncertainty_px
    table = "\n".join([*lines, f"uncertainty_px\t{error:.4g}", ""])
    return [(python, say.COPY_PYTHON), (table, say.COPY_TABLE)]
