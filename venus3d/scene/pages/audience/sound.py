"""What the second monitor says aloud, and when; audience.js plays it.

A sentence is due when what is to be done changes, and again while somebody hesitates; never more
often than every `GAP_S` seconds, since nobody can follow that.
"""

from __future__ import annotations

import math
from html import escape

from venus3d.languages import current_language
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.state import Sound
from venus3d.scene.pages.audience.view_model import AudienceViewModel, Cue

GAP_S = 4.1
"""Shortest time between two sentences."""
HESITATION_S = 7.0
"""Seconds without progress after which the sentence is repeated."""
_PROGRESS = 0.04
"""Fall of the remaining distance (0 ... 1, as on the dial) that is progress."""


ALARM_S = 30.0
"""Seconds without pictures until tones tell of it, and between two such alarms."""


class Alarm:
    """When tones tell that no pictures come. Used by one thread."""

    def __init__(self) -> None:
        self._due_s = math.inf

    def due(self, silent: bool, now_s: float) -> bool:
        """Whether to sound it now, `now_s` on a monotonic clock; `silent`: no pictures come."""
        if not silent:
            self._due_s = math.inf
            return False
        if now_s < self._due_s < math.inf:
            return False
        sounds = self._due_s < math.inf
        self._due_s = now_s + ALARM_S
        return sounds


class Speaker:
    """Chooses the sentences to be spoken. Used by one thread."""

    def __init__(self) -> None:
        self._about: tuple[str, str, int] | None = None
        self._spoken_s = self._progress_s = -math.inf
        self._nearest = 1.0

    def due(self, moment: AudienceViewModel, now_s: float) -> str:
        """The sentence to speak at this moment, `now_s` on a monotonic clock; empty for none."""
        if moment.kind == "good" and moment.step:
            return ""  # a tone says that a step is done; the next sentence is more useful
        about = (moment.kind, moment.title, moment.step)
        if about != self._about or moment.left < self._nearest - _PROGRESS:
            self._nearest, self._progress_s = moment.left, now_s
        since = now_s - self._spoken_s
        hesitates = (
            moment.kind in ("step", "unseen")
            and min(since, now_s - self._progress_s) >= HESITATION_S
        )
        if since < GAP_S or (about == self._about and not hesitates):
            return ""
        self._about, self._spoken_s = about, now_s
        return spoken(moment.sentence)


def spoken(sentence: str) -> str:
    """A sentence with its units as words."""
    for unit, word in texts.SPOKEN_UNITS:
        sentence = sentence.replace(unit, word)
    return sentence


def speech_html(sentence: str, number: int) -> str:
    """The newest sentence to be spoken, and how many there were."""
    tag = f"<div class='v-speech' lang='{current_language()}' data-number='{number}'>"
    return f"{tag}{escape(sentence)}</div>"


def cue_html(cue: Cue | None, number: int) -> str:
    """The newest achievement or alarm, and how many there were."""
    return f"<div class='v-cue' data-cue='{cue or ''}' data-number='{number}'></div>"


def switches_html(sound: Sound) -> str:
    """The browser's own switches, and what the operator has switched on."""
    buttons = "".join(
        f"<button data-sound='{kind}' title='{escape(hint)}'>{escape(label)}</button>"
        for kind, (label, hint) in texts.SOUNDS.items()
    )
    on = " ".join(kind for kind in texts.SOUNDS if sound in (kind, "both"))
    return (
        f"<div class='v-sound' data-on='{on}'>{buttons}"
        f"<span class='v-ask'>{escape(texts.SOUND_HINT)}</span></div>"
    )
