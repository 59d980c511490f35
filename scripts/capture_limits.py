"""Measures what the capture gate's limits rest on (docs/operations.md, "What is captured"): the
error of the corners in simulated pictures that are too dark, too bright, blurred or glared at, and
what a rolling shutter does to the focal length.

    python scripts/capture_limits.py
"""

from __future__ import annotations

import cv2
import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.picture_quality import picture_quality
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.sim import Simulation

BOARD, CAMERA = Board(), PAPER_CAMERA


def poses(count: int, rng: np.random.Generator) -> list[Pose]:
    found: list[Pose] = []
    while len(found) < count:
        pose = Pose.from_vector(
            [
                *rng.uniform(-40, 40, 2),
                rng.uniform(-30, 30),
                *rng.uniform(-0.12, 0.12, 2),
                rng.uniform(0.35, 0.7),
            ]
        )
        pixels = CAMERA.project(pose.apply(BOARD.outline))
        if np.all((pixels > 20) & (pixels < np.array(CAMERA.image_size) - 20)):
            found.append(pose)
    return found


def picture(source: Simulation, pose: Pose) -> np.ndarray:
    source.move_to(pose)
    frame = source.read()
    assert frame is not None
    return frame.image


def developed(clean: np.ndarray, gain: float, blur: float, rng: np.random.Generator) -> np.ndarray:
    light = cv2.GaussianBlur(clean, (0, 0), blur).astype(np.float32) * gain
    return np.clip(light + rng.normal(0, 4, clean.shape), 0, 255).astype(np.uint8)


def moved(clean: np.ndarray, length: float, angle: float) -> np.ndarray:
    """Motion blur of this length in pixels."""
    steps = max(2, round(4 * length))
    total = np.zeros(clean.shape, np.float32)
    for share in np.linspace(-0.5, 0.5, steps):
        shift = np.array(
            [[1, 0, share * length * np.cos(angle)], [0, 1, share * length * np.sin(angle)]]
        )
        total += cv2.warpAffine(clean, shift, CAMERA.image_size, borderMode=cv2.BORDER_REPLICATE)
    return (total / steps).astype(np.uint8)


def glared(picture: np.ndarray, place: np.ndarray, radius: float, strength: float) -> np.ndarray:
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]]
    spot = np.exp(-((((x - place[0]) ** 2 + (y - place[1]) ** 2) / (2 * radius**2)) ** 2))
    return np.clip(picture + strength * spot[..., None], 0, 255).astype(np.uint8)


def row(name: str, pictures: list[np.ndarray], where: list[Pose]) -> None:
    errors: list[float] = []
    found, figures = 0, []
    for image, pose in zip(pictures, where, strict=True):
        seen = Detector(BOARD, find_layout=False).detect(image)
        found += seen.count
        if not seen.count:
            continue
        truth = CAMERA.project(pose.apply(BOARD.points_of(seen.ids)))
        errors.extend(np.sum((seen.corners - truth) ** 2, axis=1))
        quality = picture_quality(image, BOARD, seen)
        figures.append((quality.black, quality.white, quality.washed_out, seen.sharpness))
    black, white, washed, sharp = np.median(figures, axis=0) if figures else (np.nan,) * 4
    rms = np.sqrt(np.mean(errors)) if errors else np.nan
    share = found / len(where) / BOARD.corner_count
    print(
        f"{name:>20}: error {rms:.3f} px, {share:4.0%} found, white {white:3.0f}, "
        f"contrast {white - black:3.0f}, washed out {washed:.2f}, sharpness {sharp:.3f}",
        flush=True,
    )


def rolling_shutter(rng: np.random.Generator) -> None:
    for speed in (0.0, 0.25, 0.5, 1.0, 2.0, 4.0):
        errors, sigmas, rms = [], [], []
        for _ in range(24):
            views: list[Observation] = []
            for pose in poses(12, rng):
                corners = CAMERA.project(pose.apply(BOARD.corners))
                # A row is read this share of a frame's time after the picture's middle.
                late = (corners[:, 1] / CAMERA.height - 0.5)[:, None]
                direction = rng.normal(size=3)
                direction /= np.linalg.norm(direction[:2])
                metres = speed * pose.t[2] / CAMERA.fx
                shifted = CAMERA.project(pose.apply(BOARD.corners) + late * metres * direction)
                views.append(
                    Observation(
                        np.arange(BOARD.corner_count),
                        shifted + rng.normal(0, 0.05, corners.shape),
                        CAMERA.image_size,
                    )
                )
            known = calibrate(BOARD, views)
            errors.append(known.camera.fx - CAMERA.fx)
            sigmas.append(known.sigma[0])
            rms.append(known.rms_px)
        off = np.sqrt(np.mean(np.square(errors)))
        print(
            f"rolling shutter, {speed} px per frame: fx off by {off:.2f} px, said "
            f"{np.mean(sigmas):.2f}, rms {np.mean(rms):.3f}",
            flush=True,
        )


def main() -> None:
    rng = np.random.default_rng(0)
    where = poses(16, rng)
    source = Simulation(CAMERA, BOARD, noise_sigma=0, blur_sigma=0.4, autopilot=False)
    clean = [picture(source, pose) for pose in where]
    source.close()
    for gain in (1.0, 0.5, 0.25, 0.2, 0.15, 0.1, 0.07, 0.05, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0):
        row(f"light x {gain}", [developed(one, gain, 0.7, rng) for one in clean], where)
    for blur in (0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0):
        row(f"out of focus, {blur} px", [developed(one, 1.0, blur, rng) for one in clean], where)
    for length in (0.5, 1, 2, 3, 4, 6, 8, 12):
        blurred = [moved(one, length, rng.uniform(0, np.pi)) for one in clean]
        row(f"moving, {length} px", [developed(one, 1.0, 0.7, rng) for one in blurred], where)
    for strength in (0, 60, 120, 180, 240, 320):
        spots = []
        for one, pose in zip(clean, where, strict=True):
            corner = CAMERA.project(pose.apply(BOARD.corners))[rng.integers(BOARD.corner_count)]
            spots.append(
                developed(
                    glared(one, corner + rng.uniform(-10, 10, 2), 60, strength), 1.0, 0.7, rng
                )
            )
        row(f"glare, + {strength}", spots, where)
    rolling_shutter(rng)


if __name__ == "__main__":
    main()
