"""Texts of the page on which lengths are measured."""

from typing import Literal

from venus3d.languages.texts_module import speak

Tool = Literal["length", "cube"]
TITLE = "Measure"
TOOL_LABEL = "Tool"
TOOLS: dict[Tool, str] = {"length": "Length", "cube": "Cube"}
TOOL_HINT = "Length: two clicks. Cube: one click, and a cube stands there on the board's plane."
CUBE_EDGE = "Edge (mm)"
ACTIONS_LABEL = "Picture"
CLEAR, HOLD = "Clear ⌫", "Hold ␣"
ACTIONS_HINT = "Clear takes the points away. Hold stops the picture, so that clicks are exact."
NO_BOARD = "Show the board: lengths are measured on its plane."
WRONG = (
    "The board is seen, but not as this camera would see it, so lengths would be wrong: its file "
    "is of another camera, zoom or focus, or the board is another one. Start again with the right "
    "--camera or --board."
)
FIRST = "Click the first point on the board's plane: on the board, or on what lies flat with it."
SECOND = "Click the second point."
AGAIN = "Click again to begin a new length."
CUBE = "Click where a corner of the cube shall stand."
HELD = "The picture is held."
LENGTH = "{length} ± {sigma} mm"
CHECK = (
    "Check it with a tape. The ± holds the click, the corners and the camera, not the board: were "
    "its squares {percent} % larger than given ({square} mm), every length would be {percent} % "
    "longer, and no picture of this board can show that. A ruler on the print can."
)
CHECK_WITHOUT_CAMERA = (
    "Check it with a tape. The ± holds the click and the corners, not the camera, whose "
    "uncertainty is not known here, and not the board: were its squares {percent} % larger than "
    "given ({square} mm), every length would be {percent} % longer, and no picture of this board "
    "can show that. A ruler on the print can."
)
CHECK_CUBE = (
    "Hold a real one beside it: its edges must be where these are drawn. A cube has no ±; that of "
    "its edge on the board is a length's: choose Length and click both ends."
)
MISSED = "That point is not on the board's plane."
CLEAR_COMMAND = "Take the points away"
CLEAR_COMMAND_HINT = "begins a new length"
HOLD_COMMAND = "Hold the picture"
HOLD_COMMAND_HINT = "stops the picture, or goes on; clicks on one that stands still are exact"
THEME_COMMAND = "Light or dark"
THEME_COMMAND_HINT = "changes the page's brightness"

speak(__name__)
