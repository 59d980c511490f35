"""Display options of the second monitor, which only the operator can change."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class AudienceState:
    """How the second monitor shows things. Frozen, so that threads may share it."""

    mirror: bool = False
    """Mirror the picture and its overlay; text stays readable."""
    lens: bool = False
    """Draw the 3D steps in the undistorted picture, instead of outlines on the original."""
    light: bool = False
    """Light colours, for a bright room."""
    sound: bool = False
    """Play a tone when a step is done, two when a view is captured."""
