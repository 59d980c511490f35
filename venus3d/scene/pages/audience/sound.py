"""Two short tones as HTML, played by an `<audio autoplay>` that is put into the page. Browsers stay
silent until the page has been clicked once, so the page asks for a click while sounds are on."""

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
"""Hertz and seconds of each note."""


@lru_cache(maxsize=2)
def tone_wav(cue: Cue) -> bytes:
    """A WAV file, mono, 16 bit."""
    waves: list[Array] = []
    for hertz, seconds in _NOTES[cue]:
        t = np.arange(round(_RATE * seconds)) / _RATE
        # Fade in and out within hundredths of a second: a hard edge would click.
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
    """Plays once when added to a page; `number` makes it differ from the last."""
    sound = base64.b64encode(tone_wav(cue)).decode("ascii")
    return f"<audio autoplay data-number='{number}' src='data:audio/wav;base64,{sound}'></audio>"


def hint_html() -> str:
    """Asks for the click and vanishes after it; handled by the browser alone."""
    return (
        "<label class='v-hint'><input type='checkbox'>"
        f"<span>♪ {escape(texts.SOUND_HINT)}</span></label>"
    )
