"""Names of a pose's six numbers, and words for changing them."""

from venus3d.languages.texts_module import speak

POSE_LABELS = (
    "Turn about X (°)",
    "Turn about Y (°)",
    "Turn about Z (°)",
    "Right (mm)",
    "Down (mm)",
    "Distance (mm)",
)
POSE_HINTS = (
    "Positive: the top edge comes towards the camera.",
    "Positive: the edge on the picture's right comes towards the camera.",
    "Positive: clockwise in the picture.",
    "How far the board's centre is to the right of the optical axis, in the picture.",
    "How far the board's centre is below the optical axis, in the picture.",
    "How far the board's centre is in front of the lens.",
)
NUDGES = {
    (0, 1): "top edge nearer",
    (0, -1): "bottom edge nearer",
    (1, 1): "right edge nearer",
    (1, -1): "left edge nearer",
    (2, 1): "clockwise",
    (2, -1): "counter-clockwise",
    (3, 1): "right",
    (3, -1): "left",
    (4, 1): "down",
    (4, -1): "up",
    (5, 1): "farther",
    (5, -1): "nearer",
}
"""A small change of each number, positive and negative, as seen in the picture."""
BOARD_COMMAND = "Move the board: {what}"
BOARD_COMMAND_HINT = "A little; hold the key for more"
BOARD_KEYS_HEAD = ("alone", "with Shift")

speak(__name__)
