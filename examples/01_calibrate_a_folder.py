"""Calibrate a camera from a folder of pictures, and ask how far to trust the result.

python examples/01_calibrate_a_folder.py FOLDER [OUTPUT_FOLDER]
"""

import sys
from pathlib import Path

import venus3d


def main(folder: str, output: str = ".") -> None:
    # What the pictures show: squares along x and y, and their measured sides in metres.
    board = venus3d.Board(columns=9, rows=6, square=0.028, marker=0.021)
    calibration = venus3d.calibrate(folder, board)
    for view in calibration.views:
        print(f"{view.observation.name}: {view.observation.count} corners, {view.rms_px:.3f} px")

    named = calibration.camera.named
    for (name, value), sigma in zip(named.items(), calibration.sigma, strict=True):
        print(f"{name} = {value:.5g} ± {sigma:.2g}")
    # The rms says how well the model fits these pictures, the uncertainty how well the camera is
    # known: the error to expect of a projected point.
    print(f"rms {calibration.rms_px:.3f} px, uncertainty {calibration.uncertainty_px:.3f} px")
    for diagnosis in venus3d.diagnose(calibration):
        print(f"Doubtful: {diagnosis}")

    print(venus3d.write_camera_yaml(Path(output) / "camera.yaml", calibration))
    print(venus3d.write_result(Path(output) / "result.json", calibration))


if __name__ == "__main__":
    main(*sys.argv[1:])
