"""The camera: image size, focal lengths, principal point, and a lens with its coefficients.

Closed form and batched over poses, since a search evaluates thousands. Integer pixel coordinates
are pixel centres (OpenCV). What the lens does is in `lenses`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.image_circle import ImageCircle
from venus3d.engine.geometry.lenses import (
    BROWN5,
    FISHEYE,
    PINHOLE,
    RATIONAL,
    RATIONAL_THIN_PRISM,
    LensModel,
)
from venus3d.engine.geometry.pose import Array

PINHOLE_PARAMETERS = ("fx", "fy", "cx", "cy")
"""The parameters that a camera has with every lens; the lens's coefficients follow them."""


@dataclass(frozen=True, init=False, repr=False)
class Camera:
    """Intrinsics of a camera for images of one size. Focal lengths and centre in pixels."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    coefficients: tuple[float, ...]
    """(p,) of the lens, in the order of its `coefficient_names`."""
    lens: LensModel
    image_circle: ImageCircle | None
    """What the lens lights of the image; None: all of it."""

    def __init__(
        self,
        width: int,
        height: int,
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        *values: float,
        coefficients: tuple[float, ...] = (),
        lens: LensModel = BROWN5,
        image_circle: ImageCircle | None = None,
        **named: float,
    ) -> None:
        """The lens's coefficients as `values` in its order, as `coefficients`, or by name; those
        not given are zero. Raises `CalibrationError` for what is no camera."""
        given = dict(zip(lens.coefficient_names, values or coefficients, strict=False)) | named
        if len(values or coefficients) > len(lens.coefficient_names) or not set(given) <= set(
            lens.coefficient_names
        ):
            raise CalibrationError(
                f"A lens of the model {lens.name} has the coefficients "
                f"{', '.join(lens.coefficient_names) or '(none)'}."
            )
        own = tuple(given.get(name, 0.0) for name in lens.coefficient_names)
        found = (width, height, fx, fy, cx, cy, own, lens, image_circle)
        for name, value in zip(self.__dataclass_fields__, found, strict=True):
            object.__setattr__(self, name, value)
        if width < 1 or height < 1:
            raise CalibrationError(f"An image of {width} x {height} px has no pixels.")
        if not np.isfinite(self.parameters).all() or fx <= 0 or fy <= 0:
            raise CalibrationError("A camera needs finite parameters and positive focal lengths.")

    def __repr__(self) -> str:
        named = ", ".join(f"{name}={value:.6g}" for name, value in self.named.items())
        return f"Camera({self.width}, {self.height}, {named}, lens={self.lens.name})"

    @staticmethod
    def from_parameters(
        parameters: ArrayLike, image_size: tuple[int, int], lens: LensModel = BROWN5
    ) -> Camera:
        """Camera of its parameters (4 + p,), the image size (width, height) and the lens."""
        values = np.asarray(parameters, dtype=np.float64).tolist()
        return Camera(*image_size, *values[:4], coefficients=tuple(values[4:]), lens=lens)

    @staticmethod
    def from_opencv(
        K: ArrayLike, distortion: ArrayLike, image_size: tuple[int, int], *, fisheye: bool = False
    ) -> Camera:
        """Camera of OpenCV's camera matrix (3, 3) and distortion coefficients: up to five, eight
        (rational) or twelve (with a thin prism); or the four of `cv2.fisheye`."""
        k = np.asarray(K, dtype=np.float64)
        given = np.asarray(distortion, dtype=np.float64).ravel()
        known = (FISHEYE,) if fisheye else (BROWN5, RATIONAL, RATIONAL_THIN_PRISM)
        for lens in known:
            count = len(lens.coefficient_names)
            if not np.any(given[count:] != 0):
                own = np.zeros(count)
                own[: min(count, given.size)] = given[:count]
                focal = [k[0, 0], k[1, 1], k[0, 2], k[1, 2]]
                return Camera.from_parameters([*focal, *own], image_size, lens)
        raise CalibrationError(
            f"This camera has {given.size} distortion coefficients, and no lens model here has so "
            "many; calibrate with fewer."
        )

    @staticmethod
    def guess(image_size: tuple[int, int], fov_deg: float = 60.0) -> Camera:
        """An uncalibrated camera with this horizontal field of view and no distortion."""
        width, height = image_size
        f = width / 2 / np.tan(np.radians(fov_deg) / 2)
        return Camera(width, height, f, f, (width - 1) / 2, (height - 1) / 2)

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height), pixels."""
        return (self.width, self.height)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """(4 + p,) fx, fy, cx, cy and the lens's coefficients: the order used everywhere."""
        return (*PINHOLE_PARAMETERS, *self.lens.coefficient_names)

    @property
    def parameters(self) -> Array:
        """(4 + p,) values in the order of `parameter_names`."""
        return np.array([self.fx, self.fy, self.cx, self.cy, *self.coefficients], dtype=np.float64)

    @property
    def named(self) -> dict[str, float]:
        """The parameters by name."""
        return dict(zip(self.parameter_names, self.parameters.tolist(), strict=True))

    @property
    def K(self) -> Array:
        """(3, 3) OpenCV camera matrix."""
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], dtype=np.float64)

    @property
    def distortion(self) -> Array:
        """OpenCV's `distCoeffs` (5,), (8,) or (12,); of a fisheye the `D` (4,) of `cv2.fisheye`."""
        return np.array(self.lens.opencv(self.coefficients), dtype=np.float64)

    @property
    def is_pinhole(self) -> bool:
        """Whether the lens bends nothing."""
        return self.lens.is_perspective and not any(self.coefficients)

    @property
    def fov_deg(self) -> tuple[float, float]:
        """Horizontal and vertical field of view of the undistorted pinhole, degrees."""
        return (
            float(np.degrees(2 * np.arctan(self.width / (2 * self.fx)))),
            float(np.degrees(2 * np.arctan(self.height / (2 * self.fy)))),
        )

    @property
    def image_corners(self) -> Array:
        """(4, 2) centres of the image's corner pixels."""
        return np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * (np.array(self.image_size) - 1.0)

    def without_distortion(self) -> Camera:
        """The pinhole of the same camera matrix."""
        if self.lens.is_perspective:
            return replace(self, coefficients=())
        return replace(self, coefficients=(), lens=PINHOLE)

    @property
    def unbent(self) -> Camera:
        """The pinhole of a perspective lens, whose estimate may fold back; a wide lens as it is,
        since no pinhole sees as far."""
        return self.without_distortion() if self.lens.is_perspective else self

    def with_lens(self, lens: LensModel) -> Camera:
        """The same camera with a lens model that has all coefficients of this one, the others zero.
        Raises `CalibrationError` for another one."""
        if not set(self.lens.coefficient_names) <= set(lens.coefficient_names):
            raise CalibrationError(f"A lens of the model {self.lens.name} is none of {lens.name}.")
        own = tuple(self.named.get(name, 0.0) for name in lens.coefficient_names)
        return replace(self, coefficients=own, lens=lens)

    def scaled(self, image_size: tuple[int, int]) -> Camera:
        """The same lens with another image size; half a pixel is kept at the borders."""
        sx, sy = image_size[0] / self.width, image_size[1] / self.height
        return replace(
            self,
            width=image_size[0],
            height=image_size[1],
            fx=self.fx * sx,
            fy=self.fy * sy,
            cx=(self.cx + 0.5) * sx - 0.5,
            cy=(self.cy + 0.5) * sy - 0.5,
            image_circle=self.image_circle and self.image_circle.scaled(sx, sy),
        )

    @property
    def told_distortion(self) -> str:
        """The coefficients for a person: "k1 = -0.3, k2 = 0.1"."""
        return ", ".join(f"{name} = {self.named[name]:.4g}" for name in self.lens.coefficient_names)

    @cached_property
    def angle_limit(self) -> float:
        """Largest angle from the optical axis, rad, that the lens model reaches. Beyond it the
        model folds back, and points outside the view project into the image."""
        return self.lens.angle_limit(self.coefficients)

    @property
    def radius_limit(self) -> float:
        """The same as a radius at Z = 1; inf from a right angle on."""
        return float(np.tan(self.angle_limit)) if self.angle_limit < np.pi / 2 else float("inf")

    def reaches(self, points: Array) -> NDArray[np.bool_]:
        """Which of the points (3, ...) are within `angle_limit`: (...)."""
        limit = self.angle_limit
        if limit == np.pi / 2:
            return np.asarray(points[2] > 0)
        with np.errstate(invalid="ignore", over="ignore"):
            radius = np.sqrt(points[0] * points[0] + points[1] * points[1])
            if limit >= np.pi:
                return np.asarray((points[2] > 0) | (radius > 0))
            return np.asarray(points[2] > radius / np.tan(limit))

    def distort(self, normalised: ArrayLike) -> Array:
        """Eq. (4): ideal to distorted normalised coordinates (..., 2)."""
        xy = np.moveaxis(np.asarray(normalised, dtype=np.float64), -1, 0)
        points = np.stack([*xy, np.ones(xy.shape[1:])])
        return np.moveaxis(self.lens.image(self.coefficients, points), 0, -1)

    def pixels_of(self, points: Array) -> Array:
        """Eqs (4), (5): points (3, ...) in the camera's frame to pixels (2, ...).
        Also beyond `angle_limit`, where the model folds back."""
        pixels = self.lens.image(self.coefficients, points)
        pixels[0] = self.fx * pixels[0] + self.cx
        pixels[1] = self.fy * pixels[1] + self.cy
        return pixels

    def project(self, points: ArrayLike) -> Array:
        """Eq. (5): points (..., 3) in the camera's frame, metres, to pixels (..., 2).
        NaN for points that the lens does not see: beyond `angle_limit`, for which a pinhole's is a
        right angle."""
        xyz = np.moveaxis(np.asarray(points, dtype=np.float64), -1, 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            pixels = self.pixels_of(xyz)
        return np.moveaxis(np.where(self.reaches(xyz), pixels, np.nan), 0, -1)

    def unproject(self, pixels: ArrayLike) -> Array:
        """Pixels (..., 2) to the rays from which they come, unit vectors (..., 3).
        NaN for a pixel that no ray reaches."""
        uv = np.asarray(pixels, dtype=np.float64)
        image = (uv - [self.cx, self.cy]) / [self.fx, self.fy]
        rays = self.lens.rays(self.coefficients, image)
        if self.image_circle is None:
            return rays
        return np.where(self.image_circle.contains(uv)[..., None], rays, np.nan)

    def project_board(self, points: ArrayLike, R: ArrayLike, t: ArrayLike) -> Array:
        """Pixels (N, M, 2) of board points (M, 3) under poses R (N, 3, 3), t (N, 3)."""
        board = np.asarray(points, dtype=np.float64)
        rotations, positions = np.asarray(R, dtype=np.float64), np.asarray(t, dtype=np.float64)
        return self.project(board @ np.swapaxes(rotations, -1, -2) + positions[:, None, :])

    def project_with_jacobians(
        self, points: ArrayLike, R: ArrayLike, t: ArrayLike
    ) -> tuple[Array, Array, Array]:
        """Pixels of board points under many poses, and their derivatives.

        Args:
            points: (M, 3) in the board's frame, metres.
            R, t: (N, 3, 3) and (N, 3), `T_camera_board`; all points in front of the lens.

        Returns:
            pixels (N, M, 2); by the p parameters (N, M, 2, p); by the pose (N, M, 2, 6).
            The pose is perturbed as `R <- exp(w) R, t <- t + v`: a rotation w (rad) about the
            camera's axes through the board's centre and a translation v (m).
        """
        J = self.jacobians(points, R, t)
        u = self.fx * J[:, 6, 0] + self.cx
        v = self.fy * J[:, 7, 1] + self.cy
        last = np.moveaxis(J, 1, -1).swapaxes(1, 2)
        return np.stack([u, v], axis=-1), last[..., 6:], last[..., :6]

    def jacobians(self, points: ArrayLike, R: ArrayLike, t: ArrayLike) -> Array:
        """The same derivatives as (N, 6 + p, 2, M): six of the pose (w, v), p of the parameters.
        Each of them is contiguous, u of all points and then v: J J^T needs no copy."""
        rotations, positions = np.asarray(R, dtype=np.float64), np.asarray(t, dtype=np.float64)
        arm = rotations @ np.swapaxes(np.asarray(points, dtype=np.float64), -1, -2)
        J = np.empty((len(arm), 10 + len(self.coefficients), 2, arm.shape[2]))
        self.lens.differentiate(
            self.coefficients,
            (self.fx, self.fy),
            arm + positions[:, :, None],
            J[:, 3:6],
            J[:, 6:8],
            J[:, 10:],
        )
        intrinsic = J[:, 6:10]
        intrinsic[:, 0, 1] = intrinsic[:, 1, 0] = intrinsic[:, 2, 1] = intrinsic[:, 3, 0] = 0.0
        intrinsic[:, 2, 0] = intrinsic[:, 3, 1] = 1.0
        # d(exp(w) arm)/dw = -[arm]x, so the gradient by w is arm x g.
        for row in range(2):
            gx, gy, gz = J[:, 3, row], J[:, 4, row], J[:, 5, row]
            np.subtract(arm[:, 1] * gz, arm[:, 2] * gy, out=J[:, 0, row])
            np.subtract(arm[:, 2] * gx, arm[:, 0] * gz, out=J[:, 1, row])
            np.subtract(arm[:, 0] * gy, arm[:, 1] * gx, out=J[:, 2, row])
        return J


FOLDED = 0.05
"""Share of the picture in which a lens model may fold back, as one does in the outermost corners if
it was calibrated without views there."""


def folded_share(camera: Camera, pixels: ArrayLike) -> float:
    """Share of the pixels (n, 2) that no ray reaches, as the lens model folds back before."""
    rays = replace(camera, image_circle=None).unproject(pixels)
    return 1 - float(np.isfinite(rays[:, 2]).mean())


def planning_camera(camera: Camera) -> Camera:
    """The camera to plan with: without distortion if its estimate folds back within the image.

    From two or three views the high orders are nearly free. If the model folds back, no pose near
    the border seems possible, just where the next view is needed.
    """
    corners = camera.image_corners
    reach = np.linalg.norm((corners - [camera.cx, camera.cy]) / [camera.fx, camera.fy], axis=1)
    if not camera.lens.is_perspective:
        # Outside its image circle a fisheye sees nothing, and so nothing is lost there.
        half = min(camera.image_size) / 2
        sides = np.array([[half, 0], [-half, 0], [0, half], [0, -half]])
        corners = sides + np.array([camera.cx, camera.cy])
        reach = np.zeros(1)
    seen = np.isfinite(replace(camera, image_circle=None).unproject(corners)).all()
    if camera.radius_limit > 1.02 * reach.max() and seen:
        return camera
    return replace(camera, coefficients=())


PAPER_CAMERA = Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
"""The camera of the paper's simulation (4.1.2), its distortion read in OpenCV's order."""
