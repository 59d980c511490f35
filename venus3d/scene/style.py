"""The page's look: colours for dark and light, and the one style sheet of the panels' HTML.

Sizes inside a panel are in `cqw`, hundredths of the panel's width, so that the same page fits a
projector and a small laptop. Layout of the panels themselves is the viewer's.
"""

from __future__ import annotations

from dataclasses import dataclass

from venus3d.scene.palette import ground, hex_of, mixed, step_colour
from venus3d.scene.shapes import Colour


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
    def good(self) -> str:
        """Something is right; always with a tick and a word."""
        return hex_of(ground(self.dark).text)

    @property
    def quiet(self) -> str:
        """Nothing is going on."""
        return hex_of(ground(self.dark).quiet_text)

    @property
    def sheet(self) -> str:
        """The style sheet, once for each panel."""
        neutral = ground(self.dark)
        line = mixed(neutral.background, neutral.text, 0.17)
        tile = mixed(neutral.background, neutral.text, 0.05)
        root = (
            f"--text:{self.good};--soft:{self.quiet};--info:{self.info};--line:{hex_of(line)};"
            f"--tile:{hex_of(tile)};--ink:{hex_of(neutral.background)}"
        )
        return f"<style>.v-guide,.v-progress,.v-steps,.v-keys{{{root}}}{_SHEET}</style>"


_SHEET = """
.v-wide{container-type:inline-size}
.v-guide,.v-progress,.v-steps,.v-keys{color:var(--text);font-family:Inter,"Segoe UI",Roboto,
"Helvetica Neue",Arial,sans-serif;font-variant-numeric:tabular-nums;box-sizing:border-box}
.v-guide *,.v-progress *,.v-steps *{box-sizing:border-box}
.v-guide{padding:0 2cqw 1.6cqw;min-height:29.5cqw;display:flex;flex-direction:column;gap:1cqw}
.v-head{display:flex;align-items:center;gap:1.8cqw;line-height:1.05}
.v-badge{flex:none;width:7.4cqw;height:7.4cqw;border-radius:50%;background:var(--step);
color:var(--ink);font-size:4.9cqw;font-weight:800;display:grid;place-items:center}
.v-title{font-size:5.3cqw;font-weight:750;flex:1;letter-spacing:-.01em}
.v-amount{color:var(--step);font-size:6.6cqw;font-weight:800;text-align:right;white-space:nowrap}
.v-amount small{font-size:2cqw;font-weight:600;color:var(--soft);margin-left:.8cqw}
.v-sentence{font-size:3.45cqw;text-wrap:balance;line-height:1.18;font-weight:550;min-height:4.4cqw}
.v-picture,.v-note,.v-second{font-size:2cqw;line-height:1.25;color:var(--soft)}
.v-note{color:var(--info);font-weight:650}
.v-second{font-size:2.6cqw}
.v-chips{display:grid;grid-template-columns:repeat(4,1fr);gap:1cqw;margin-top:auto}
.v-chip{display:flex;align-items:center;gap:.9cqw;border:.2cqw solid var(--line);
border-radius:1cqw;padding:.7cqw .9cqw;font-size:2.1cqw;line-height:1.1;background:var(--tile)}
.v-chip b{flex:none;width:3.2cqw;height:3.2cqw;border-radius:50%;background:var(--step);
color:var(--ink);display:grid;place-items:center;font-size:2.1cqw}
.v-chip span{font-weight:650}
.v-chip i{font-style:normal;margin-left:auto;font-weight:700;white-space:nowrap}
.v-chip.v-done i{color:var(--soft);font-weight:550}
.v-chip.v-on{border-color:var(--step);box-shadow:inset 0 0 0 .15cqw var(--step)}
.v-steps{padding:0 .6em .5em}
.v-steps h3,.v-progress h3,.v-keys h3{margin:.9em 0 .45em;font-size:13px;font-weight:700;
letter-spacing:.01em;color:var(--soft)}
.v-grid{display:grid;grid-template-columns:1fr 1fr;gap:7px}
.v-tile{border:3px solid var(--line);border-radius:7px;overflow:hidden;background:var(--tile);
display:flex;flex-direction:column}
.v-tile img{width:100%;display:block}
.v-tile.v-on{border-color:var(--step);box-shadow:0 0 0 2px var(--step)}
.v-tile .v-wait{aspect-ratio:16/9;display:grid;place-items:center;color:var(--soft);
font-size:13px}
.v-legend{font-size:13px;line-height:1.4;color:var(--soft);padding:2px .2em 0}
.v-legend b{font-weight:700}
.v-progress{padding:0 12px 8px;font-size:14px;line-height:1.3}
.v-big{display:flex;gap:10px}
.v-big div{flex:1;background:var(--tile);border-radius:7px;padding:7px 9px}
.v-big b{display:block;font-size:24px;line-height:1.1;font-weight:750}
.v-big span{font-size:12px;color:var(--soft);line-height:1.2;display:block;margin-top:2px}
.v-reason{font-size:15px;line-height:1.35;border-left:4px solid var(--info);padding:2px 0 2px 9px}
.v-line{margin-top:6px;font-size:14px}
.mantine-ScrollArea-root:has(.v-progress) .mantine-Button-root{height:auto!important;
min-height:30px;padding:4px 9px}
.mantine-ScrollArea-root:has(.v-progress) .mantine-Button-label{white-space:normal;line-height:1.25;
text-align:left}
.v-reason small{display:block;font-size:12px;color:var(--soft);margin-top:3px}
@media (max-width:1500px){.mantine-Paper-root:has(.v-guide){width:calc(100vw - 742px)!important}}
.v-row{display:grid;grid-template-columns:2.1em 1fr auto;column-gap:7px;align-items:baseline;
padding:2px 0;border-bottom:1px solid var(--line)}
.v-row b{font-weight:750}
.v-row .v-word{color:var(--soft);font-size:13px}
.v-row .v-mark{font-size:13px;font-weight:650;white-space:nowrap;color:var(--soft)}
.v-row .v-mark.v-yes{color:var(--text)}
.v-row .v-value{grid-column:2/4;font-size:14.5px}
.v-row .v-value i{font-style:normal;color:var(--soft)}
.v-diagnosis{font-size:13px;line-height:1.32;border:1px solid var(--line);border-left-width:4px;
border-radius:6px;padding:6px 8px;margin-bottom:6px;background:var(--tile)}
.v-diagnosis.v-is-weak{border-left-color:var(--info)}
.v-diagnosis.v-is-wrong{border:2px solid var(--info);border-left-width:7px}
.v-named{font-size:14px;font-weight:750;margin-bottom:2px}
.v-sign{display:inline-grid;place-items:center;width:1.5em;height:1.5em;margin-right:.5em;
font-size:13px;border:2px solid var(--soft);border-radius:50%;vertical-align:-.2em}
.v-is-weak .v-sign{border-color:var(--info);color:var(--info);border-radius:3px}
.v-is-wrong .v-sign{border-color:var(--info);background:var(--info);
color:var(--ink);border-radius:0}
.v-cure{font-weight:650;margin-top:3px}
.v-more{font-size:13px;color:var(--soft)}
.v-key{display:inline-block;border:1px solid var(--line);border-radius:4px;padding:0 5px;
font-weight:700;background:var(--tile);color:var(--text);font-size:12px}
.v-keys table{border-collapse:collapse;width:100%;font-size:15px;line-height:1.3}
.v-keys td{padding:5px 10px 5px 0;border-bottom:1px solid var(--line);vertical-align:baseline}
.v-keys td b{white-space:nowrap;font-weight:650}
.v-keys p{margin:6px 0 10px;font-size:15px;line-height:1.4}
.v-keys kbd{font-family:inherit;min-width:2em;text-align:center;font-size:14px}
.mantine-Modal-content:has(.v-keys){flex:0 1 760px}
"""
