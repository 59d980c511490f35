"""The simulated people of Table 3: every number with its source."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from venus3d.engine.errors import VenusError


@dataclass(frozen=True)
class Assumptions:
    """Parameters of the simulated person. Times in seconds, errors as standard deviations."""

    reaction_s: float = 0.25
    """From seeing to starting to move: simple visual reaction time."""
    reading_s: float = 1.0
    """First reading of a step's arrow and figure: four fixations. The whole sentence of eight words
    takes 2 s (240 words a minute; Brysbaert 2019)."""
    glance_s: float = 0.5
    """A second look at something known: two fixations of a quarter of a second."""
    rotation_deg_per_s: float = 60.0
    """Mental rotation from one image to another (Shepard and Metzler 1971); needed for axes and
    outline, while a step names the turn."""
    fitts_a_s: float = 0.2
    """Fitts's law (1954), T = a + b log2(2 A / W): starting and stopping."""
    fitts_b_s: float = 0.2
    """Seconds per bit. A pointing hand needs about 0.1; a board in two hands is slower."""
    motor_share: float = 0.05
    """Scatter of a motion's end as a share of its length (Harris and Wolpert 1998)."""
    pivot_mm_per_deg: float = 0.3
    """A turn also shifts the centre of a board that is held by its edges."""
    rest_mm: float = 1.2
    """Lower bound of that scatter for a shift; as for the simulated source's hand."""
    rest_deg: float = 0.4
    """Lower bound for a turn."""
    told_share: float = 0.10
    """Error in executing an amount given in figures: "turn by 13 degrees"."""
    place_share: float = 0.05
    """Error of a shift across the image, which is seen directly, and of a turn in its plane."""
    depth_share: float = 0.15
    """Error of a distance judged by size."""
    axes_tilt_share: float = 0.25
    """Relative error of a tilt judged from the axes' foreshortening."""
    axes_tilt_deg: float = 3.0
    """Lower bound of that error."""
    axes_flip: float = 0.10
    """Probability of reading a tilt from the axes with the wrong sign: drawn lines show near and
    far only to someone who knows which axis is which."""
    outline_tilt_share: float = 0.35
    """Relative error of a tilt judged from a silhouette, which changes with the cosine only."""
    outline_tilt_deg: float = 5.0
    """Lower bound of that error."""
    outline_flip: float = 0.5
    """The same from an outline, which hardly shows the sign: the first guess is random."""

    def check(self) -> None:
        """Raises `VenusError` for an impossible value."""
        for name in (f.name for f in fields(self)):
            value = getattr(self, name)
            most = 1.0 if name.endswith("_flip") else np.inf
            least = 1.0 if name == "rotation_deg_per_s" else 0.0
            if not least <= value <= most:
                allowed = f"from 0 to {most:g}" if most == 1 else f"at least {least:g}"
                raise VenusError(f"--assume.{name.replace('_', '-')} must be {allowed}.")

    def person(self, spread: float, rng: np.random.Generator) -> Assumptions:
        """A random person: all times and all errors scaled by two individual factors.
        Both are lognormal around 1 with this `spread`."""
        slow, clumsy = np.exp(spread * rng.standard_normal(2))
        changed = {
            name: getattr(self, name) * (slow if name.endswith("_s") else clumsy)
            for name in (f.name for f in fields(self))
            if name != "rotation_deg_per_s" and not name.endswith("_flip")
        }
        changed["rotation_deg_per_s"] = self.rotation_deg_per_s / slow
        return replace(self, **changed)
