"""Tells the page, and now and then the terminal, how the pictures flow: `guide --stats`."""

from __future__ import annotations

import time

from venus3d.scene.pages.guide import terminal_texts, texts
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.page import announce
from venus3d.sources.frame import Source
from venus3d.sources.live import Live
from venus3d.threads.flow import Flow, FlowFigures

_PAGE_EVERY_S = 1.0
_PRINT_EVERY_S = 10.0


class FlowNews:
    """Used by one thread."""

    def __init__(self, flow: Flow, viewer: Viewer) -> None:
        """`viewer` is asked for when its pictures are sent."""
        self._flow, self._viewer = flow, viewer
        self._shown_s = self._printed_s = time.monotonic()
        viewer.on_sent = flow.note_sent

    def tell(self, source: Source) -> None:
        """Tell what is due; call it often."""
        now_s = time.monotonic()
        if now_s - self._shown_s < _PAGE_EVERY_S:
            return
        self._shown_s = now_s
        figures = self._flow.figures(source.damaged if isinstance(source, Live) else 0)
        self._viewer.flows(_said(texts.FLOW, figures))
        if now_s - self._printed_s >= _PRINT_EVERY_S:
            self._printed_s = now_s
            announce(_said(terminal_texts.FLOW, figures))


def _said(template: str, figures: FlowFigures) -> str:
    return template.format(
        came=figures.per_second["came"],
        searched=figures.per_second["searched"],
        sent=figures.per_second["sent"],
        age=1000 * figures.age_s,
        all=figures.came,
        skipped=figures.skipped / max(1, figures.came),
        damaged=figures.damaged,
    )
