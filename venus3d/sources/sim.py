"""A simulated camera and board with known parameters and pose.

The board is rendered through the true lens (`render.offscreen`), then the `sim_sensor` makes a
picture of it. It is moved by the `autopilot`, step by step, or dragged by the user.
"""

from __future__ import annotations

import math
import threading
import time
from concurrent.futures import Future
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.decomposition import HOME_DISTANCE, home_pose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.target import Target
from venus3d.render.board_mesh import board_shape
from venus3d.render.offscreen import Offscreen
from venus3d.sources.autopilot import Autopilot
from venus3d.sources.background import interior
from venus3d.sources.frame import Frame
from venus3d.sources.sim_sensor import KEY, Blur, Sensor
from venus3d.sources.view_errors import ViewError, ViewErrors

NEAREST, FARTHEST = 0.06, 3.0
"""Least distance of a corner from the lens's plane, largest of the board's centre; metres."""
_FOCUS_S = 1.0
# Seconds after which a waiting image is outdated and not shown.
_STALE_S = 0.5
_ROOM = 1.3  # home, in distances at which the board fills the image
_MISJUDGED = 1.5  # of a distance: less is corrected on arrival


@dataclass(frozen=True)
class Exposed:
    """An image that is still being rendered."""

    picture: Future[NDArray[np.uint8]]
    """RGB, the board alone on the key colour."""
    blur: Blur
    pose: Pose
    time_s: float
    name: str


class Simulation:
    """A source with ground truth. `read` may run in one thread, the rest in another."""

    def __init__(
        self,
        camera: Camera = PAPER_CAMERA,
        board: Board | None = None,
        *,
        field_deg: float | None = None,
        seed: int = 0,
        fps: float = 25.0,
        realtime: bool = False,
        noise_sigma: float = 4.0,
        blur_sigma: float = 0.8,
        background: NDArray[np.uint8] | None = None,
        light: float = 0.86,
        autopilot: bool = True,
        speed: float = 1.0,
        start: Pose | None = None,
        view_errors: ViewErrors | None = None,
        offscreen: Offscreen | None = None,
    ) -> None:
        """A simulation at its start pose.

        Args:
            camera: the ground truth.
            board: the default board if None.
            field_deg: diameter of a fisheye's image circle, degrees; dark beyond. None if the
                whole picture is exposed.
            seed: for background, noise and autopilot.
            fps: frames per simulated second.
            realtime: frames come at `fps` by the wall clock, instead of at once.
            noise_sigma: of a pixel, in grey values.
            blur_sigma: of the image, pixels.
            background: BGR image behind the board, of the camera's size; an interior if None.
            light: brightness of white paper, 0 ... 1.
            autopilot: whether the simulated hand holds the board from the start.
            speed: of the simulated hand (see `Autopilot`).
            start: `T_camera_board` at the start; if None so near that the board is cut off.
            view_errors: errors that all corners of a view share, drawn anew for each target, the
                blur every second; none if None.
            offscreen: a renderer to share; if None an own one is opened and closed.
        """
        self.truth = camera
        self.board = Board() if board is None else board
        self.autopilot_on = autopilot
        self._realtime, self._fps = realtime, fps
        background_rng, noise_rng, hand_rng, self._errors_rng = np.random.default_rng(seed).spawn(4)
        home = home_pose(max(HOME_DISTANCE, _ROOM * _filled_at(camera, self.board)))
        self._autopilot = Autopilot(hand_rng, speed, home=home)
        if background is None:
            background = interior(camera.image_size, background_rng)
        self._sensor = Sensor(
            camera,
            background,
            noise_rng,
            light=light,
            noise_sigma=noise_sigma,
            field_deg=field_deg,
        )
        self._blur_sigma, self._blur = blur_sigma, self._sensor.blur(blur_sigma)
        self._lock = threading.Lock()
        self._view_errors, self._view_error = view_errors, ViewError(self.board)
        self._hand = near_pose(camera, self.board) if start is None else start
        self._target: Target | None = None
        self._seen: Pose | None = None
        self._leaves = False
        self._number = 0
        self._time_s = self._focused_s = 0.0
        self._due = 0.0
        self._exposed: Exposed | None = None
        self._closed = False
        self._owned = offscreen is None
        # The lens map and the blur smooth the board's edges; its print is filtered.
        self._offscreen = Offscreen(smooth=False) if offscreen is None else offscreen

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the frames."""
        return self.truth.image_size

    @property
    def is_live(self) -> bool:
        """Whether it keeps to the wall clock."""
        return self._realtime

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks for the user: OpenGL is missing or has failed."""
        return (self._offscreen.note,) if self._offscreen.note else ()

    @property
    def board_pose(self) -> Pose:
        """The board's true pose, `T_camera_board`."""
        return self._hand

    @property
    def step(self) -> int:
        """The autopilot's current step, 1 ... 4."""
        return self._autopilot.step

    def follow(
        self,
        target: Target | None,
        seen: Pose | None = None,
        *,
        begins: bool = False,
        taken_back: bool = False,
    ) -> None:
        """Give the autopilot its target, and the board's pose as estimated by the calibration.

        With `seen` it corrects its position on arrival: as the target is a pose in an estimated
        camera, the true board has to be slightly beside it. If the calibration `begins`, without
        any view, it brings the board into view as long as there is no target. Where the view at the
        target was `taken_back`, it moves the board away first, as the page asks: to its home.
        """
        with self._lock:
            self._leaves = taken_back and (self._leaves or self._autopilot.arrived)
            if self._leaves:
                target = None
            new = target is not None and (
                self._target is None or target.number != self._target.number
            )
            self._target, self._seen = self._as_shown(target, seen)
            if new and self._target is not None:
                self._draw(self._target.pose)
            if target is None and (begins or self._leaves):
                self._autopilot.forget_target()

    def draw_view_error(self, pose: Pose) -> None:
        """Draw the errors of a view at `T_camera_board` anew, as `follow` does for a new target."""
        with self._lock:
            self._draw(pose)

    def _draw(self, pose: Pose) -> None:
        if not self._view_errors:
            return
        pixel = float(np.linalg.norm(pose.t)) / self.truth.fx
        self._view_error = self._view_errors.drawn(self.board, pixel, self._errors_rng)
        self._focus()

    def _focus(self) -> None:
        """Draw the blur anew, if it is drawn at all."""
        if self._view_errors and self._view_errors.blur_px > 0:
            more = self._view_errors.drawn_blur(self._errors_rng)
            self._blur = self._sensor.blur(math.hypot(self._blur_sigma, more))
        self._focused_s = self._time_s

    def _as_shown(
        self, target: Target | None, seen: Pose | None
    ) -> tuple[Target | None, Pose | None]:
        """A target and the board's pose as a person carries them out: by the picture.

        Both are poses in an estimated camera. One whose focal length is far off, as a telephoto's
        before the first view, sees the same picture at another distance.
        """
        if target is None or seen is None:
            return target, seen
        depth = float(self._hand.t[2] / seen.t[2])
        if 1 / _MISJUDGED < depth < _MISJUDGED:
            return target, seen
        true = np.array([1.0, 1.0, depth])
        return (
            replace(target, pose=Pose(target.pose.R, target.pose.t * true)),
            Pose(seen.R, seen.t * true),
        )

    def move_to(self, pose: Pose) -> None:
        """Move the board to `T_camera_board`, kept in front of the lens and in view."""
        with self._lock:
            self._hand = _in_view(pose, self.board, self.truth)

    def read(self) -> Frame | None:
        """The next frame; None once closed. In real time it was exposed during the last call."""
        if self._closed:
            return None
        if self._realtime:
            if time.monotonic() - self._due > _STALE_S:
                self._exposed = None  # from before a pause
            # As a camera reads out one image while it exposes the next: the renderer has a whole
            # period, and frames come one period late.
            exposed, self._exposed = self._exposed or self._expose(), self._expose()
        else:
            exposed = self._expose()
        image = self._sensor.develop(exposed.picture.result(), exposed.pose, exposed.blur)
        return Frame(image, exposed.time_s, exposed.name)

    def close(self) -> None:
        """Release the renderer. May be called twice."""
        self._closed = True
        if self._owned:
            self._offscreen.close()

    def _wait(self) -> float:
        """Keep the rate in real time; the simulated time since the last frame, seconds."""
        period = 1 / self._fps
        if not self._realtime:
            return period
        now = time.monotonic()
        time.sleep(max(0.0, self._due - now))
        late = max(0.0, now - self._due) if self._number else 0.0
        self._due = max(now, self._due) + period
        # A slow machine shows fewer frames, not a slower hand; no jump after a pause.
        return min(period + late, 0.2)

    def _expose(self) -> Exposed:
        """Take the next time step and pass its image to the renderer."""
        dt_s = self._wait()
        with self._lock:
            if self._number > 0:
                self._time_s += dt_s
                if self._time_s > self._focused_s + _FOCUS_S:
                    self._focus()
                if self.autopilot_on:
                    self._hand = self._autopilot.advance(self._hand, self._target, dt_s, self._seen)
            pose, error, blur = self._hand, self._view_error, self._blur
        self._number += 1
        shapes = (board_shape(error.board, pose, offset=error.offset),)
        picture = self._offscreen.submit(self.truth, shapes, background=KEY)
        return Exposed(picture, blur, pose, self._time_s, f"frame {self._number}")


def _filled_at(camera: Camera, board: Board) -> float:
    """The distance at which a board fills the image, metres."""
    return max(board.width * camera.fx / camera.width, board.height * camera.fy / camera.height)


def near_pose(camera: Camera, board: Board) -> Pose:
    """A board too near to fit into the image: where a person starts (3.1)."""
    # A fisheye sees the whole of any board that can be held before it.
    fills = max(_filled_at(camera, board), 0.15)
    return Pose.from_vector([5.0, -7.0, 3.0, 0.12 * fills, -0.06 * fills, 0.72 * fills])


def _in_view(pose: Pose, board: Board, camera: Camera) -> Pose:
    """The pose, moved to where the board can be found again."""
    if not camera.lens.is_perspective:
        away = np.linalg.norm(pose.t)
        direction = pose.t / max(float(away), 1e-9)
        # In front of the lens, even if it sees behind itself.
        direction = np.array([*direction[:2], max(direction[2], 0.05)])
        away = np.clip(away, NEAREST + board.width / 2, FARTHEST)
        placed = direction * (away / np.linalg.norm(direction))
        return Pose(pose.R, np.asarray(placed, dtype=np.float64))
    nearest = float(pose.apply(board.outline)[:, 2].min())
    back = max(0.0, NEAREST - nearest)
    t = pose.t + np.array([0.0, 0.0, back])
    t[2] = min(t[2], max(FARTHEST, t[2] - nearest))
    # Beyond 45 degrees off the axis nobody would find it again.
    t[:2] = np.clip(t[:2], -t[2], t[2])
    return Pose(pose.R, t)
