"""Why a view at its target is not captured by itself: its light, its sharpness, its motion.

The limits are where the error of the corners about doubles in simulated pictures; that of motion is
what a hand can hold (`scripts/capture_limits.py`, figures in docs/operations.md). The detection
loses corners not much later.
"""

from __future__ import annotations

import math

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.picture_quality import least_sharpness, picture_quality
from venus3d.engine.geometry.board import Board
from venus3d.engine.sentences import Sentence

LEAST_CONTRAST = 60.0
"""White minus black of the board, grey values."""
MOST_WHITE = 254.0
"""Grey value from which white is burnt out."""
MOST_WASHED_OUT = 0.08
"""Share of the corners whose black is washed out."""
LEAST_OF_USUAL = 0.6
"""Share of the usual sharpness of this session's views."""
MOST_MOTION_PX = 1.0
"""Motion within a frame's time, for which a rolling shutter shears the board."""
_FRAME_S = 1 / 30
"""The longest time that a rolling shutter usually takes."""

_TOO_DARK = Sentence(
    "Too dark: the board's white is only {contrast:.0f} grey values above its black, not "
    "{least:.0f}. Give more light or a longer exposure."
)
_TOO_BRIGHT = Sentence(
    "Too bright: the board's white is burnt out. Give less light or a shorter exposure."
)
_GLARE = Sentence(
    "Glare or a hand on {share:.0%} of the corners, more than {most:.0%}. Tilt the board a little "
    "or move the lamp."
)
_MOVING = Sentence(
    "The board moves by {motion:.1f} px in a frame's time, more than {most:.1f}. Hold it still."
)
_BLURRED = Sentence(
    "Out of focus: edges are {width:.1f} px wide, more than {most:.1f}. Focus the lens and lock it."
)


def refusal(
    seen: Observation,
    board: Board,
    *,
    motion_px: float = 0.0,
    since_s: float = 0.0,
    usual_sharpness: float = math.nan,
) -> Sentence | None:
    """Why this observation shall not become a view; None if it may.

    Args:
        motion_px: of the corners since the observation before it, `since_s` seconds ago.
        usual_sharpness: median of this session's views; NaN without any.
    """
    quality = None if seen.image is None else picture_quality(seen.image, board, seen)
    if quality is not None:
        if quality.white >= MOST_WHITE:
            return _TOO_BRIGHT
        if quality.contrast < LEAST_CONTRAST:
            return _TOO_DARK.format(contrast=quality.contrast, least=LEAST_CONTRAST)
        if quality.washed_out > MOST_WASHED_OUT:
            return _GLARE.format(share=quality.washed_out, most=MOST_WASHED_OUT)
    motion_px *= min(1.0, _FRAME_S / since_s) if since_s > 0 else 1.0
    if motion_px > MOST_MOTION_PX:
        return _MOVING.format(motion=motion_px, most=MOST_MOTION_PX)
    least = least_sharpness(seen.image_size[0])
    if not math.isnan(usual_sharpness):
        least = max(least, LEAST_OF_USUAL * usual_sharpness)
    if 0 < seen.sharpness < least:  # 0: not measured
        return _BLURRED.format(width=1 / seen.sharpness, most=1 / least)
    return None
