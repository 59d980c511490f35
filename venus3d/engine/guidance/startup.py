"""First estimate of the focal length, from single views of a moving board (3.1).

Every live frame is calibrated by itself with the start-up model, and the best estimate is kept
until the first capture. Meanwhile the board moves away from the camera, and the first frame that
shows all of it gives the distance of the first target.
"""

from __future__ import annotations

import numpy as np

from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.lens_choice import start_with_any_lens
from venus3d.engine.calibration.observation import Observation, determines_homography
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import LensModel
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import STARTUP_REASON
from venus3d.engine.planning.settings import Cost, Method
from venus3d.engine.planning.target import Target, unpredicted_target

TILT_DEG = 45.0
"""Turn of the first target about the camera's X axis (3.1)."""
_COMPLETE = 0.95  # share of the corners that counts as the whole board: glare may hide one
_MARGIN = 0.06  # of the image's width and height, kept free around the first target
_FARTHER = 1.5  # the first target is at most this much farther than the margin requires
_LEAST_TILT_DEG = 15.0
_LEAST_CORNERS = 8
_LARGEST_SHARE = 0.05  # sigma of f over f
_DRIFT = 0.05  # the target stays until the estimate has moved it by more than this share of z
_FOV_DEG = (5.0, 140.0)


class Startup:
    """The best camera estimated from single views of a moving board. Used by one thread."""

    def __init__(
        self, board: Board, image_size: tuple[int, int], lens: LensModel | None = None
    ) -> None:
        """No estimate yet: `camera` is a guess for images of `image_size` (width, height). `lens`:
        the one that is wanted; None: it is found out."""
        self._lens = lens
        self._board, self._image_size = board, image_size
        self.camera = Camera.guess(image_size)
        """The best estimate so far; `Camera.guess` before the first."""
        self.best: Calibration | None = None
        """Of the best view so far; None before one has determined the focal length."""
        self._complete: Observation | None = None
        self.distance: float | None = None
        """z of the board's centre when it was first seen whole, metres, under `camera`.
        None until then."""

    @property
    def is_ready(self) -> bool:
        """Whether the first view may be captured by itself."""
        return self.best is not None

    @property
    def target(self) -> Pose:
        """[45, 0, 0, 0, 0, z]: the whole board in the image with a margin, near `distance`."""
        nearest = self._nearest_fit()
        z = nearest
        if self.distance is not None:
            z = float(np.clip(self.distance, nearest, _FARTHER * nearest))
        return Pose.from_vector([TILT_DEG, 0, 0, 0, 0, z])

    def updated_target(
        self, old: Target | None, number: int, method: Method, cost: Cost | None
    ) -> Target | None:
        """The start-up pose as target `number`, or `old` while the estimate has hardly moved it."""
        if self.distance is None:
            return old
        pose = self.target
        if old is not None and old.pose.distance_to(pose) < _DRIFT * pose.t[2]:
            return old
        return unpredicted_target(
            number,
            pose,
            self.camera,
            self._board,
            reason=STARTUP_REASON,
            method=method,
            cost=cost or "projection-variance",
            serves=("fx", "fy"),
        )

    def observe(self, observation: Observation) -> bool:
        """Process one frame; True if it gave a better camera. Unusable frames change nothing."""
        usable = (
            observation.image_size == self._image_size
            and bool(np.isfinite(observation.corners).all())
            and determines_homography(self._board.points_of(observation.ids))
        )
        if not usable:
            return False
        observation = observation.without_image()
        better = self._improve(observation)
        complete = observation.count >= _COMPLETE * self._board.corner_count
        # The next one, where no pose fitted the ones before: a wide lens, under the guess.
        first = complete and self.distance is None
        if first:
            self._complete = observation
        if self._complete is not None and (first or better):
            # A longer focal length puts the same image farther away.
            pose = estimate_pose(self.camera, self._board, self._complete)
            self.distance = None if pose is None else float(pose.t[2])
        return better

    def _improve(self, observation: Observation) -> bool:
        if observation.count < _LEAST_CORNERS:
            return False
        try:
            found = start_with_any_lens(self._board, [observation], lens=self._lens)
        except CalibrationError:
            return False  # this frame does not determine the focal length; the next one may
        if not self._shows_f(found):
            return False
        # The paper replaces the intrinsics when the reprojection error falls. That alone prefers
        # small, far and nearly frontal boards, which fit well whatever f is. So views are compared
        # by sigma_f = residual sigma x geometry: over 30 simulated walks of 60 frames f ends 6 px
        # off instead of 17 px.
        if self.best is not None and _share(found) >= _share(self.best):
            return False
        self.best, self.camera = found, found.camera
        return True

    def _shows_f(self, found: Calibration) -> bool:
        """Whether a view determines f at all.

        A frontal board fits any focal length with a low error, as a longer lens farther away gives
        the same image. Only a tilt determines f, by the foreshortening of the far edge.
        """
        tilt = float(np.degrees(np.arccos(np.clip(abs(found.views[0].pose.R[2, 2]), 0, 1))))
        low, high = _FOV_DEG
        fov = found.camera.fov_deg[0]
        return tilt >= _LEAST_TILT_DEG and _share(found) <= _LARGEST_SHARE and low < fov < high

    def _nearest_fit(self) -> float:
        """The smallest z at which the tilted board fits the image with the margin, metres."""
        turned = Pose.from_vector([TILT_DEG, 0, 0, 0, 0, 0]).apply(self._board.outline)
        camera = self.camera
        width, height = self._image_size
        room = (0.5 - _MARGIN) * np.array([width, height])
        # f |x| / (z + dz) <= room, solved for z; the start-up camera has its principal point at the
        # image's centre and no distortion.
        needed = camera.fx * np.abs(turned[:, :2]) / room - turned[:, 2:]
        return float(needed.max())


def _share(found: Calibration) -> float:
    """Relative sigma of f."""
    return float(found.sigma[0] / found.camera.fx)
