"""What the simulated people of Table 3 are made of: every number with the reason for it.

What they do with it is in `hand`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from venus3d.engine.errors import VenusError


@dataclass(frozen=True)
class Assumptions:
    """What the simulated person is made of. Times in seconds, errors as standard deviations."""

    reaction_s: float = 0.25
    """From seeing to beginning to move: simple visual reaction."""
    reading_s: float = 1.0
    """To take in a step's arrow and figure for the first time: four fixations. Whoever reads the
    whole sentence of eight words needs 2 s (240 words a minute; Brysbaert 2019)."""
    glance_s: float = 0.5
    """To look again at something known: two fixations of a quarter of a second."""
    rotation_deg_per_s: float = 60.0
    """Imagined turns from one picture to another (Shepard and Metzler 1971); with a picture of axes
    or an outline the turn has to be found in the mind first, a step names it."""
    fitts_a_s: float = 0.2
    """Fitts's law (1954), T = a + b log2(2 A / W): starting and stopping."""
    fitts_b_s: float = 0.2
    """Seconds a bit. A pointing hand needs about 0.1; a board in two hands is slower."""
    motor_share: float = 0.05
    """A motion's end scatters by this share of its length (Harris and Wolpert 1998)."""
    pivot_mm_per_deg: float = 0.3
    """A turn also shifts the centre of a board that is held by its edges."""
    rest_mm: float = 1.2
    """However short the motion; as for the simulated source's hand."""
    rest_deg: float = 0.4
    """The same of a turn."""
    told_share: float = 0.10
    """Error of an amount that is told in figures and has to be felt: "turn by 13 degrees"."""
    place_share: float = 0.05
    """Error of a shift across the picture, which is seen directly, and of a turn in its plane."""
    depth_share: float = 0.15
    """Error of a distance judged by size."""
    axes_tilt_share: float = 0.25
    """Error of a tilt judged from the axes' foreshortening, as a share of it ..."""
    axes_tilt_deg: float = 3.0
    """... and however small it is."""
    axes_flip: float = 0.10
    """How often a tilt is read in the wrong sense from the axes: drawn lines tell near from far
    only by the knowledge which axis is which."""
    outline_tilt_share: float = 0.35
    """Error of a tilt judged from a silhouette, which changes with the cosine only."""
    outline_tilt_deg: float = 5.0
    """However small it is."""
    outline_flip: float = 0.5
    """A silhouette hardly tells forwards from backwards: the first guess is a coin's."""

    def check(self) -> None:
        """Raises `VenusError` for a value that nobody can have."""
        for name in (f.name for f in fields(self)):
            value = getattr(self, name)
            most = 1.0 if name.endswith("_flip") else np.inf
            least = 1.0 if name == "rotation_deg_per_s" else 0.0
            if not least <= value <= most:
                allowed = f"from 0 to {most:g}" if most == 1 else f"at least {least:g}"
                raise VenusError(f"--assume.{name.replace('_', '-')} must be {allowed}.")

    def person(self, spread: float, rng: np.random.Generator) -> Assumptions:
        """Somebody: all times longer and all errors larger by two factors of their own.

        Both are drawn from a lognormal distribution around 1 with this `spread`.
        """
        slow, clumsy = np.exp(spread * rng.standard_normal(2))
        changed = {
            name: getattr(self, name) * (slow if name.endswith("_s") else clumsy)
            for name in (f.name for f in fields(self))
            if name != "rotation_deg_per_s" and not name.endswith("_flip")
        }
        changed["rotation_deg_per_s"] = self.rotation_deg_per_s / slow
        return replace(self, **changed)
