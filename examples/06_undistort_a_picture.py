"""Read a result and undistort a picture with it.

python examples/06_undistort_a_picture.py RESULT.JSON PICTURE [UNDISTORTED]
"""

import sys

import cv2

import venus3d


def main(result: str, picture: str, undistorted: str = "undistorted.png") -> None:
    calibration = venus3d.read_result(result).calibration
    camera = calibration.camera
    print(f"{len(calibration.views)} views, rms {calibration.rms_px:.3f} px")
    print(f"uncertainty {calibration.uncertainty_px:.3f} px")

    image = cv2.imread(picture)
    if image is None or image.shape[1::-1] != camera.image_size:
        sys.exit(f"{picture} is no picture of {camera.width} x {camera.height} px.")
    if camera.lens.is_perspective:
        straight = cv2.undistort(image, camera.K, camera.distortion)
    else:
        straight = cv2.fisheye.undistortImage(image, camera.K, camera.distortion, Knew=camera.K)
    cv2.imwrite(undistorted, straight)
    print(undistorted)


if __name__ == "__main__":
    main(*sys.argv[1:])
