"""Texts of practice and trial."""

from venus3d.engine.sentences import Sentence
from venus3d.languages.texts_module import speak

PRACTICE, TRIAL = "Practice", "Trial"
HOLD_STILL = "Hold still"
POSE = "pose"
WRITTEN = "Written to {path}"
THEME_COMMAND = ("Light or dark", "Change the brightness of the page")

# Practice.

PRACTICE_HELP_NAMES = {
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
HOLD_SENTENCE = "The board is there. Leave it alone for a second."
REACHED_HEADLINE = "Reached in {seconds:.1f} s"
REACHED_SENTENCE = "Press the space bar for the next pose."
DETOUR_SENTENCE = "Your way was {detour:.1f} times the shortest one."
STRAIGHT_SENTENCE = "You took the shortest way."
LEVEL_UP = "From now on level {level}: {name}."
GIVEN_UP_NOTE = "That one is given up; here is another."
DRAGGED = "This drag: {changes}."
CHANGES = (
    "turn about X {amount}°",
    "turn about Y {amount}°",
    "turn about Z {amount}°",
    "right {amount} mm",
    "down {amount} mm",
    "distance {amount} mm",
)
STAYS = "That is right already on this level, and stays as it is."
TO_GO = "to go"

STEP_BARS = ("Move", "Tilt about X", "Swing about Y", "Rotate about Z")
PLACE_BAR, TURN_BAR = "Off its place", "Largest turn left"
DONE_MARK = "✓ done"
BARS_TITLE = "How far from the target"
BARS_LEGEND = "Make each bar end before its mark; then it is green."

TIME, TIME_UNIT = "time", "s"
MOVED = "moved, at least {shortest}"
TURNED = "turned, at least {shortest}"

RESULTS_TITLE = "Your poses so far"
NO_RESULTS = "Each pose that you reach is listed here, with its time and its way."
RESULTS_HEAD = ("level", "help", "time", "way")
GAVE_UP = "given up"
RESULTS_SUM = "{reached} of {all} reached, median {median:.1f} s"
TIME_PLOT, WAY_PLOT = "seconds", "× shortest way"

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
HELP_HINT = "What is shown to you of the target. Shift+H takes the next kind."
NAME_HINT = "Optional. With a name you can continue after a reload and find your rows in the file."
AUTO_LEVEL = "Next level by itself"
AUTO_LEVEL_HINT = "After two poses in a row that you reached, the next level begins."
NEXT, NEXT_HINT = "Next pose (space bar)", "Go on to the next target once this one is reached."
POSE_ROW = "This pose"
POSE_ACTIONS = {"start_over": "Start over R", "give_up": "Give up G"}
POSE_HINT = (
    "Put the board back to the start, while the clock runs on; or leave this target for another "
    "one, which is written down."
)
VIEW = "View (V)"
VIEW_SIDES = {"outside": "Outside", "through": "Camera"}
VIEW_HINT = (
    "From outside you see camera and board in space. Through the camera you see its picture, and "
    "drag the board in it."
)
SLIDERS = "Move the board with sliders"
KEYS_TITLE = "Keys and mouse"

MOUSE_LINES = (
    ("drag", "move it in the plane that you see"),
    ("Shift + drag", "turn it like a ball"),
    ("Ctrl + drag", "rotate it round its centre"),
    ("right button", "drag up or down: farther, nearer"),
    ("drag beside it", "turn the view; V puts it back"),
)
OTHER_KEYS = (
    ("Space", "next pose"),
    ("G", "give up"),
    ("R", "start over"),
    ("V", "view"),
    ("⇧B", "figure"),
    ("⇧H", "other help"),
    ("1–6", "level"),
    ("B", "light or dark"),
    ("H", "all keys"),
)
PRACTICE_COMMANDS = {
    "next": ("Next pose", "Go on once this one is reached"),
    "give_up": ("Give up this pose", "Take another target"),
    "start_over": ("Start over", "Put the board back to the start"),
    "view": ("Other view", "From outside, or through the camera"),
    "surroundings": ("Floor and figure", "Show or hide the floor and who holds the board"),
    "help": ("Other help", "Steps, axes, outline, none"),
    "theme": THEME_COMMAND,
    "level": ("Level {level}", "{name}"),
}
GUEST = "guest {number}"
TARGET_LABEL = "Target"

# Trial.
GUIDANCE_TAB = "What to do now"
START, START_HINT = (
    "Start (space bar)",
    "Show the first pose. The clock counts from when it has been reached.",
)
GIVE_UP, GIVE_UP_HINT = (
    "Give up this pose (G)",
    "Go on to the next pose; it is written as given up.",
)
TRIAL_COMMANDS = {
    "next": ("Start", "Show the first pose"),
    "give_up": ("Give up this pose", "Go on to the next"),
    "theme": THEME_COMMAND,
    "autopilot": ("Autopilot", "Let the simulated hand move the board, or take it yourself"),
}
# A sentence: it is said once, for tabs in any language.
DRAG_HINT = Sentence(
    "Drag the board by its handles in the scene, or press Shift+P for the simulated hand."
)

TRIAL_HELP_NAMES = {"steps": "the four steps", "axes": "the axes", "outline": "the filled outline"}
HOW = {
    "steps": "Do what the large text says, one step at a time: move the board, then turn it.",
    "axes": "Bring the board's axes (solid) onto the target's (dashed): X onto X', Y onto Y', "
    "Z onto Z'.",
    "outline": "Cover the orange shape with the board until all of it is blue. The spike marks the "
    "top edge.",
}
STARTING, WAITING = "Starting", "Waiting for the first picture."
DONE, DONE_SENTENCE = "Done, thank you", "How long each help took:"
ALL_DONE = "All done, thank you"
HELP_OF = "Help {place} of {helps}: {name}"
ORDER_TITLE = "Order of the helps"
NEXT_HELP = "Next: {name}. Press Start when ready."
NOT_SEEN = "Board not seen"
POSE_OF = "Pose {pose} of {poses}"
OF_POSES = "of {poses}"
SINCE_START, SINCE_FIRST = "since the start", "since the first pose"
AXES_LEGEND = (
    ("Solid X Y Z", "the board"),
    ("dashed X' Y' Z'", "the target"),
)
AXES_MEANING = "X to the right, Y down, Z out of the back"
OUTLINE_LEGEND = ("the target", "covered", "the board")
TIMES_HEAD = ("help", "median of a pose", "all poses after the first", "given up")
SECONDS_SINCE = "seconds since the first pose"

speak(__name__)
