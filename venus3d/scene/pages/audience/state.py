"""Display options of the second monitor, which only the operator can change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Sound = Literal["off", "tones", "voice", "both"]
"""tones: the nearer, the faster, and when a step is done or a view captured; voice: sentences."""


@dataclass(frozen=True)
class AudienceState:
    """How the second monitor shows things. Frozen, so that threads may share it."""

    mirror: bool = True
    """Mirror the picture and its overlay, as its holder faces the camera; text stays readable."""
    lens: bool = False
    """Draw the 3D steps in the undistorted picture, instead of outlines on the original."""
    light: bool = False
    """Light colours, for a bright room."""
    sound: Sound = "off"
    """What is switched on in every browser; each has switches of its own."""
