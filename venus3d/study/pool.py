"""A recording as a pool of real views: detection, test split, and the view nearest to a pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field

import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.lens_choice import calibrate_with_any_lens
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.repeats import SAME, shift_px
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.lenses import BROWN5, LensModel, lens_chosen
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.sources.recording import OnCount, Recording, observe_recording
from venus3d.sources.sim import Simulation

FEWEST_TRAINING, FEWEST_TEST = 6, 4
"""The repaired rule of convergence gives no verdict before six views; a test on fewer than four
views depends too much on each."""
_COMPLETE = 0.5  # share of the board's corners required in a view
_MORE_DEG, _FARTHER = 5.0, 1.15  # beyond the recording's range
_SHARP = 0.7  # of the median sharpness; below it a frame is blurred


@dataclass(frozen=True, eq=False)
class ViewPool:
    """The usable views of one recording, in order."""

    name: str
    """What the user typed."""
    board: Board
    """The board as it was read."""
    observations: tuple[Observation, ...]
    frames: int
    """Number of frames of the recording."""
    notes: tuple[str, ...] = ()
    asking: Mapping[str, float] = field(default_factory=dict[str, float])
    """Fields of `Limits` for targets (see `asking_limits`); empty for the usual ones."""
    lens: LensModel = BROWN5
    """The lens model to calibrate it with."""
    truth: Camera | None = None
    """The true camera, if known (simulated images)."""

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        return self.observations[0].image_size


def pool_of(
    spec: str,
    board: Board,
    *,
    same: float = SAME,
    lens: str = BROWN5.name,
    on_count: OnCount | None = None,
) -> ViewPool:
    """Search a recording once and keep the views that can be calibrated from.

    Args:
        spec: what the user typed; a recording for `open_frame_source`.
        board: what it shows.
        same: see `distinct`.
        lens: name of a lens model; "auto": found out from all views.
        on_count: see `observe_recording`.

    Raises:
        SourceError: it cannot be read.
        CalibrationError: it shows no board, or too few different views of it.
    """
    detector = Detector(board)
    recording = observe_recording(spec, detector, on_count)
    seen = [recording.observations[index] for index in frames_with_board(recording, spec)]
    kept = distinct(seen, detector.board, same)
    needed = FEWEST_TRAINING + FEWEST_TEST
    if len(kept) < needed:
        raise CalibrationError(
            f"{spec} holds only {len(kept)} sharp and different views of the board, and a pool "
            f"needs at least {needed}: {FEWEST_TRAINING} to calibrate from and {FEWEST_TEST} to "
            "test with; record more."
        )
    notes = (*recording.notes, *detector.notes)
    chosen = lens_chosen(lens)
    if chosen is None:
        chosen = calibrate_with_any_lens(detector.board, kept).camera.lens
    return ViewPool(
        spec,
        detector.board,
        tuple(kept),
        len(recording.observations),
        notes,
        asking_limits(detector.board, kept, chosen),
        chosen,
    )


def frames_with_board(recording: Recording, spec: str) -> list[int]:
    """The frames that show the board. Raises `CalibrationError` if there are none."""
    seen = [index for index, o in enumerate(recording.observations) if o.count]
    if not seen:
        raise CalibrationError(
            f"The board is seen in none of the {len(recording.observations)} frames of {spec}; "
            "check the board's options (columns, rows, dictionary)."
        )
    return seen


def asking_limits(
    board: Board, observations: Sequence[Observation], lens: LensModel = BROWN5
) -> dict[str, float]:
    """Limits of the targets: the recording's range, and a little more.

    A recording cannot follow a target: asked for a tilt of 50 degrees, a pool tilted by at most 20
    gives an arbitrary view. The poses come from a calibration with all views; the same limits hold
    for all methods. Raises `CalibrationError` if all views together determine no camera.
    """
    poses = [view.pose for view in calibrate(board, observations, lens=lens).views]
    angles = np.abs([pose.vector()[:3] for pose in poses])
    cosines = [pose.R[:, 2] @ pose.t / np.linalg.norm(pose.t) for pose in poses]
    distances = np.linalg.norm([pose.apply(board.outline) for pose in poses], axis=2)
    usual = Limits()
    tilt = float(np.degrees(np.arccos(np.clip(min(cosines), 0.0, 1.0))))
    return {
        "max_angle_deg": min(usual.max_angle_deg, float(angles.max()) + _MORE_DEG),
        "max_tilt_deg": min(usual.max_tilt_deg, tilt + _MORE_DEG),
        "nearest": float(distances.min()) / _FARTHER,
        "farthest": float(distances.max()) * _FARTHER,
    }


def simulated_pool(board: Board, rng: np.random.Generator, count: int = 150) -> ViewPool:
    """Images from the simulated camera: `count` random poses within the limits. Not a real
    recording.

    For when no recording is rich enough to show a difference between methods; rendered through the
    paper's camera, blurred and noisy, and detected like others.
    """
    limits = Limits.for_board(board, PAPER_CAMERA)
    space = Space(board, PAPER_CAMERA, limits)
    detector = Detector(board, find_layout=False)
    seen: list[Observation] = []
    seed = int(rng.integers(2**31))
    with closing(Simulation(board=board, seed=seed, autopilot=False)) as source:
        for number in range(count):
            source.move_to(Pose.from_vector(random_pose(space, rng)))
            frame = source.read()
            assert frame is not None
            seen.append(detector.detect(frame.image, name=f"pose {number + 1}"))
        notes = source.notes
    kept = tuple(distinct(seen, board))
    return ViewPool("sim", board, kept, count, notes, truth=PAPER_CAMERA)


def distinct(
    observations: Sequence[Observation], board: Board, same: float = SAME
) -> list[Observation]:
    """The views that show enough of the board, are sharp, and repeat no earlier one.

    Duplicates would make the test easy: a held-out frame with its neighbour in training tests
    nothing. Two views are duplicates if their corners are on average nearer than `same` of the
    image's width.
    """
    needed = max(8, round(_COMPLETE * board.corner_count))
    whole = [o for o in observations if o.count >= needed]
    median = float(np.median([o.sharpness for o in whole])) if whole else 0.0
    kept: list[Observation] = []
    for view in whole:
        least = same * view.image_size[0]
        if view.sharpness >= _SHARP * median and all(shift_px(view, o) >= least for o in kept):
            kept.append(view)
    return kept


def split(
    count: int, rng: np.random.Generator, share: float = 0.3
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Indices 0 ... count - 1 in two ascending parts: for calibration, and held out.
    A random `share` is held out, at least four views, leaving at least six."""
    held = min(max(FEWEST_TEST, round(share * count)), count - FEWEST_TRAINING)
    order = rng.permutation(count)
    return tuple(sorted(order[held:].tolist())), tuple(sorted(order[:held].tolist()))


def nearest(
    wanted: Pose, pool: ViewPool, indices: Sequence[int], camera: Camera, limits: Limits
) -> tuple[int, Pose] | None:
    """Of the views `indices` the one whose pose under `camera` is nearest (see `distance`), and
    that pose.

    None if no view has a pose. The camera is the current estimate of the guidance: as for a person
    who aligns the board with an outline on screen, images have to agree, not metres.
    """
    best: tuple[int, Pose] | None = None
    least = np.inf
    for index in indices:
        pose = estimate_pose(camera, pool.board, pool.observations[index])
        if pose is not None and (apart := distance(wanted, pose, camera, limits)) < least:
            best, least = (index, pose), apart
    return best


def distance(one: Pose, other: Pose, camera: Camera, limits: Limits) -> float:
    """Distance of two poses, as shares of the allowed ranges; 0 for the same pose.

    The root of the summed squares of the turn between them (over twice the largest angle), the
    shift of the board's centre in the image (over its width), and the ratio of the distances from
    the lens (log, over the range): the coordinates of the search (`Space.to_unit`). Distances of
    projected corners would hardly see the sign of a tilt.
    """
    turn = one.angle_to_deg(other) / (2 * limits.max_angle_deg)
    pinhole = camera.without_distortion()
    shift = np.linalg.norm(pinhole.project(one.t) - pinhole.project(other.t)) / camera.width
    depth = np.log(one.t[2] / other.t[2]) / np.log(limits.farthest / limits.nearest)
    return float(np.sqrt(turn**2 + shift**2 + depth**2))
