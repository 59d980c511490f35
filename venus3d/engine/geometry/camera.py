"""The camera model: pinhole with Brown's five-coefficient distortion, eqs (1)-(5).

Closed form and batched over poses, since a search evaluates thousands. Integer pixel coordinates
are pixel centres (OpenCV).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.pose import Array

PARAMETERS: tuple[str, ...] = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
"""The nine intrinsic parameters in the order used everywhere (OpenCV's distortion order)."""


@dataclass(frozen=True)
class Camera:
    """Intrinsics of a camera for images of one size. Focal lengths and centre in pixels."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0

    def __post_init__(self) -> None:
        if self.width < 1 or self.height < 1:
            raise CalibrationError(f"An image of {self.width} x {self.height} px has no pixels.")
        if not np.isfinite(self.parameters).all() or self.fx <= 0 or self.fy <= 0:
            raise CalibrationError("A camera needs finite parameters and positive focal lengths.")

    @staticmethod
    def from_parameters(parameters: ArrayLike, image_size: tuple[int, int]) -> Camera:
        """Camera of the nine `PARAMETERS` (9,) and the image size (width, height)."""
        values = [float(v) for v in np.asarray(parameters, dtype=np.float64).reshape(9)]
        return Camera(image_size[0], image_size[1], *values)

    @staticmethod
    def from_opencv(K: ArrayLike, distortion: ArrayLike, image_size: tuple[int, int]) -> Camera:
        """Camera of OpenCV's camera matrix (3, 3) and up to five distortion coefficients."""
        k = np.asarray(K, dtype=np.float64)
        d = np.zeros(5)
        given = np.asarray(distortion, dtype=np.float64).ravel()
        if given.size > 5 and np.any(given[5:] != 0):
            raise CalibrationError(
                "This camera has more than OpenCV's five distortion coefficients; "
                "calibrate with the five-coefficient model."
            )
        d[: min(5, given.size)] = given[:5]
        return Camera.from_parameters([k[0, 0], k[1, 1], k[0, 2], k[1, 2], *d], image_size)

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
    def parameters(self) -> Array:
        """(9,) values in the order of `PARAMETERS`."""
        return np.array([getattr(self, name) for name in PARAMETERS], dtype=np.float64)

    @property
    def K(self) -> Array:
        """(3, 3) OpenCV camera matrix."""
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], dtype=np.float64)

    @property
    def distortion(self) -> Array:
        """(5,) k1, k2, p1, p2, k3: OpenCV's `distCoeffs`."""
        return self.parameters[4:]

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
        """The same pinhole without distortion."""
        return replace(self, k1=0.0, k2=0.0, p1=0.0, p2=0.0, k3=0.0)

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
        )

    @cached_property
    def radius_limit(self) -> float:
        """Largest normalised radius up to which the radial model grows; inf if it always does.
        Beyond it the polynomial folds back, and points outside the view project into the image."""
        # d/dr of r(1 + k1 r^2 + k2 r^4 + k3 r^6) = 0, in w = 1/r^2: so 1 leads whatever k3 is.
        roots = np.roots([1.0, 3 * self.k1, 5 * self.k2, 7 * self.k3])
        real = roots[np.abs(roots.imag) <= 1e-9 * np.abs(roots)].real
        largest = max(real, default=0.0)
        return float(1 / np.sqrt(largest)) if largest > 1e-12 else float("inf")

    def distort(self, normalised: ArrayLike) -> Array:
        """Eq. (4): ideal to distorted normalised coordinates (..., 2)."""
        xy = np.asarray(normalised, dtype=np.float64)
        x, y = xy[..., 0], xy[..., 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        return np.stack(
            [
                x * radial + 2 * self.p1 * x * y + self.p2 * (r2 + 2 * x * x),
                y * radial + self.p1 * (r2 + 2 * y * y) + 2 * self.p2 * x * y,
            ],
            axis=-1,
        )

    def distorted_pixels(self, x: Array, y: Array) -> Array:
        """Eqs (4), (5): ideal normalised coordinates, each (...), to pixels (2, ...).
        Also beyond `radius_limit`, where the model folds back."""
        x2, y2, xy2 = x * x, y * y, 2 * x * y
        r2 = x2 + y2
        radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        pixels = np.empty((2, *x.shape))
        pixels[0] = self.fx * (x * radial + self.p1 * xy2 + self.p2 * (r2 + 2 * x2)) + self.cx
        pixels[1] = self.fy * (y * radial + self.p1 * (r2 + 2 * y2) + self.p2 * xy2) + self.cy
        return pixels

    def project(self, points: ArrayLike) -> Array:
        """Eq. (5): points (..., 3) in the camera's frame, metres, to pixels (..., 2).
        NaN for points at or behind the lens, and beyond `radius_limit`."""
        xyz = np.asarray(points, dtype=np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            xy = xyz[..., :2] / xyz[..., 2:]
            seen = (xyz[..., 2] > 0) & (np.hypot(xy[..., 0], xy[..., 1]) < self.radius_limit)
            pixels = self.distort(xy) * [self.fx, self.fy] + [self.cx, self.cy]
        return np.where(seen[..., None], pixels, np.nan)

    def unproject(self, pixels: ArrayLike) -> Array:
        """Pixels (..., 2) to ideal normalised coordinates (..., 2): the ray is (x, y, 1).
        Newton's method on eq. (4); NaN for a pixel that no ray reaches."""
        uv = np.asarray(pixels, dtype=np.float64)
        wanted = (uv - [self.cx, self.cy]) / [self.fx, self.fy]
        xy = wanted.copy()
        with np.errstate(all="ignore"):
            for _ in range(30):
                error = self.distort(xy) - wanted
                step = np.linalg.solve(_distortion_jacobian(self, xy), error[..., None])[..., 0]
                xy = xy - step
                if not np.nanmax(np.abs(step), initial=0.0) > 1e-15:
                    break
            good = (np.abs(self.distort(xy) - wanted).max(axis=-1) < 1e-9) & (
                np.hypot(xy[..., 0], xy[..., 1]) < self.radius_limit
            )
        return np.where(good[..., None], xy, np.nan)

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
            pixels (N, M, 2); by the nine `PARAMETERS` (N, M, 2, 9); by the pose (N, M, 2, 6).
            The pose is perturbed as `R <- exp(w) R, t <- t + v`: a rotation w (rad) about the
            camera's axes through the board's centre and a translation v (m).
        """
        J = self.jacobians(points, R, t)
        u = self.fx * J[:, 6, 0] + self.cx
        v = self.fy * J[:, 7, 1] + self.cy
        last = np.moveaxis(J, 1, -1).swapaxes(1, 2)
        return np.stack([u, v], axis=-1), last[..., 6:], last[..., :6]

    def jacobians(self, points: ArrayLike, R: ArrayLike, t: ArrayLike) -> Array:
        """The same derivatives as (N, 15, 2, M): six of the pose (w, v), nine of the intrinsics.
        Each of the 15 is contiguous, u of all points and then v: J J^T needs no copy."""
        rotations, positions = np.asarray(R, dtype=np.float64), np.asarray(t, dtype=np.float64)
        arm = rotations @ np.swapaxes(np.asarray(points, dtype=np.float64), -1, -2)
        iz = 1.0 / (arm[:, 2] + positions[:, 2, None])
        x, y = (arm[:, 0] + positions[:, 0, None]) * iz, (arm[:, 1] + positions[:, 1, None]) * iz
        x2, y2, xy = x * x, y * y, x * y
        r2 = x2 + y2
        r4 = r2 * r2
        r6 = r2 * r4
        radial = 1 + self.k1 * r2 + self.k2 * r4 + self.k3 * r6
        ax, ay, xy2 = r2 + 2 * x2, r2 + 2 * y2, 2 * xy
        J = np.empty((len(x), 15, 2, x.shape[1]))
        pose, intrinsic = J[:, :6], J[:, 6:]
        intrinsic[:, 0, 0] = x * radial + self.p1 * xy2 + self.p2 * ax
        intrinsic[:, 1, 1] = y * radial + self.p1 * ay + self.p2 * xy2
        intrinsic[:, 0, 1] = intrinsic[:, 1, 0] = intrinsic[:, 2, 1] = intrinsic[:, 3, 0] = 0.0
        intrinsic[:, 2, 0] = intrinsic[:, 3, 1] = 1.0
        # d(dx, dy) / d(x, y), then the chain over x = X/Z, y = Y/Z to the camera-frame point.
        slope = 2 * (self.k1 + r2 * (2 * self.k2 + 3 * self.k3 * r2))
        cross = slope * xy + 2 * (self.p1 * x + self.p2 * y)
        xx = radial + slope * x2 + 2 * self.p1 * y + 6 * self.p2 * x
        yy = radial + slope * y2 + 6 * self.p1 * y + 2 * self.p2 * x
        for row, (f, c, a, b, p1, p2) in enumerate(
            ((self.fx, x, xx, cross, xy2, ax), (self.fy, y, cross, yy, ay, xy2))
        ):
            fc, fz = f * c, f * iz
            for column, power in ((4, r2), (5, r4), (8, r6)):
                np.multiply(fc, power, out=intrinsic[:, column, row])
            np.multiply(f, p1, out=intrinsic[:, 6, row])
            np.multiply(f, p2, out=intrinsic[:, 7, row])
            gx, gy = fz * a, fz * b
            gz = -(gx * x + gy * y)
            pose[:, 3, row], pose[:, 4, row], pose[:, 5, row] = gx, gy, gz
            # d(exp(w) arm)/dw = -[arm]x, so the gradient by w is arm x g.
            np.subtract(arm[:, 1] * gz, arm[:, 2] * gy, out=pose[:, 0, row])
            np.subtract(arm[:, 2] * gx, arm[:, 0] * gz, out=pose[:, 1, row])
            np.subtract(arm[:, 0] * gy, arm[:, 1] * gx, out=pose[:, 2, row])
        return J


def planning_camera(camera: Camera) -> Camera:
    """The camera to plan with: without distortion if its estimate folds back within the image.

    From two or three views the high orders are nearly free. If the model folds back, no pose near
    the border seems possible, just where the next view is needed.
    """
    corners = camera.image_corners
    reach = np.linalg.norm((corners - [camera.cx, camera.cy]) / [camera.fx, camera.fy], axis=1)
    seen = np.isfinite(camera.unproject(corners)).all()
    if camera.radius_limit > 1.02 * reach.max() and seen:
        return camera
    return camera.without_distortion()


def _distortion_jacobian(camera: Camera, normalised: Array) -> Any:
    """d(distorted)/d(ideal), (..., 2, 2)."""
    x, y = normalised[..., 0], normalised[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3))
    slope = 2 * (camera.k1 + r2 * (2 * camera.k2 + 3 * camera.k3 * r2))
    cross = slope * x * y + 2 * (camera.p1 * x + camera.p2 * y)
    xx = radial + slope * x * x + 2 * camera.p1 * y + 6 * camera.p2 * x
    yy = radial + slope * y * y + 6 * camera.p1 * y + 2 * camera.p2 * x
    return np.stack([np.stack([xx, cross], -1), np.stack([cross, yy], -1)], -2)


PAPER_CAMERA = Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
"""The camera of the paper's simulation (4.1.2), its distortion read in OpenCV's order."""
