"""Keeps what a scene shows in the frame: a view that stays while it is good.

    framing = SteadyFraming(rig)
    ... whenever the scene was drawn: framing.look(content_of(shapes), target)

It flies to another view when the subject changes (a new target), when something leaves a window,
when the active step's arrow has come to point along the line of sight, or when a board has been
seen edge-on or from behind for a while and can be seen better. The direction changes only where the
present one is no good.
"""

from __future__ import annotations

import time
from collections.abc import Hashable
from functools import partial

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.render.framing import (
    FLATTEST_ARROW_DEG,
    FLATTEST_DEG,
    Content,
    best_direction,
    sight_angles_deg,
)
from venus3d.render.viewpoints import FILLED_IN_GUIDE, SceneCamera, view_along
from venus3d.scene.web.camera_rig import CameraRig

_REST_S = 1.2
"""Shortest time between two flights without a new subject."""
_WORN_DEG, _WORN_BOARD_DEG = FLATTEST_ARROW_DEG - 2.0, FLATTEST_DEG - 5.0
_MOMENT_S = 1.0
"""How long a board may be seen badly: it may be on its way through."""


class SteadyFraming:
    """The view of one rig. Used by the thread that draws."""

    def __init__(self, rig: CameraRig) -> None:
        """No view before `look`."""
        self._rig = rig
        self.subject: Hashable = None
        """What is looked at."""
        self._forward: Array | None = None
        self._flown_at = -np.inf
        self._bad_since: float | None = None
        """Since when a board is seen edge-on or from behind."""

    def look(
        self,
        content: Content,
        subject: Hashable,
        *,
        forward: Array | None = None,
        still: bool = False,
        asked: bool = False,
    ) -> None:
        """Show this content.

        Args:
            subject: what is looked at; another one is framed anew.
            forward: (3,) the direction; by default the best one.
            still: whether nothing may move now, such as while the board is dragged.
            asked: whether the person asks for this view, even where they have turned it.
        """
        if len(content.points) == 0:
            return
        first = self._forward is None
        badly = not first and self._is_bad_for_long(content)
        due = self._is_due(content, subject)
        if not asked and (still or not (due or badly)):
            return
        if forward is None:
            forward = best_direction(content, self._rig.aspect, self._forward)
        if not asked and not due and forward is self._forward:
            self._bad_since = None  # it is no better from elsewhere
            return
        self._bad_since = None
        self.subject, self._forward, self._flown_at = subject, forward, time.monotonic()
        view = partial(_filling, forward, content.points)
        (self._rig.go if first or asked else self._rig.refit)(view, at_once=first)

    def _is_due(self, content: Content, subject: Hashable) -> bool:
        if self._forward is None or subject != self.subject:
            return True
        if time.monotonic() - self._flown_at < _REST_S:
            return False
        return self._rig.cuts_off(content.points) or self._hides_an_arrow(content)

    def _is_bad_for_long(self, content: Content) -> bool:
        eyes = self._rig.eyes
        if not len(eyes) or not (sight_angles_deg(content, eyes)[0] < _WORN_BOARD_DEG).any():
            self._bad_since = None
            return False
        now = time.monotonic()
        if self._bad_since is None:
            self._bad_since = now
        return now - self._bad_since > _MOMENT_S

    def _hides_an_arrow(self, content: Content) -> bool:
        eyes = self._rig.eyes
        return len(eyes) > 0 and bool((sight_angles_deg(content, eyes)[1] < _WORN_DEG).any())


def _filling(forward: Array, points: Array, aspect: float) -> SceneCamera:
    return view_along(forward, points, aspect, filled=FILLED_IN_GUIDE)
