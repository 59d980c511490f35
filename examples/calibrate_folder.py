"""Calibrate from a folder of pictures and ask how good the result is.

python examples/calibrate_folder.py FOLDER [COLUMNS ROWS SQUARE_MM MARKER_MM DICTIONARY]
"""

from __future__ import annotations

import sys

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PARAMETERS
from venus3d.engine.planning.costs import projection_uncertainty_px
from venus3d.sources.open_source import open_source


def main(folder: str, *board_arguments: str) -> None:
    board = Board()
    if board_arguments:
        columns, rows, square_mm, marker_mm, dictionary = board_arguments
        board = Board(
            int(columns), int(rows), float(square_mm) / 1000, float(marker_mm) / 1000, dictionary
        )

    detector = Detector(board)
    source = open_source(folder)
    observations = []
    while (frame := source.read()) is not None:
        observation = detector.detect(frame.image, name=frame.name)
        print(f"{observation.name}: {observation.count} corners")
        if observation.count:
            observations.append(observation)

    result = calibrate(detector.board, observations)
    for name, value, sigma in zip(PARAMETERS, result.camera.parameters, result.sigma, strict=True):
        print(f"{name} = {value:.5g} ± {sigma:.2g}")
    # The rms says how well the model fits these views; this says how well the camera is known.
    error = projection_uncertainty_px(result.camera, result.covariance)
    print(f"rms {result.rms_px:.3f} px; expected error of a projected point {error:.3f} px")
    for diagnosis in diagnose(result):
        print(diagnosis)


if __name__ == "__main__":
    main(*sys.argv[1:])
