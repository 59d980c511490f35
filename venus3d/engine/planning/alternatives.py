"""Poses nearly as good as the best one and clearly different from it.
One of them may be easier to hold."""

from __future__ import annotations

import numpy as np

from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.posterior import Posterior

AT_MOST = 3
"""Number of alternatives besides the best pose."""
DIFFERENT_DEG = 20.0
DIFFERENT_FRACTION = 0.2
NEARLY = 0.15
"""How much worse an alternative may be, as a share of the best pose's gain plus the uncertainty it
leaves; the latter for the first views, whose gains are large."""


def clearly_different(one: Pose, other: Pose) -> bool:
    """Whether two poses are obviously different to a person.
    By 20 degrees of turn, or by a fifth of the nearer one's distance in any direction."""
    nearer = min(float(np.linalg.norm(pose.t)) for pose in (one, other))
    apart = one.distance_to(other) >= DIFFERENT_FRACTION * nearer
    return apart or one.angle_to_deg(other) >= DIFFERENT_DEG


def nearly_equal(posterior: Posterior, best: Array, elites: Array) -> list[Array]:
    """The elites (K, 6) to offer besides the pose vector `best` (6,), best first (at most 3).

    Ranked by the projection uncertainty they leave, which is what the page shows, whatever the cost
    of the search. All are clearly different from `best` and from each other.
    """
    if not len(elites):
        return []
    uncertainties = np.array(
        [projection_uncertainty_px(posterior.camera, C) for C in posterior.after(elites)]
    )
    least = projection_uncertainty_px(posterior.camera, posterior.after(best)[0])
    allowed = least + NEARLY * min(max(posterior.uncertainty_px - least, 0.0), least)
    chosen, poses = list[Array](), [Pose.from_vector(best)]
    for i in np.argsort(uncertainties, kind="stable"):
        if uncertainties[i] > allowed or len(chosen) == AT_MOST:
            break
        pose = Pose.from_vector(elites[i])
        if all(clearly_different(pose, other) for other in poses):
            chosen.append(elites[i])
            poses.append(pose)
    return chosen
