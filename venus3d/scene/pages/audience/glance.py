"""The second monitor's HTML: one sentence, the dial and the four steps around the picture.

The layout is CSS's alone: the picture keeps the upper left corner (viser's canvas is put there),
more than half of a wide screen; the dial stands to its right, the sentence below it. On a tall
screen, a phone's, the picture has the whole width and the rest stands below it. All letters are
sized by the screen's height.
"""

from __future__ import annotations

from html import escape

import numpy as np

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.choices import AudienceChoices
from venus3d.scene.pages.audience.dial import dial_html, right_colour, tick_html
from venus3d.scene.pages.audience.view_model import AudienceViewModel
from venus3d.scene.render.palette import ground, hex_of, mixed, step_colour

_SCREEN, _HALF = 16 / 9, 0.505
"""The picture has a little more than half of a screen of this shape."""


def glance_html(moment: AudienceViewModel, snapshot: Snapshot | None, *, dark: bool) -> str:
    """What is read and seen beside the picture at one moment."""
    good = moment.kind == "good"
    if good:
        colour = right_colour(dark=dark)
    elif moment.step:
        colour = hex_of(step_colour(moment.step, dark))
    else:
        colour = hex_of(ground(dark).warning)
    if good:
        dial = tick_html()
    elif moment.step and moment.match is not None:
        dial = dial_html(moment.match, moment.step)
    else:
        dial = f"<div class='v-sign'>{escape(moment.badge)}</div>"
    said = moment.sentence.replace(" mm", "\u00a0mm")  # a number keeps its unit
    views = 0 if snapshot is None else len(snapshot.views)
    views += moment.fresh and snapshot is not None and snapshot.phase == "captured"
    return (
        f"<div class='v-audience v-is-{moment.kind}' style='--step:{colour}'>"
        f"<div class='v-side'><div class='v-top'><b>{escape(moment.badge)}</b>"
        f"<span>{escape(moment.title)}</span></div>"
        f"<div class='v-dial'>{dial}</div>{_chips(moment, dark)}"
        f"<div class='v-views'>{_views(views)}</div></div>"
        f"<div class='v-say' aria-live='polite'>{escape(said)}</div>"
        f"<div class='v-lost'>{escape(texts.LOST)}</div></div>"
    )


def picture_share(aspect: float) -> tuple[float, float]:
    """The part of the screen's width and height that a picture of this width / height has."""
    tall = float(np.sqrt(_HALF * _SCREEN / np.clip(aspect, 4 / 3, 2.0)))
    return _HALF / tall, tall


def sheet(look: AudienceChoices, aspect: float = _SCREEN) -> str:
    """The style sheet for this choice and pictures of this width / height: colours, layout,
    mirror."""
    dark = not look.light
    neutral = ground(dark)
    line = mixed(neutral.background, neutral.text, 0.22)
    root = (
        f"--text:{hex_of(neutral.text)};--soft:{hex_of(neutral.quiet_text)};--line:{hex_of(line)};"
        f"--ink:{hex_of(neutral.background)};--right:{right_colour(dark=dark)}"
    )
    wide, tall = picture_share(aspect)
    share = (
        f":root{{--wide:{100 * wide:.2f}vw;--tall:{100 * tall:.2f}vh}}@media (orientation:portrait)"
        f"{{:root{{--wide:100vw;--tall:min(50vh,{100 / aspect:.2f}vw)}}}}"
    )
    mirror = "canvas{transform:scaleX(-1)}" if look.mirror else ""
    return f"<style>{share}.v-audience,.v-hint{{{root}}}{_SHEET}{mirror}</style>"


def _views(count: int) -> str:
    return texts.VIEWS[min(count, 2)].format(count=count)


def _chips(moment: AudienceViewModel, dark: bool) -> str:
    cells: list[str] = []
    for number in (1, 2, 3, 4):
        done = moment.match is not None and moment.match.within[number - 1]
        state = " v-on" if number == moment.step else ""
        state += " v-done" if done else ""
        colour = hex_of(step_colour(number, dark))
        mark = "✓" if done else str(number)
        cells.append(f"<i class='v-chip{state}' style='--step:{colour}'>{mark}</i>")
    return f"<div class='v-chips'>{''.join(cells)}</div>"


_SHEET = """
body{overflow:hidden}
.mantine-Notifications-root{display:none}
.mantine-Paper-root:has(.v-audience){visibility:hidden;box-shadow:none}
div:has(>div>div>canvas):not(:has(.v-audience)){position:fixed!important;left:0;top:0;
pointer-events:none!important;width:var(--wide)!important;height:var(--tall)!important}
.v-audience{visibility:visible;position:fixed;inset:0;pointer-events:none;color:var(--text);
font-family:Inter,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif;
font-variant-numeric:tabular-nums;--letter:max(5vh,min(7.6vh,4.3vw,(100vh - var(--tall))/2.7))}
.v-audience *{box-sizing:border-box}
.v-side{position:absolute;left:var(--wide);right:0;top:0;height:var(--tall);
padding:2vh 1.4vw 0;display:flex;flex-direction:column;align-items:center;gap:1.6vh}
.v-top{display:flex;align-items:center;gap:1.2vw;font-size:max(5vh,min(7vh,3.6vw));
font-weight:800;line-height:1;align-self:stretch}
.v-top b{flex:none;width:1.5em;height:1.5em;border-radius:50%;background:var(--step);
color:var(--ink);display:grid;place-items:center}
.v-dial{flex:1;min-height:0;width:100%;display:grid;place-items:center}
.v-dial svg{width:100%;height:100%;min-height:0}
.v-dial text{text-anchor:middle;fill:var(--text);font-family:inherit}
.v-dial .v-figure{font-size:92px;font-weight:800;fill:var(--step)}
.v-dial .v-unit{font-size:34px;fill:var(--soft);font-weight:600}
.v-dial .v-part{font-size:38px;font-weight:800}
.v-dial .v-end{font-size:25px;font-weight:600;fill:var(--soft)}
.v-dial .v-way{font-size:31px;font-weight:800;fill:var(--step)}
.v-dial .v-end[text-anchor=start]{text-anchor:start}
.v-dial .v-end[text-anchor=end]{text-anchor:end}
.v-sign{font-size:min(30vh,16vw);font-weight:800;line-height:1;color:var(--step)}
.v-chips{display:flex;gap:1vw}
.v-chip{font-style:normal;font-weight:800;font-size:3.2vh;width:1.9em;height:1.9em;
border-radius:50%;border:.12em solid var(--step);color:var(--step);display:grid;
place-items:center}
.v-chip.v-done{border-color:var(--right);color:var(--right)}
.v-chip.v-on{background:var(--step);color:var(--ink)}
.v-views{font-size:3.4vh;font-weight:600;color:var(--soft)}
.v-say{position:absolute;left:0;right:0;top:var(--tall);bottom:0;padding:0 2vw;display:flex;
align-items:center;font-size:var(--letter);font-weight:700;line-height:1.16;letter-spacing:-.01em;
text-wrap:balance;border-left:1.2vw solid var(--step)}
.v-is-good .v-say{color:var(--right)}
.v-lost{display:none;position:absolute;left:0;top:0;padding:1.5vh 2vw;font-size:5vh;font-weight:750;
background:var(--text);color:var(--ink)}
.mantine-Paper-root:has(.mantine-Loader-root) .v-lost{display:block}
.v-hint{visibility:visible;position:fixed;left:1vw;top:1vh;font:600 2.4vh Inter,"Segoe UI",Roboto,
Arial,sans-serif;padding:1vh 1vw;border-radius:1vh;background:var(--ink);color:var(--text);
cursor:pointer}
.v-hint input{position:absolute;opacity:0}
.v-hint:has(:checked){display:none}
@media (orientation:portrait){
.v-audience{--letter:5vh;--beside:calc(.56*(100vh - var(--tall)))}
.v-side{left:0;top:var(--tall);height:var(--beside);padding:1.4vh 4vw 0;gap:1vh}
.v-say{top:calc(var(--tall) + var(--beside) + 1vh);padding:0 4vw;align-items:flex-start;
border-left:0;border-top:1vh solid var(--step);padding-top:1vh}
.v-top{font-size:5vh}.v-chip{font-size:2.4vh}.v-views{font-size:2.4vh}.v-chips{gap:3vw}}
"""
