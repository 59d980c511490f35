"""Texts of exported files."""

from venus3d.languages.texts_module import speak

SHEET_REFUSED = "A person is not asked for this pose. {why}"
SHEET_START = (
    "From the upright board, {millimetres} mm in front of the camera. The turns are about the "
    "camera's axes."
)

STEPS_TITLE = "The four steps, as the camera sees them"
POSE_TITLE = "The pose in six numbers"
QUESTION = "A question"
RIGHT, WRONG = "Right.", "Not quite."
NOT_TURNED = "The board is not turned;"
TURNED = "The board is turned by {turns};"
TURNS = ("{amount}° about X (tilt)", "{amount}° about Y (swing)", "{amount}° about Z (rotation)")
PLACED = "its centre is {places}."
AHEAD = "straight ahead"
PLACES = (
    ("{amount} mm to the right", "{amount} mm to the left"),
    ("{amount} mm down", "{amount} mm up"),
)
AWAY = "{amount} mm away"
AND = " and "
TARGET_TITLE = "A pose in four steps"
TARGET_PAGE = "The pose"
TARGET_TEXT = "Six numbers say where the board is and how it is turned; four steps bring it there."
ALIKE, DIFFERENT = "=", "≠"  # on the badge of two boards
UPRIGHT = "An upright board"
UPRIGHT_WHERE = "Half a metre in front of the lens: from here, four steps lead to any pose."

speak(__name__)
