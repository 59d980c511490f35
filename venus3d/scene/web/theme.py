"""The pages' look: colours for dark and light, sizes of letters and gaps, and the one style sheet.

There are four sizes for what is read at the desk (note, text, lead, figure), in pixels, and three
for what is read at two metres (say, head, amount). The latter follow the panel's width and the
window's height, so that the same page fits a projector and a small laptop. Everything that a page
adds takes its sizes, gaps and colours from these variables. Where panels stand is the pages' own.
"""

from __future__ import annotations

from dataclasses import dataclass

from venus3d.scene.render.palette import ground, hex_of, mixed, step_colour
from venus3d.scene.render.shapes import Colour


@dataclass(frozen=True)
class Theme:
    """Colours of the page, dark or light."""

    dark: bool

    @property
    def step_colours(self) -> tuple[Colour, Colour, Colour, Colour]:
        """One colour for each of the four steps."""
        one, two, three, four = (step_colour(n, dark=self.dark) for n in (1, 2, 3, 4))
        return (one, two, three, four)

    @property
    def steps(self) -> tuple[str, ...]:
        """The steps' colours in CSS."""
        return tuple(hex_of(colour) for colour in self.step_colours)

    @property
    def info(self) -> str:
        """Something is going on, or is needed."""
        return hex_of(ground(self.dark).warning)

    @property
    def reached(self) -> str:
        """Something is right; always with a tick and a word."""
        return hex_of(ground(self.dark).reached)

    @property
    def good(self) -> str:
        """Plain text."""
        return hex_of(ground(self.dark).text)

    @property
    def quiet(self) -> str:
        """Nothing is going on."""
        return hex_of(ground(self.dark).quiet_text)

    @property
    def brand(self) -> Colour:
        """Of viser's own buttons and marks. Neutral: the steps have the colours."""
        return (150, 163, 184) if self.dark else (70, 82, 102)

    @property
    def line(self) -> str:
        """Thin lines between things."""
        return hex_of(mixed(ground(self.dark).background, ground(self.dark).text, 0.17))

    @property
    def tile(self) -> str:
        """The ground of a tile that stands out a little from the panel."""
        if not self.dark:
            return "#ffffff"
        return hex_of(mixed(ground(True).background, ground(True).text, 0.05))

    @property
    def panel(self) -> str:
        """The ground of a panel, viser's own made to fit."""
        return hex_of(ground(self.dark).background)

    @property
    def sheet(self) -> str:
        """The style sheet, once for each panel."""
        root = (
            f"--text:{self.good};--soft:{self.quiet};--info:{self.info};--reached:{self.reached};"
            f"--line:{self.line};--tile:{self.tile};--ink:{self.panel};{SIZES}"
        )
        body = f"--mantine-color-body:{self.panel};--mantine-color-text:{self.good};"
        soft = f"--mantine-color-dimmed:{self.quiet};--mantine-color-placeholder:{self.quiet}"
        return f"<style>html:root:root:root{{{root};{body}{soft}}}{_SHEET}</style>"


SIZES = (
    "--size-note:13px;--size-text:15px;--size-lead:18px;--size-figure:26px;"
    "--u:min(1cqw,.57vh);"
    "--size-say:calc(6.2*var(--u));--size-head:calc(8.8*var(--u));--size-amount:calc(12*var(--u));"
    "--gap-s:4px;--gap-m:8px;--gap-l:14px;--round:7px"
)
"""Letters: note, text, lead, figure at the desk; say, head, amount at two metres. Gaps: s, m, l."""

_SHEET = """
.v-wide{container-type:inline-size}
.mantine-Notification-root .mantine-Notification-description{color:var(--text)}
.v-guide,.v-progress,.v-steps,.v-keys,.v-tour{color:var(--text);font-family:Inter,"Segoe UI",Roboto,
"Helvetica Neue",Arial,sans-serif;font-variant-numeric:tabular-nums;box-sizing:border-box}
.v-guide *,.v-progress *,.v-steps *,.v-keys *,.v-tour *{box-sizing:border-box}
.v-guide{padding:0 calc(3*var(--u)) calc(2*var(--u));display:flex;flex-direction:column;
gap:calc(1.7*var(--u))}
.v-head{display:flex;align-items:center;gap:calc(3*var(--u));line-height:1.05}
.v-badge{flex:none;width:calc(13*var(--u));height:calc(13*var(--u));border-radius:50%;
background:var(--step);color:var(--ink);font-size:var(--size-head);font-weight:800;display:grid;
place-items:center}
.v-title{font-size:var(--size-head);font-weight:750;flex:1;letter-spacing:-.01em}
.v-title small{display:block;font-size:max(var(--size-text),calc(4*var(--u)));font-weight:650;
color:var(--soft);letter-spacing:0}
.v-amount{color:var(--step);font-size:var(--size-amount);font-weight:800;white-space:nowrap;
line-height:1}
.v-amount small{font-size:max(var(--size-text),calc(4.4*var(--u)));font-weight:600;
color:var(--soft);margin-left:.4em}
.v-sentence{font-size:var(--size-say);text-wrap:pretty;line-height:1.17;font-weight:550}
.v-picture,.v-note,.v-second{font-size:max(var(--size-text),calc(3.6*var(--u)));line-height:1.25;
color:var(--soft)}
.v-note{color:var(--info);font-weight:650}
.v-chips{display:grid;grid-template-columns:repeat(4,1fr);gap:var(--gap-m)}
.v-chip{display:grid;grid-template-columns:auto 1fr;column-gap:var(--gap-s);align-items:center;
border:2px solid var(--line);border-radius:var(--round);padding:var(--gap-s) 6px;
font-size:max(var(--size-note),calc(3.5*var(--u)));line-height:1.2;background:var(--tile)}
.v-chip b{width:1.5em;height:1.5em;border-radius:50%;background:var(--step);color:var(--ink);
display:grid;place-items:center}
.v-chip span{font-weight:650}
.v-chip i{grid-column:1/3;font-style:normal;font-weight:700;white-space:nowrap}
.v-chip.v-done i{color:var(--reached)}
.v-chip.v-on{border-color:var(--step);box-shadow:inset 0 0 0 1px var(--step)}
.v-steps{padding:0 8px 6px}
.v-steps h3,.v-progress h3,.v-keys h3{margin:var(--gap-l) 0 6px;font-size:var(--size-note);
font-weight:700;letter-spacing:.01em;color:var(--soft)}
.v-grid{display:grid;grid-template-columns:1fr 1fr;gap:var(--gap-m)}
.v-tile{border:3px solid var(--line);border-radius:var(--round);overflow:hidden;
background:var(--tile);display:flex;flex-direction:column}
.v-tile img{width:100%;display:block;margin-top:auto}
.v-told{display:grid;grid-template-columns:auto 1fr;align-items:center}
.v-told b{background:var(--step);color:var(--ink);font-size:var(--size-lead);line-height:1;
padding:5px 9px;font-weight:800}
.v-told strong{color:var(--step);font-size:var(--size-text);padding-left:var(--gap-m)}
.v-told span{grid-column:1/3;font-size:var(--size-note);line-height:1.25;padding:3px 7px 4px;
min-height:calc(2.5em + 7px)}
.v-tile .v-wait{aspect-ratio:16/9;display:grid;place-items:center;color:var(--soft);
font-size:var(--size-note)}
.v-legend{font-size:var(--size-note);line-height:1.4;color:var(--soft);padding:2px 0 0}
.v-legend b{font-weight:700;color:var(--text)}
.v-progress{padding:0 12px var(--gap-m);font-size:var(--size-text);line-height:1.3}
.v-big{display:flex;gap:var(--gap-m)}
.v-big div{flex:1;background:var(--tile);border-radius:var(--round);padding:7px 9px}
.v-big b{display:block;font-size:var(--size-figure);line-height:1.1;font-weight:750}
.v-big span{font-size:var(--size-note);color:var(--soft);line-height:1.2;display:block;
margin-top:2px}
.v-reason{font-size:var(--size-text);line-height:1.35;border-left:4px solid var(--info);
padding:2px 0 2px 9px}
.v-reason small{display:block;font-size:var(--size-note);color:var(--soft);margin-top:3px}
.v-line{margin-top:6px;font-size:var(--size-text)}
.v-row{display:grid;grid-template-columns:2.1em 1fr auto;column-gap:var(--gap-m);
align-items:baseline;padding:3px 0;border-bottom:1px solid var(--line)}
.v-row b{font-weight:750}
.v-row .v-word{color:var(--soft);font-size:var(--size-note)}
.v-row .v-mark{font-size:var(--size-note);font-weight:650;white-space:nowrap;color:var(--soft)}
.v-row .v-mark.v-yes{color:var(--reached)}
.v-row .v-value{grid-column:2/4;font-size:var(--size-text)}
.v-row .v-value i{font-style:normal;color:var(--soft)}
.v-diagnosis{font-size:var(--size-note);line-height:1.32;border:1px solid var(--line);
border-left-width:4px;border-radius:var(--round);padding:6px var(--gap-m);margin-bottom:6px;
background:var(--tile)}
.v-diagnosis.v-is-weak{border-left-color:var(--info)}
.v-diagnosis.v-is-wrong{border:2px solid var(--info);border-left-width:7px}
.v-named{font-size:var(--size-text);font-weight:750;margin-bottom:2px}
.v-sign{display:inline-grid;place-items:center;width:1.5em;height:1.5em;margin-right:.5em;
font-size:var(--size-note);border:2px solid var(--soft);border-radius:50%;vertical-align:-.2em}
.v-is-weak .v-sign{border-color:var(--info);color:var(--info);border-radius:3px}
.v-is-wrong .v-sign{border-color:var(--info);background:var(--info);
color:var(--ink);border-radius:0}
.v-cure{font-weight:650;margin-top:3px}
.v-more{font-size:var(--size-note);color:var(--soft)}
.v-key{display:inline-block;border:1px solid var(--soft);border-radius:4px;padding:0 5px;
font-weight:700;background:var(--tile);color:var(--text);font-size:var(--size-note)}
.v-keys table{border-collapse:collapse;width:100%;font-size:var(--size-text);line-height:1.25}
.v-keys td{padding:3px 10px 3px 0;border-bottom:1px solid var(--line);vertical-align:baseline}
.v-keys td b{white-space:nowrap;font-weight:650}
.v-keys p,.v-tour p{margin:6px 0 10px;font-size:var(--size-text);line-height:1.4}
.v-keys kbd{font-family:inherit;min-width:2em;text-align:center}
.v-tour h2{margin:0;font-size:var(--size-figure);line-height:1.15;font-weight:750}
.v-tour p{font-size:var(--size-lead);margin-bottom:var(--gap-l)}
.v-tour small{font-size:var(--size-note);color:var(--soft)}
.mantine-Modal-content:has(.v-keys){flex:0 1 820px}
.mantine-Modal-content:has(.v-tour){flex:0 1 480px}
.mantine-Modal-root:has(.v-tour) .mantine-Modal-overlay{background:rgba(0,0,0,.35)!important}
.mantine-Modal-header:has(+ * .v-tour){display:none}
.mantine-Modal-body:has(.v-tour){padding-top:18px}
[data-dock-scroll]>div[style*="flex: 0.5 "]:has(.v-guide:not(.v-card)){
flex:0 0 max(330px,40vh)!important}
[data-dock-scroll]>div:has(.v-guide:not(.v-card))~div[style*="flex: 0.5 "]{flex:1 1 0!important}
.mantine-ScrollArea-root:has(.v-progress) .mantine-Button-root{height:auto!important;
min-height:30px;padding:4px 9px}
.mantine-ScrollArea-root:has(.v-progress) .mantine-Button-label{white-space:normal;line-height:1.25;
text-align:left}
.v-steps h3{margin-top:var(--gap-s)}
.mantine-Button-label{font-size:var(--size-note)}
.mantine-Button-root[data-variant=outline]{--button-color:var(--text)!important;
--button-bd:1px solid var(--soft)!important;padding-inline:4px}
.mantine-Button-root[style*="gray"]{--button-bg:var(--tile)!important;
--button-color:var(--text)!important;border:1px solid var(--soft)}
[data-dock-tab][aria-selected=true] *{color:var(--text)!important}
@media (max-height:850px){.v-picture,.v-told span{display:none}
.v-told b{font-size:var(--size-text);padding:3px 7px}.v-steps h3{margin:0 0 2px}.v-grid{gap:6px}}
@media (max-height:850px) and (min-width:36em){
.v-guide:has(.v-note) .v-amount{align-self:flex-end;margin-top:calc(-14.2*var(--u))}
.v-guide:has(.v-note) .v-amount small{display:none}}
@media (max-width:36em){
div:has(>div>.mantine-Tabs-root :is(.v-guide,.v-lesson)){display:flex;flex-direction:column}
div:has(>.mantine-Tabs-root :is(.v-guide,.v-lesson)){order:-1}
.v-told span,.v-picture{display:block}
.mantine-Paper-root:has([data-autosize]){width:100vw!important;min-width:100vw}
.mantine-ScrollArea-content>div[style*="20em"]{width:100%!important}
}
"""
