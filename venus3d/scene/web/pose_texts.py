"""Names and hints of a pose's six numbers."""

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
