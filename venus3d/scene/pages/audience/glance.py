"""The second monitor's HTML: one sentence, the dial and the four steps around the picture.

CSS alone makes the layout. The picture (viser's canvas) has the upper left corner and more than
half of a wide screen, with the dial to its right and the sentence below; on a tall screen it has
the whole width and the rest is below. Font sizes follow the screen's height.
"""

from __future__ import annotations

from html import escape

import numpy as np

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.dial import dial_html, tick_html
from venus3d.scene.pages.audience.sound import spoken
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.audience.view_model import AudienceViewModel
from venus3d.scene.web.theme import Theme, style_sheet

_SCREEN, _HALF = 16 / 9, 0.505
"""The screen's aspect, and the picture's share of its width."""


def glance_html(moment: AudienceViewModel, snapshot: Snapshot | None, *, dark: bool) -> str:
    """The text and drawings beside the picture at one moment."""
    theme = Theme(dark)
    if moment.kind == "good":
        colour, dial = theme.reached, tick_html()
    elif moment.step and moment.remaining is not None and moment.remaining.match is not None:
        colour = theme.steps[moment.step - 1]
        dial = dial_html(moment.remaining.match, moment.step)
    else:
        # Yellow is a warning and nothing else.
        colour = theme.quiet if moment.kind == "wait" else theme.info
        dial = f"<div class='v-sign'>{escape(moment.badge)}</div>"
    left = f"{moment.left:.2f}" if moment.kind == "step" else ""
    said = moment.sentence.replace(" mm", "\u00a0mm")  # no line break between number and unit
    aloud = escape(spoken(moment.sentence), quote=True)
    lost = escape(texts.LOST).format(since="<b></b>")
    longest = max(map(len, moment.title.split()), default=1)
    views = 0 if snapshot is None else snapshot.captured_count
    return (
        f"<div class='v-audience v-is-{moment.kind}' data-left='{left}' style='--step:{colour}'>"
        f"<div class='v-side'><div class='v-top' style='--longest:{longest}'>"
        f"<b>{escape(moment.badge)}</b>"
        f"<span>{escape(moment.title)}</span></div>"
        f"<div class='v-dial'>{dial}</div>{_chips(moment, theme)}"
        f"<div class='v-views'>{texts.VIEWS[min(views, 2)].format(count=views)}</div></div>"
        f"<div class='v-say' aria-live='polite' data-spoken='{aloud}'>{escape(said)}</div>"
        f"<div class='v-lost'><span>{lost}</span></div></div>"
    )


def picture_share(aspect: float) -> tuple[float, float]:
    """The shares of the screen's width and height taken by a picture of this aspect."""
    tall = float(np.sqrt(_HALF * _SCREEN / np.clip(aspect, 4 / 3, 2.0)))
    return _HALF / tall, tall


def sheet(look: AudienceState, aspect: float = _SCREEN) -> str:
    """The style sheet for these options and pictures of this aspect: colours, layout, mirroring."""
    wide, tall = picture_share(aspect)
    place = (
        f":root{{--aspect:{aspect:.6f};--wide-screen:{100 * wide:.2f}vw;"
        f"--tall-screen:{100 * tall:.2f}vh}}"
    )
    mirrored = "<div class='v-mirrored'></div>" if look.mirror else ""
    colours = Theme(dark=not look.light).variables
    return f"<style>{colours}{style_sheet('audience')}{place}</style>{mirrored}"


def _chips(moment: AudienceViewModel, theme: Theme) -> str:
    # No steps, where there is nothing to do; their place stays free.
    all_done = () if moment.remaining is None else moment.remaining.done
    cells = "".join(
        f"<i class='v-chip{' v-on' * (number == moment.step)}{' v-done' * done}' "
        f"style='--step:{colour}'>{'✓' if done else number}</i>"
        for number, (done, colour) in enumerate(zip(all_done, theme.steps, strict=False), 1)
    )
    return f"<div class='v-chips'>{cells}</div>"
