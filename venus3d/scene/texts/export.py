"""What exported files say."""

MADE_WITH = "Made with venus3d"
SHEET_POSE = (
    "Turned {xr}° about X, {yr}° about Y, {zr}° about Z.  "
    "Centre {xt} mm right, {yt} mm down, {zt} mm away."
)
SHEET_START = (
    "From the upright board, {millimetres} mm in front of the camera. The turns are about the "
    "camera's axes."
)
SHEET_HOLDER = "With the board in your hands: {words}"

LESSON_LABEL = "Lesson"
PAGE_OF = "Page {page} of {pages}"
BACK, ON = "Back", "Next page"
STEPS_TITLE = "The four steps, as the camera sees them"
SCENE_TITLE = "The way there"
SCENE_HINT = (
    "Play, stop and go back and forth with the bar below the scene; turn it with the mouse."
)
STEP_ALT = "Step {number}: {words}"
QUESTION = "A question"
RIGHT, WRONG = "Right.", "Not quite."
POSE = "The pose: {xr} {yr} {zr}° turned, {xt} {yt} {zt} mm"
NO_SCRIPT = "This page needs JavaScript for its moving scene; the pictures show the steps without."
TARGET_TITLE = "A pose in four steps"
TARGET_PAGE = "The pose"
TARGET_TEXT = "Six numbers say where the board is and how it is turned; four steps bring it there."
