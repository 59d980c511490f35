"""Silences OpenCV's and FFmpeg's own messages; errors are reported by this program."""

from __future__ import annotations

import os

import cv2

_SILENT = 0


def silence_opencv() -> None:
    """Turn off OpenCV's and FFmpeg's messages for this process; cheap, call before each opening.
    A level set by the user in the environment is kept."""
    # FFmpeg reads its level from here when the first capture of the process is opened.
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    if "OPENCV_LOG_LEVEL" not in os.environ:
        # OpenCV 4 has it at the top.
        set_level = getattr(cv2, "setLogLevel", None) or cv2.utils.logging.setLogLevel
        set_level(_SILENT)
