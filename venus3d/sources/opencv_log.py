"""Keeps OpenCV's and FFmpeg's own messages off the screen: what went wrong is our sentence."""

from __future__ import annotations

import os

import cv2


def silence_opencv() -> None:
    """Turn off OpenCV's and FFmpeg's messages for this process; cheap, call before each opening.

    A level that the user chose in the environment is left alone.
    """
    # FFmpeg's level is read from here when the first capture of the process is opened.
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    if "OPENCV_LOG_LEVEL" not in os.environ:
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
