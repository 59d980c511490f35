"""What may be chosen about the second monitor; the operator chooses, nobody at the monitor can."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class AudienceState:
    """How the second monitor shows what it shows. Frozen, so that threads may share it."""

    mirror: bool = False
    """The picture and what is drawn on it as in a mirror; letters stay as they are."""
    lens: bool = False
    """The 3D steps in the undistorted picture, instead of outlines on the picture as it comes."""
    light: bool = False
    """For a bright room."""
    sound: bool = False
    """A tone when a step is right, two when a view is captured."""
