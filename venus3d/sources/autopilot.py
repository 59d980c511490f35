"""Simulates the motion of a person's hand to a target, one step at a time, as the page tells them.

Pure: poses and a time step in, a pose out. Moves the board as it is held to its place, then turns
it by what is left about X, Y and Z. Each motion has the bell-shaped speed of a human arm (minimum
jerk; Flash and Hogan 1985, "The coordination of arm movements"), overshoots a little and is
corrected; rests lie between. The hand trembles and places the board a little beside the target.
Given the board's pose as *estimated*, it corrects the rest on arrival, as a person watching the
screen does.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.decomposition import home_pose
from venus3d.engine.geometry.pose import Array, Pose, interpolate, turn
from venus3d.engine.planning.target import Target

TOP_SPEED = 0.25
"""Of the board's centre at speed 1, metres per second."""
TOP_TURN_DEG = 45.0
"""Of a turn at speed 1, degrees per second."""
_RETREAT_SHARE = 0.5  # of the top speed, without a target: the first images must be sharp
_MIN_JERK_PEAK = 1.875  # peak speed of a minimum-jerk motion over its mean speed
_PAUSE_S = 0.3
_LOOK_S = 0.8  # rest before looking at the screen, until old images have passed
_LOST_S = 5.0  # rest after which a mended board is taken to be out of sight
_OVERSHOOT = 0.05
_OVERSHOOT_MOST = (0.010, 3.0)  # metres, degrees
_PLACEMENT = (0.0012, 0.4)  # standard deviation per axis: metres, degrees
_TREMOR = (0.0003, 0.12)  # root mean square per axis: metres, degrees
_SAME_AIM_DEG = 5.0  # a target that shifted by less is the same one, re-estimated
_GOOD_ENOUGH = (0.004, 1.5)  # no correction if seen this near to the target


@dataclass(frozen=True, eq=False)
class _Leg:
    """One motion from rest to rest, or a rest."""

    step: int
    start: Pose
    end: Pose
    duration_s: float

    def at(self, time_s: float) -> Pose:
        u = min(1.0, time_s / self.duration_s)
        return interpolate(self.start, self.end, u**3 * (10 - 15 * u + 6 * u * u))


class Autopilot:
    """A simulated hand. Used by one thread; reproducible with a seeded `rng`."""

    def __init__(
        self,
        rng: np.random.Generator,
        speed: float = 1.0,
        tremor: float = 1.0,
        overshoot: float = 1.0,
        home: Pose | None = None,
    ) -> None:
        """A hand at rest, without a target.

        Args:
            rng: for tremor, overshoot and placement.
            speed: 1 is a calm person: at most 0.25 m/s and 45 degrees/s, and rests of 0.3 s.
            tremor: 1 is a slow tremor of about 0.5 mm and 0.2 degrees and a placement error of
                about 2 mm and 0.7 degrees; 0 is none.
            overshoot: 1 is about 5 % before each correction; 0 is none.
            home: where it brings a board without a target; None: 0.5 m on the axis.
        """
        self._home = home or home_pose()
        self._rng, self._speed = rng, max(speed, 1e-3)
        self._tremor, self._overshoot = tremor, overshoot
        # A sum of slow sines per degree of freedom: smooth, bounded, independent of the time step.
        self._frequency = rng.uniform(0.15, 0.7, (6, 3))
        self._phase = rng.uniform(0, 2 * np.pi, (6, 3))
        self._legs: deque[_Leg] = deque()
        self._leg_time_s = 0.0
        self._time_s = 0.0
        self._steady: Pose | None = None  # intended pose
        self._shown: Pose | None = None  # with tremor: the last returned
        self._target: Target | None = None
        self._aimed = False  # whether there was ever a target
        self._placement = np.zeros(6)
        self._step = 1
        self._rested_s = 0.0
        self._mended = False  # whether it stands where the screen told it to

    @property
    def step(self) -> int:
        """The current step, 1 ... 4; 4 also after arrival."""
        return self._step

    @property
    def arrived(self) -> bool:
        """Whether the hand has nothing left to do and holds still."""
        return self._target is not None and not self._legs

    def forget_target(self) -> None:
        """As before the first target: without one, bring the board back into view."""
        self._target, self._aimed = None, False

    def advance(
        self, pose: Pose, target: Target | None, dt_s: float, seen: Pose | None = None
    ) -> Pose:
        """The board's pose `dt_s` seconds later.

        Args:
            pose: `T_camera_board` now; if it is not the one returned last, somebody else moved the
                board, and the hand starts again from there.
            target: where to go; None holds still or, before the first target, moves the board
                slowly to its home.
            dt_s: time step, seconds.
            seen: the board's pose as estimated by the calibration.
        """
        grabbed = self._steady is None or pose is not self._shown
        if grabbed:
            self._steady = _offset(pose, -self._trembling())
        if target is None:
            self._without_target(grabbed)
        elif grabbed or self._target is None or not _same_pose(target, self._target):
            self._aim(target, grabbed)
        elif not self._legs and seen is not None and self._rested_s > _LOOK_S / self._speed:
            self._mend(target, seen)
        elif not self._legs and self._mended and self._rested_s > _LOST_S / self._speed:
            self._bring_back(target)
        self._move(dt_s)
        self._time_s += dt_s
        assert self._steady is not None
        self._shown = _offset(self._steady, self._trembling())
        return self._shown

    # -- planning --------------------------------------------------------------------------------

    def _without_target(self, grabbed: bool) -> None:
        if grabbed or self._target is not None:
            self._start_anew()
        self._aimed = self._aimed or self._target is not None
        self._target = None
        if not self._aimed and not self._legs:
            self._add(1, self._home, speed=_RETREAT_SHARE)

    def _aim(self, target: Target, grabbed: bool) -> None:
        """Plan the path to a new target, or the rest of it if it has only shifted."""
        before, self._target, self._mended = self._target, target, False
        same = (
            before is not None
            and not grabbed
            and before.pose.angle_to_deg(target.pose) < _SAME_AIM_DEG
        )
        if not same:
            self._step = 1
            metres, degrees = (self._tremor * s for s in _PLACEMENT)
            draw = np.clip(self._rng.standard_normal(6), -1.8, 1.8)
            self._placement = draw * np.repeat([degrees, metres], 3)
        self._start_anew()
        place = target.pose.t + self._placement[3:]
        here = self._end
        self._add(self._step, Pose(here.R, place))
        left = Pose(target.pose.R @ here.R.T, place).vector()[:3]
        for number in range(max(2, self._step), 5):
            # Each turn has its own small error, which stays during the next ones.
            so_far = np.arange(3) < number - 1
            off = np.where(so_far, self._placement[:3], 0.0)
            after = target.pose.R if number == 4 else _turns(np.where(so_far, left, 0.0)) @ here.R
            self._add(number, Pose(_turns(off) @ after, place))

    def _mend(self, target: Target, seen: Pose) -> None:
        """Correct the difference that the screen shows."""
        self._rested_s = 0.0
        metres, degrees = _GOOD_ENOUGH
        if seen.distance_to(target.pose) < metres and seen.angle_to_deg(target.pose) < degrees:
            return
        self._start_anew()
        here = self._end
        self._mended = True
        missing = target.pose.R @ seen.R.T
        self._add(4, Pose(missing @ here.R, here.t + target.pose.t - seen.t))

    def _bring_back(self, target: Target) -> None:
        """Move to the target itself. What an old picture showed to be missing, where few come, may
        have been mended twice; the board is then beyond what can be seen, and nothing mends that.
        """
        self._rested_s, self._mended = 0.0, False
        self._start_anew()
        self._add(4, target.pose)

    def _start_anew(self) -> None:
        self._legs.clear()
        self._leg_time_s = 0.0

    @property
    def _end(self) -> Pose:
        """The end of the planned path."""
        if self._legs:
            return self._legs[-1].end
        assert self._steady is not None
        return self._steady

    def _add(self, step: int, end: Pose, speed: float = 1.0) -> None:
        """Append a motion with overshoot, correction and rest; nothing if idle."""
        start = self._end
        metres, degrees = start.distance_to(end), start.angle_to_deg(end)
        if metres < 5e-4 and degrees < 0.5:
            return
        too_far = self._overshoot * _OVERSHOOT * abs(1 + 0.4 * self._rng.standard_normal())
        for most, amount in zip(_OVERSHOOT_MOST, (metres, degrees), strict=True):
            too_far = min(too_far, most / max(amount, 1e-9))
        passed = interpolate(start, end, 1 + too_far)
        self._append(step, start, passed, speed)
        self._append(step, passed, end, speed)
        self._legs.append(_Leg(step, end, end, _PAUSE_S / self._speed))

    def _append(self, step: int, start: Pose, end: Pose, speed: float) -> None:
        metres, degrees = start.distance_to(end), start.angle_to_deg(end)
        slowest = max(metres / TOP_SPEED, degrees / TOP_TURN_DEG)
        if slowest > 1e-6:
            # People take at least a quarter of a second to start and stop.
            duration = max(_MIN_JERK_PEAK * slowest / speed, 0.25)
            self._legs.append(_Leg(step, start, end, duration / self._speed))

    # -- moving ----------------------------------------------------------------------------------

    def _move(self, dt_s: float) -> None:
        left_s = dt_s
        while self._legs and left_s > 0:
            leg = self._legs[0]
            self._step = leg.step
            used = min(left_s, leg.duration_s - self._leg_time_s)
            self._leg_time_s += used
            left_s -= used
            self._steady = leg.at(self._leg_time_s)
            if self._leg_time_s >= leg.duration_s - 1e-9:
                self._steady = leg.end
                self._legs.popleft()
                self._leg_time_s = 0.0
        if self._legs:
            self._rested_s = 0.0
        else:
            self._rested_s += left_s
            if self._target is not None:
                self._step = 4

    def _trembling(self) -> Array:
        """(6,) the current tremor: turns in degrees, then metres."""
        angle = 2 * np.pi * self._frequency * self._time_s + self._phase
        metres, degrees = _TREMOR
        # Three unit sines have a root mean square of sqrt(1.5).
        wave = np.sin(angle).sum(axis=1) / np.sqrt(1.5)
        return self._tremor * wave * np.repeat([degrees, metres], 3)


def _turns(degrees: Array) -> Array:
    return turn("z", degrees[2]) @ turn("y", degrees[1]) @ turn("x", degrees[0])


def _offset(pose: Pose, amount: Array) -> Pose:
    """The pose, turned by amount[:3] degrees about the camera's axes and moved by amount[3:]."""
    turned = Pose.from_rvec_tvec(np.radians(amount[:3]), np.zeros(3)).R @ pose.R
    return Pose(turned, pose.t + amount[3:])


def _same_pose(a: Target, b: Target) -> bool:
    return a is b or (a.pose.distance_to(b.pose) < 1e-6 and a.pose.angle_to_deg(b.pose) < 1e-4)
