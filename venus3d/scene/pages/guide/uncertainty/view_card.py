"""One captured view: its picture, pose, residuals and information, and what excluding it would do;
as a card, and as a window in the tab in which it was clicked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from threading import Lock
from typing import Any, Literal, NamedTuple

import numpy as np
import viser

from venus3d.engine.amounts import figure, signed, whole
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import View
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.target import held_in_words
from venus3d.engine.planning.uncertainty import Influence
from venus3d.languages import number, translated
from venus3d.scene.pages.guide.uncertainty import texts

_FX, _FY = 0, 1
_SAME = 0.03
"""Relative change of the uncertainty below which a view hardly matters."""
_ALIKE = 0.1


def view_html(snapshot: Snapshot, number: int, picture: str = "") -> str:
    """The card of the view of this number; empty if the snapshot has none. `picture` is the source
    of an HTML image."""
    calibration = snapshot.calibration
    view = next((view for view in snapshot.views if view.number == number), None)
    if calibration is None or view is None:
        return ""
    left = None if snapshot.uncertainty is None else snapshot.uncertainty.without(number)
    alt = escape(texts.VIEW_ALT.format(number=number))
    image = f"<img alt='{alt}' src='{picture}'>" if picture else ""
    lines = [*_pose_lines(snapshot, view), _error_line(view, calibration)]
    judged = judgement(snapshot, number)
    if left is not None and judged.kind == "worse":
        lines.append(_gave_line(snapshot, calibration, left))
    told = "".join(f"<div class='v-line'>{escape(line)}</div>" for line in lines if line)
    title = escape(texts.VIEW_TITLE.format(number=number))
    return (
        f"<div class='v-progress v-view' data-view='{number}'><h3>{title}</h3>{image}{told}"
        f"{_what_if(snapshot, calibration, left, judged)}</div>"
    )


@dataclass(frozen=True)
class Judgement:
    """What leaving a view out would do, once for all that is said of it."""

    kind: Literal["unknown", "outlying", "same", "worse", "better"]
    """unknown: the others alone determine nothing; outlying: its corners fit far worse than all
    others'; else the result without it would be as certain, less, or more."""
    change: float = 0.0
    """Relative change of the uncertainty without it."""

    @property
    def sentence(self) -> str:
        """The judgement, in one sentence."""
        return texts.WITHOUT[self.kind].format(percent=abs(whole(100 * self.change)))


def judgement(snapshot: Snapshot, number: int) -> Judgement:
    """Judge the view of this number."""
    known = snapshot.uncertainty
    left = None if known is None else known.without(number)
    if known is None or left is None or not np.isfinite(left.uncertainty_px):
        return Judgement("unknown")
    change = left.uncertainty_px / known.uncertainty_px - 1
    if any(d.kind == "outlying-view" and number in d.views for d in snapshot.diagnoses):
        return Judgement("outlying", change)
    if abs(change) < _SAME:
        return Judgement("same", change)
    return Judgement("worse" if change > 0 else "better", change)


def _pose_lines(snapshot: Snapshot, view: View) -> list[str]:
    x, y, z, right, down, away = view.pose.vector() * [1, 1, 1, 1000, 1000, 1000]
    held = translated(held_in_words(view.pose, snapshot.camera))
    numbers = {"x": x, "y": y, "z": z, "right": right, "down": down, "away": away}
    rounded = {name: signed(value) for name, value in numbers.items()}
    return [texts.VIEW_HELD.format(held=held), texts.VIEW_POSE.format(**rounded)]


def _error_line(view: View, calibration: Calibration) -> str:
    ratio = view.rms_px / max(calibration.rms_px, 1e-12)
    against = (
        texts.VIEW_LIKE
        if abs(ratio - 1) < _ALIKE
        else texts.VIEW_ABOVE
        if ratio > 1
        else texts.VIEW_BELOW
    )
    line = texts.VIEW_ERROR.format(
        count=view.observation.count,
        rms=figure(view.rms_px),
        against=against,
        all=figure(calibration.rms_px),
    )
    if view.left_out is None:
        return line
    return f"{line} {texts.VIEW_LEFT_OUT.format(count=view.left_out.count)}"


def _gave_line(snapshot: Snapshot, calibration: Calibration, left: Influence) -> str:
    """What this view contributed, compared with all the others without it."""
    ratios = left.sigma / calibration.sigma
    most = int(np.argmax(ratios))
    known = snapshot.uncertainty
    return texts.VIEW_GAVE.format(
        without=figure(left.uncertainty_px),
        now=figure(np.nan if known is None else known.uncertainty_px),
        most=calibration.camera.parameter_names[most],
        ratio=figure(float(ratios[most])),
    )


def _what_if(
    snapshot: Snapshot, calibration: Calibration, left: Influence | None, judged: Judgement
) -> str:
    title = f"<h3>{escape(texts.WITHOUT_TITLE)}</h3>"
    known = snapshot.uncertainty
    said = escape(judged.sentence)
    if left is None or known is None or judged.kind == "unknown":
        return f"{title}<div class='v-line'>{said}</div>" if len(snapshot.views) > 1 else ""
    sigma = calibration.sigma
    pairs = (
        (known.uncertainty_px, left.uncertainty_px),
        (sigma[_FX], left.sigma[_FX]),
        (sigma[_FY], left.sigma[_FY]),
        (calibration.rms_px, left.rms_px),
    )
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td>{number(figure(float(now)))} px</td>"
        f"<td>{number(figure(float(then)))} px</td></tr>"
        for name, (now, then) in zip(texts.WITHOUT_ROWS, pairs, strict=True)
    )
    head = f"<tr><th></th><th>{texts.WITHOUT_NOW}</th><th>{texts.WITHOUT_THEN}</th></tr>"
    return (
        f"{title}<table class='v-without'>{head}{rows}</table><div class='v-verdict'>{said}</div>"
    )


class _Window(NamedTuple):
    """viser's handles of one."""

    number: int
    modal: Any
    card: Any
    drop: Any
    escape: Any

    def close(self) -> None:
        """Put it away."""
        self.modal.close()
        self.escape.remove()


class ViewWindow:
    """At most one per tab; Esc closes it. Callbacks come on viser's threads."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._open: dict[int, _Window] = {}

    def open(
        self,
        client: viser.ClientHandle,
        number: int,
        html: str,
        leave_out: Callable[[], None],
        *,
        may_leave_out: bool,
    ) -> None:
        """Show `html` of the view of this number, with a button that excludes it if allowed."""
        self.close(client)
        with self._lock, client.atomic():
            modal = client.gui.add_modal(texts.VIEW_TITLE.format(number=number))
            with modal:
                card = client.gui.add_html(html)
                drop = client.gui.add_button(
                    texts.LEAVE_OUT,
                    icon=viser.Icon.TRASH,
                    hint=texts.LEAVE_OUT_HINT,
                    visible=may_leave_out,
                )
                drop.on_click(lambda _: leave_out())
                drop.on_click(lambda _: self.close(client))
                close = client.gui.add_button(texts.CLOSE_VIEW, hint=texts.CLOSE_VIEW_HINT)
                close.on_click(lambda _: self.close(client))
            escape = client.gui.add_command(
                texts.CLOSE_VIEW_COMMAND, description=texts.CLOSE_VIEW_HINT, hotkey="escape"
            )
            escape.on_trigger(lambda _: self.close(client))
            self._open[client.client_id] = _Window(number, modal, card, drop, escape)

    def close(self, client: viser.ClientHandle) -> None:
        """Close this tab's window, if there is one."""
        with self._lock:
            opened = self._open.pop(client.client_id, None)
        if opened is not None:
            opened.close()

    def update(self, html_of: Callable[[int], str], *, may_leave_out: bool) -> None:
        """Tell in the windows of all tabs what is known now; `html_of` is empty for a view that
        there is no more, whose window closes."""
        with self._lock:
            for client, window in tuple(self._open.items()):
                window.card.content, window.drop.visible = html_of(window.number), may_leave_out
                if not window.card.content:
                    self._open.pop(client).close()
