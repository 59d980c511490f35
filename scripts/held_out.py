"""How well the corners of pictures held out are predicted, by plain OpenCV and by venus3d.

The pictures are cut at random into thirds, six times. Each third's corners are compared with the
camera that the other two give, with only their poses fitted; each program is judged by its own
corners. A third, not a half: six or seven views leave the third radial coefficient open.

    python scripts/held_out.py FOLDER --kind chessboard --columns 10 --rows 7 --square-mm 25

Plain OpenCV is `CharucoDetector`, or `findChessboardCorners` with `cornerSubPix` (`--plain sb`:
`findChessboardCornersSB`), and then `cv2.calibrateCamera`, or `cv2.fisheye.calibrate` where venus3d
finds a fisheye. venus3d is `venus3d.calibrate` with the lens found, the board's bow included.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

import venus3d
from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.observation import reprojection_errors
from venus3d.engine.geometry.pose import Array

_CUTS, _PARTS = 6, 3
_FISHEYE = cv2.CALIB_RECOMPUTE_EXTRINSIC | cv2.CALIB_FIX_SKEW
View = tuple[Array, Array]
"""(N, 3) points on the board in metres, and where they are in the picture, (N, 2) px."""


def seen_by_opencv(board: venus3d.Board, picture: NDArray[np.uint8], plain: str) -> View | None:
    if board.kind == "charuco":
        corners, ids, _, _ = cv2.aruco.CharucoDetector(board.cv_board).detectBoard(picture)
        if ids is None or len(ids) < 6:
            return None
        return board.points_of(ids.ravel()), np.asarray(corners, float).reshape(-1, 2)
    size = (board.columns - 1, board.rows - 1)
    if plain == "sb":
        found, corners = cv2.findChessboardCornersSB(picture, size)
    else:
        found, corners = cv2.findChessboardCorners(picture, size)
        if found:
            corners = cv2.cornerSubPix(picture, corners, (5, 5), (-1, -1), (3, 40, 1e-3))
    if not found:
        return None
    points = board.points_of(np.arange(size[0] * size[1]))
    return points, np.asarray(corners, float).reshape(-1, 2)


class PlainOpenCV:
    def __init__(self, views: Sequence[View], size: tuple[int, int], fisheye: bool) -> None:
        self.fisheye = fisheye
        points = [view[0].astype(np.float32)[None] for view in views]
        pixels = [view[1].astype(np.float32)[None] for view in views]
        if fisheye:
            start = np.array(
                [[size[0] / 3, 0, size[0] / 2], [0, size[0] / 3, size[1] / 2], [0, 0, 1]]
            )
            flags = _FISHEYE | cv2.CALIB_USE_INTRINSIC_GUESS
            found = cv2.fisheye.calibrate(points, pixels, size, start, np.zeros(4), flags=flags)
        else:
            found = cv2.calibrateCamera(points, pixels, size, None, None)  # type: ignore[call-overload]
        self.rms_px, self.K, self.distortion = found[:3]

    def errors(self, view: View) -> Array:
        """(N, 2) of a view whose pose is fitted."""
        points, pixels = view
        undistorted = (cv2.fisheye if self.fisheye else cv2).undistortPoints(
            pixels[:, None], self.K, self.distortion
        )
        _, turn, place = cv2.solvePnP(points, undistorted, np.eye(3), np.zeros(4))

        def off(pose: Array) -> Array:
            project = cv2.fisheye.projectPoints if self.fisheye else cv2.projectPoints
            shown = project(points[:, None], pose[:3], pose[3:], self.K, self.distortion)[0]
            return (shown.reshape(-1, 2) - pixels).ravel()

        return least_squares(off, np.concatenate([turn.ravel(), place.ravel()])).fun.reshape(-1, 2)


def rms(errors: Sequence[Array]) -> float:
    """Of distances, pixels."""
    return float(np.sqrt((np.concatenate(errors) ** 2).sum(axis=1).mean()))


def main() -> None:
    parser = argparse.ArgumentParser(description="Corners held out, by plain OpenCV and by venus3d")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kind", default="charuco", choices=("charuco", "chessboard"))
    parser.add_argument("--columns", type=int, required=True)
    parser.add_argument("--rows", type=int, required=True)
    parser.add_argument("--square-mm", type=float, required=True)
    parser.add_argument("--marker-mm", type=float, default=0.0)
    parser.add_argument("--dictionary", default="DICT_4X4_1000")
    parser.add_argument("--plain", default="subpix", choices=("subpix", "sb"))
    given = parser.parse_args()
    marker = (given.marker_mm or 0.7 * given.square_mm) / 1000
    board = venus3d.Board(
        given.columns, given.rows, given.square_mm / 1000, marker, given.dictionary, kind=given.kind
    )
    detector = venus3d.Detector(board)
    pictures = [
        cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in sorted(given.folder.iterdir())
    ]
    ours: list[venus3d.Observation] = []
    theirs: list[View] = []
    for picture in pictures:
        if picture is None:
            continue
        grey = np.asarray(picture, np.uint8)
        observation, view = detector.detect(grey), seen_by_opencv(board, grey, given.plain)
        if observation.count >= 6 and view is not None:
            ours.append(observation)
            theirs.append(view)
    whole = venus3d.calibrate(ours, board)
    lens, size = whole.camera.lens, ours[0].image_size
    fisheye = not lens.is_perspective
    plain_whole = PlainOpenCV(theirs, size, fisheye)
    print(f"{len(ours)} pictures, {lens.name}; rms and fx of all:")
    print(f"plain OpenCV {plain_whole.rms_px:.4f} px, {plain_whole.K[0, 0]:.2f}")
    print(f"venus3d      {whole.rms_px:.4f} px, {whole.camera.fx:.2f}")
    found: list[tuple[float, float]] = []
    for cut in range(_CUTS):
        order = np.random.default_rng([0, cut]).permutation(len(ours))
        for asked in np.array_split(order, _PARTS):
            known = np.setdiff1d(order, asked)
            plain = PlainOpenCV([theirs[i] for i in known], size, fisheye)
            calibration = venus3d.calibrate([ours[i] for i in known], board, lens=lens.name)
            errors: list[Array] = []
            for seen in (ours[i] for i in asked):
                pose = estimate_pose(calibration.camera, calibration.board, seen)
                assert pose is not None, "a view that calibrates has a pose"
                errors.append(
                    reprojection_errors(calibration.camera, calibration.board, seen, pose)
                )
            found.append((rms([plain.errors(theirs[i]) for i in asked]), rms(errors)))
    plain_px, ours_px = np.array(found).T
    print(f"held out, median of {len(found)}:")
    print(f"plain OpenCV {np.median(plain_px):.4f} px")
    print(f"venus3d      {np.median(ours_px):.4f} px, better in {(ours_px < plain_px).sum()}")


if __name__ == "__main__":
    main()
