"""Two short tones as HTML: a browser plays them when they come, if somebody has clicked before.

A page of viser's has no sound of its own; an `<audio autoplay>` that is put into the page plays.
Browsers keep silent until the page was clicked once, so the page asks for it while sounds are on.
"""

from __future__ import annotations

import base64
import io
import wave
from functools import lru_cache
from html import escape

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.view_model import Cue

_RATE = 16000
_NOTES: dict[Cue, tuple[tuple[float, float], ...]] = {
    "reached": ((784.0, 0.16),),
    "captured": ((784.0, 0.13), (1175.0, 0.30)),
}
"""Hertz and seconds, one after the other."""


@lru_cache(maxsize=2)
def tone_wav(cue: Cue) -> bytes:
    """A WAV file, mono, 16 bit."""
    waves: list[Array] = []
    for hertz, seconds in _NOTES[cue]:
        t = np.arange(round(_RATE * seconds)) / _RATE
        # Swells and fades within hundredths of a second: a hard edge would crack.
        envelope = np.minimum(1, t / 0.01) * np.minimum(1, (seconds - t) / 0.05)
        waves.append(0.4 * envelope * np.sin(2 * np.pi * hertz * t))
    samples = np.round(np.concatenate(waves) * 32767).astype("<i2")
    file = io.BytesIO()
    with wave.open(file, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(_RATE)
        out.writeframes(samples.tobytes())
    return file.getvalue()


def tone_html(cue: Cue, number: int) -> str:
    """Plays once, when a page takes it in; `number` makes one unlike the last."""
    sound = base64.b64encode(tone_wav(cue)).decode("ascii")
    return f"<audio autoplay data-number='{number}' src='data:audio/wav;base64,{sound}'></audio>"


def hint_html() -> str:
    """Asks for the click; gone once it was made. It reaches nobody but the browser itself."""
    return (
        "<label class='v-hint'><input type='checkbox'>"
        f"<span>♪ {escape(texts.SOUND_HINT)}</span></label>"
    )
