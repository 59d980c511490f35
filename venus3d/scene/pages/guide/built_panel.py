"""How a pose is built: the target's four steps from the upright board (the paper's eq. 15), which
explain the pose whatever the board does. Hidden until asked for, and drawn only then."""

from __future__ import annotations

from html import escape

import viser

from venus3d.engine.amounts import step_amount
from venus3d.engine.guidance.prompts import Wording, step_prompt
from venus3d.engine.planning.target import Target
from venus3d.languages import translated
from venus3d.render.projections import corners_outside_text
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.web.projections_panel import Sources, pictures_html, tile_html
from venus3d.scene.web.theme import Theme


class BuiltPanel:
    """The panel of one server."""

    def __init__(self, gui: viser.GuiApi) -> None:
        """Hidden, inside the current panel."""
        self._pictures = gui.add_html("", visible=False)
        self._tiles = gui.add_html("", visible=False)

    def show(
        self, target: Target | None, sources: Sources | None, theme: Theme, wording: Wording
    ) -> None:
        """Show these steps and pictures; without a target, or without pictures asked for, hide."""
        shown = target is not None and sources is not None
        self._pictures.visible = self._tiles.visible = shown
        if target is not None and sources is not None:
            self._pictures.content = pictures_html("built", sources)
            self._tiles.content = built_html(target, sources, theme, wording)


def built_html(target: Target, sources: Sources, theme: Theme, wording: Wording) -> str:
    """The four steps, each with its whole amount, words and picture."""
    tiles = "".join(
        tile_html(
            "built",
            step.number,
            source,
            escape(say.BUILT_FACT.format(number=step.number, amount=step_amount(step))),
            translated(step_prompt(step).text(wording)),
            theme,
            warning=corners_outside_text(len(step.corners_outside)),
        )
        for step, source in zip(target.steps, sources, strict=True)
    )
    return (
        f"<div class='v-steps'><h3>{say.BUILT_TITLE}</h3><div class='v-legend'>"
        f"{escape(say.BUILT_INTRO.format(number=target.number))}</div>"
        f"<div class='v-grid'>{tiles}</div></div>"
    )
