"""A simulated person who brings the board to a pose with one of three helps; not a measurement.

It looks at the help, estimates what remains to be done, moves, and looks again, until the program's
own `matching` says that the pose is reached. Its errors and times are `Assumptions`; `venus3d
trial` tests real people. Only a motion's duration is simulated, as no pose counts as reached on the
way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.matching import Match, Tolerance, match
from venus3d.sources.autopilot import TOP_SPEED, TOP_TURN_DEG
from venus3d.study.assumptions import Assumptions

Help = Literal["steps", "axes", "outline", "perfect"]
HELPS: tuple[Help, ...] = ("steps", "axes", "outline", "perfect")
"""steps: the four steps of eq. (15), one at a time, with the remaining amount (this program).
axes: the board's axes and the target's in the image (Rojtberg 2018). outline: the target's filled
silhouette (AprilCal). perfect: knows the target without looking; a lower bound."""

_MIN_JERK_PEAK = 1.875  # peak over mean speed of a bell-shaped motion (Flash and Hogan 1985)
_MOST_LOOKS = 200
_ALIGNED_DEG = 10.0  # within this of the intended pose, the person thinks it is reached


@dataclass(frozen=True, eq=False)
class ReachResult:
    """How a pose was reached."""

    seconds: float
    looks: int
    reached: bool
    end: Pose
    """Final pose of the board."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A shift and a turn that a person believes to remain."""

    shift: Array
    """(3,) metres, camera frame."""
    turn_deg: Array
    """(3,) rotation vector about the camera's axes, degrees."""


Reader = Callable[[Match, Pose, Pose], tuple[float, list[Motion]]]
"""A person's reading of a help, from the match now, the board's pose and the target: its time, and
the intended motions in order."""


def reach(
    start: Pose,
    target: Pose,
    help_: Help,
    person: Assumptions,
    camera: Camera,
    board: Board,
    rng: np.random.Generator,
) -> ReachResult:
    """Bring the board from `start` to `target` until `matching` accepts it."""
    reader, pose, seconds, looks = READERS[help_](person, board, rng), start, 0.0, 0
    now = _match(camera, board, pose, target)
    while not now.reached and looks < _MOST_LOOKS:
        looks += 1
        took, motions = reader(now, pose, target)
        seconds += took
        for motion in motions:
            seconds += motion_s(person, board, motion)
            pose = _moved(pose, motion, person, rng)
            now = _match(camera, board, pose, target)
            if now.reached:
                break
    return ReachResult(seconds, looks, now.reached, pose)


def motion_s(person: Assumptions, board: Board, motion: Motion) -> float:
    """Duration of a motion: the shift and the turn one after the other.

    People switch between placing and turning rather than doing both (Masliah and Milgram 2000).
    Each takes the time of Fitts's law, with a step's tolerance as the width, and is never faster
    than a bell-shaped motion with the top speed of the simulated source's hand.
    """
    tolerance = Tolerance()
    width = 2 * tolerance.centre_mm(board) / 1000
    shift = _single_s(person, float(np.linalg.norm(motion.shift)), width, TOP_SPEED)
    turn = float(np.linalg.norm(motion.turn_deg))
    return shift + _single_s(person, turn, 2 * tolerance.deg, TOP_TURN_DEG)


def _single_s(person: Assumptions, amount: float, width: float, top_speed: float) -> float:
    if amount <= 1e-9:
        return 0.0
    bits = max(0.0, float(np.log2(2 * amount / width)))
    fitts_s = person.fitts_a_s + person.fitts_b_s * bits
    return max(fitts_s, _MIN_JERK_PEAK * amount / top_speed)


def _moved(pose: Pose, motion: Motion, person: Assumptions, rng: np.random.Generator) -> Pose:
    """The board's actual pose after an intended motion, with the hand's errors."""
    turn = float(np.linalg.norm(motion.turn_deg))
    shift = float(np.linalg.norm(motion.shift))
    scatter_deg = np.hypot(person.rest_deg, person.motor_share * turn)
    scatter_mm = np.hypot(person.rest_mm, 1000 * person.motor_share * shift)
    scatter_mm = np.hypot(scatter_mm, person.pivot_mm_per_deg * turn)
    turned = motion.turn_deg + scatter_deg * rng.standard_normal(3)
    moved = motion.shift + scatter_mm / 1000 * rng.standard_normal(3)
    return Pose(_rotation(turned) @ pose.R, pose.t + moved)


def _rotation(rotvec_deg: Array) -> Array:
    return Pose.from_rvec_tvec(np.radians(rotvec_deg), np.zeros(3)).R


def _match(camera: Camera, board: Board, pose: Pose, target: Pose) -> Match:
    """The program's match for a board at rest: the same corners twice."""
    corners = camera.without_distortion().project(pose.apply(board.corners))
    still = Observation(np.arange(board.corner_count), corners, camera.image_size)
    return match(camera, board, pose, target, observation=still, before=still)


# -- reading the helps ---------------------------------------------------------------------------


def _steps_reader(person: Assumptions, board: Board, rng: np.random.Generator) -> Reader:
    """One degree of freedom at a time, given in words and figures.
    First the four steps in order, without idle ones; then whatever is off most."""
    ahead = [1, 2, 3, 4]
    tolerance = Tolerance()

    def look(now: Match, pose: Pose, target: Pose) -> tuple[float, list[Motion]]:
        rest = [float(np.linalg.norm(now.remaining_mm)) / tolerance.centre_mm(board)]
        rest += [abs(float(angle)) / tolerance.deg for angle in now.remaining_deg]
        while ahead and rest[ahead[0] - 1] <= 1:
            ahead.pop(0)
        took = person.reaction_s + (person.reading_s if ahead else person.glance_s)
        number = ahead.pop(0) if ahead else 1 + int(np.argmax(rest))
        told = 1 + person.told_share * rng.standard_normal()
        if number == 1:
            return took, [Motion(now.remaining_mm / 1000 * told, np.zeros(3))]
        turn = np.zeros(3)
        turn[number - 2] = now.remaining_deg[number - 2] * told
        return took, [Motion(np.zeros(3), turn)]

    return look


def _axes_reader(person: Assumptions, board: Board, rng: np.random.Generator) -> Reader:
    """All six at once, from two sets of axes; each look reads them again."""

    def look(now: Match, pose: Pose, target: Pose) -> tuple[float, list[Motion]]:
        missing = _missing_deg(pose, target)
        took = person.reaction_s + person.glance_s
        took += float(np.linalg.norm(missing)) / person.rotation_deg_per_s
        sense = -1.0 if rng.random() < person.axes_flip else 1.0
        return took, _judged(
            person, now, missing, sense, person.axes_tilt_share, person.axes_tilt_deg, rng
        )

    return look


def _outline_reader(person: Assumptions, board: Board, rng: np.random.Generator) -> Reader:
    """The silhouette alone: the sign of the tilt is guessed, and changed if it does not help."""
    mirrored = rng.random() < person.outline_flip

    def look(now: Match, pose: Pose, target: Pose) -> tuple[float, list[Motion]]:
        nonlocal mirrored
        took = person.reaction_s + person.glance_s
        believed = {False: target, True: mirrored_tilt(target)}
        if pose.angle_to_deg(believed[mirrored]) < _ALIGNED_DEG and now.overlap > 0.7:
            # It looks right but is not accepted: try the other sign.
            mirrored = not mirrored if person.outline_flip > 0 else mirrored
        missing = _missing_deg(pose, believed[mirrored])
        took += float(np.linalg.norm(missing)) / person.rotation_deg_per_s
        return took, _judged(
            person, now, missing, 1.0, person.outline_tilt_share, person.outline_tilt_deg, rng
        )

    return look


def _perfect_reader(person: Assumptions, board: Board, rng: np.random.Generator) -> Reader:
    """Knows the remaining motion without looking."""

    def look(now: Match, pose: Pose, target: Pose) -> tuple[float, list[Motion]]:
        shift, turn = target.t - pose.t, _missing_deg(pose, target)
        return person.reaction_s, [Motion(shift, np.zeros(3)), Motion(np.zeros(3), turn)]

    return look


READERS: dict[Help, Callable[[Assumptions, Board, np.random.Generator], Reader]] = {
    "steps": _steps_reader,
    "axes": _axes_reader,
    "outline": _outline_reader,
    "perfect": _perfect_reader,
}


def _judged(
    person: Assumptions,
    now: Match,
    missing_deg: Array,
    sense: float,
    tilt_share: float,
    tilt_deg: float,
    rng: np.random.Generator,
) -> list[Motion]:
    """The motions of a person who judges shift and turn from an image: place, then turn."""
    noise = rng.standard_normal(6)
    shares = np.array([person.place_share, person.place_share, person.depth_share])
    shift = now.remaining_mm / 1000 * (1 + shares * noise[:3])
    floor = np.array([tilt_deg, tilt_deg, 0.0])
    share = np.array([tilt_share, tilt_share, person.place_share])
    scatter = np.hypot(share * missing_deg, np.minimum(floor, np.linalg.norm(missing_deg)))
    turn = missing_deg * np.array([sense, sense, 1.0]) + scatter * noise[3:]
    return [Motion(shift, np.zeros(3)), Motion(np.zeros(3), turn)]


def _missing_deg(pose: Pose, target: Pose) -> Array:
    """(3,) rotation vector from the pose's orientation to the target's, degrees."""
    return np.degrees(Pose(target.R @ pose.R.T, np.zeros(3)).rvec)


def mirrored_tilt(pose: Pose) -> Pose:
    """The board tilted the other way, which covers the same pixels if seen from very far.

    `R = S Rz` with the swing S about an axis perpendicular to the line of sight; under parallel
    projection S and its inverse foreshorten the board alike.
    """
    sight = pose.t / np.linalg.norm(pose.t)
    axis = np.cross(sight, pose.R[:, 2])
    sine = float(np.linalg.norm(axis))
    if sine < 1e-9:
        return pose
    angle = np.degrees(np.arctan2(sine, float(sight @ pose.R[:, 2])))
    back = _rotation(-2 * angle * axis / sine)
    return Pose(back @ pose.R, pose.t)
