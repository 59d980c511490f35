"""Texts in the scene and in pictures, and notes on the renderer in use."""

from venus3d.engine.sentences import Sentence
from venus3d.languages.texts_module import speak

STEP_TITLES = ("Move", "Tilt about X", "Swing about Y", "Rotate about Z")
STEP_SHORT_TITLES = ("Move", "Tilt", "Swing", "Rotate")
TARGET_LABEL = "Target"
# On the board's back, for whoever holds it.
TOP, LEFT, RIGHT = "TOP", "LEFT", "RIGHT"
DONE = "✓ done"
ONE_CORNER_OUTSIDE = "1 corner outside"
CORNERS_OUTSIDE = "{count} corners outside"
NO_OPENGL = Sentence(
    "OpenGL cannot be used here, so OpenCV paints the pictures; install libegl1, libgl1 and "
    "libgl1-mesa-dri ({cause})."
)
OPENGL_FAILED = Sentence(
    "OpenGL failed while it drew, so OpenCV paints the pictures from now on ({cause})."
)

speak(__name__)
