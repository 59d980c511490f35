"""Texts of the practice page."""

TITLE = "Practice"

HELP_NAMES = {
    "steps": "Four steps, one at a time",
    "axes": "Axes",
    "outline": "Outline",
    "none": "None: two pictures to compare",
}
SHORT_HELP_NAMES = {"steps": "steps", "axes": "axes", "outline": "outline", "none": "none"}
LEVEL_CHOICE = "{level} · {name}"
LEVEL_NAMES = {
    1: "one turn or one shift",
    2: "a turn and a shift",
    3: "three turns or three shifts",
    4: "three shifts and a turn",
    5: "three shifts and two turns",
    6: "everything",
}

HEADLINES = {
    "axes": "Lay the axes onto each other",
    "outline": "Bring the board onto the orange shape",
    "none": "Make the two pictures the same",
}
SENTENCES = {
    "axes": "Solid X Y Z: your board. Dashed X' Y' Z': the target.",
    "outline": "The spike marks the top edge of the target.",
    "none": "On the right: what the camera sees, and below it what it should see.",
}
HOW_TO = "To move it, drag the board in the scene, or use the keys or sliders under the picture."
ONLY_FREE = "Only this has to change: {names}."
ALL_FREE = "Where it stands and how it is turned: everything has to change."
FREE_NAMES = (
    "the turn about X (tilt)",
    "the turn about Y (swing)",
    "the turn about Z (rotate)",
    "right or left",
    "up or down",
    "the distance",
)
HOLD_HEADLINE = "Hold still"
HOLD_SENTENCE = "The board is there. Leave it alone for a second."
REACHED_HEADLINE = "Reached in {seconds:.1f} s"
REACHED_SENTENCE = "Press the space bar for the next pose."
DETOUR_SENTENCE = "Your way was {detour:.1f} times the shortest one."
STRAIGHT_SENTENCE = "You took the shortest way."
LEVEL_UP = "From now on level {level}: {name}."
GIVEN_UP_NOTE = "That one is given up; here is another."
STAYS = "That is right already on this level, and stays as it is."
TO_GO = "to go"

STEP_BARS = ("Move", "Tilt about X", "Swing about Y", "Rotate about Z")
PLACE_BAR, TURN_BAR = "Off its place", "Largest turn left"
RIGHT = "✓ right"
BARS_TITLE = "How far from the target"
BARS_LEGEND = "Make each bar so short that it ends within the green zone."

TIME, TIME_UNIT = "time", "s"
MOVED = "moved; shortest way: {shortest}"
TURNED = "turned; shortest way: {shortest}"

RESULTS_TITLE = "Your poses so far"
NO_RESULTS = "Each pose that you reach is listed here, with its time and its way."
RESULTS_HEAD = ("level", "help", "time", "way")
GAVE_UP = "given up"
RESULTS_SUM = "{reached} of {all} reached, median {median:.1f} s"
TIME_PLOT, WAY_PLOT = "seconds", "× shortest way"
POSE_AXIS = "pose"
WRITTEN = "Written to {path}"

PICTURE_TITLE = "What the camera sees"
TARGET_PICTURE_TITLE = "What it should see"
PICTURE_LEGENDS = {
    "steps": "Thick outline: where this step ends. Arrow: what to do.",
    "axes": "Solid: the board. Dashed: the target. X to the right, Y down, Z out of the back.",
    "outline": "Orange: the target. Blue: covered by the board.",
    "none": "Nothing is drawn into it: that is this help.",
}

LEVEL, HELP, NAME = "Level", "Help", "Your name"
LEVEL_HINT = "How many of the six numbers of the pose have to change. Keys 1 to 6."
HELP_HINT = "What is shown to you of the target. M takes the next kind."
NAME_HINT = "Optional. With a name you can continue after a reload and find your rows in the file."
AUTO_LEVEL = "Next level by itself"
AUTO_LEVEL_HINT = "After two poses in a row that you reached, the next level begins."
NEXT, NEXT_HINT = "Next pose (space bar)", "Go on to the next target once this one is reached."
POSE = "This pose"
POSE_ACTIONS = {"start_over": "Start over R", "give_up": "Give up G"}
POSE_HINT = (
    "Put the board back to the start, while the clock runs on; or leave this target for another "
    "one, which is written down."
)
VIEW = "View (V)"
VIEW_SIDES = {"outside": "From outside", "through": "Through camera"}
SHOWN_SIDE = "✓ {side}"
VIEW_HINT = (
    "From outside you see camera and board in space. Through the camera you see its picture, and "
    "drag the board in it."
)
SLIDERS = "Move the board with sliders"
KEYS_TITLE = "Keys and mouse"

MOVE_KEYS = (
    ("J", "L", "left, right", "swing to the left, to the right"),
    ("I", "K", "up, down", "tilt backwards, forwards"),
    ("U", "O", "nearer, farther", "rotate left, right"),
)
"""Two keys, what they do alone, and with Shift."""
KEYS_HEAD = ("alone", "with Shift")
MOUSE_LINES = (
    ("drag", "move the board, in any view"),
    ("Shift + drag", "tilt and swing it"),
    ("Ctrl + drag", "rotate it"),
    ("right button", "drag up or down: farther, nearer"),
    ("drag beside it", "turn the view; V puts it back"),
)
OTHER_KEYS = (
    ("Space", "next pose"),
    ("G", "give up"),
    ("R", "start over"),
    ("V", "view"),
    ("M", "other help"),
    ("1–6", "level"),
    ("B", "light or dark"),
    ("H", "all keys"),
)
COMMANDS = {
    "next": ("Next pose", "Go on once this one is reached"),
    "give_up": ("Give up this pose", "Take another target"),
    "start_over": ("Start over", "Put the board back to the start"),
    "view": ("Other view", "From outside, or through the camera"),
    "help": ("Other help", "Steps, axes, outline, none"),
    "theme": ("Light or dark", "Change the brightness of the page"),
    "level": ("Level {level}", "{name}"),
    "nudge": ("Move the board: {what}", "A little; hold the key for more"),
}
NUDGES = (
    "tilt forwards",
    "tilt backwards",
    "swing to the left",
    "swing to the right",
    "rotate right",
    "rotate left",
    "right",
    "left",
    "down",
    "up",
    "farther",
    "nearer",
)
GUEST = "guest {number}"
TARGET_LABEL = "Target"
