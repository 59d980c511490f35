"""Texts of the guided calibration's page."""

from venus3d.engine.calibration.diagnosis import DiagnosisKind
from venus3d.engine.guidance.loop import LoopPart
from venus3d.engine.planning.settings import Cost, Method
from venus3d.engine.sentences import Sentence
from venus3d.languages.texts_module import speak

# -- what to do now --------------------------------------------------------------------------------

GUIDANCE_TAB = "What to do now"
STARTING, STARTING_SENTENCE = "Starting", "Waiting for the first picture."
SHOW_BOARD = "Show me the whole board"
CONVERGED = FINISHED = "Done"
CONVERGED_NEXT = "Go on asks for more views."
TAKEN_BACK = "Taken back"
TAKEN_BACK_SENTENCE = (
    "Move the board away from here: only then is this pose captured again. C captures it now."
)
CAPTURE_ANYWAY = "Captured by itself once this is mended; C captures it as it is."
DOUBTFUL = "Settled, but do not trust it yet"
DOUBTED_NEXT = "The reason stands below. Go on asks for more views."
PAUSED, PAUSED_SENTENCE = "Paused", "Press Go on, or the space bar."
PICTURES_PAUSED = "The pictures are paused; the space bar lets them go on."
NO_PICTURES = "No new pictures"
NO_PICTURES_YET = "None since {since}. The program waits for the next one."
NO_PICTURES_WAIT = "None since {since}. The source is opened again in {wait} s (try {number})."
NO_PICTURES_TRY = "None since {since}. The source is being opened again (try {number})."
NO_PICTURES_END = (
    "None since {since}, so the program has ended. Start it again on this port, and this page goes "
    "on by itself."
)
NO_PICTURES_CURE = (
    "What was captured is kept. Look at the camera's cable, or at what sends the stream."
)
SOURCE_REMARK = "What is to be known of the source's pictures is printed in the terminal."
FLOW = (
    "{came:.0f} pictures/s come, {searched:.0f} are searched, {sent:.0f} are sent, {age:.0f} ms "
    "old. Of {all} so far {skipped:.0%} were not searched and {damaged} were damaged."
)
OTHER_SIZE = "Another picture size"
OTHER_SIZE_SENTENCE = "The pictures are now {now} px, not {was}."
OTHER_SIZE_CURE = (
    "That is another camera to calibrate. Set the source back and this goes on by itself, or begin "
    "a new session. The views so far are kept."
)
ANOTHER_BOARD = "This is another board"
LOOKING_ELSEWHERE = (
    "You are looking at step {shown}; the board is on step {active}. Press F to go there."
)

# -- the end ---------------------------------------------------------------------------------------

END_QUESTION = "End now?"
END_WITHOUT_RESULT = "The camera is not known yet: there would be no result."
ENDED, ENDED_WITHOUT_RESULT = "Ended", "There is no result: no view was captured."
UNSETTLED = "Ended before it settled"
UNSETTLED_NEXT = "Go on keeps all views and asks for more."
NOT_SETTLED = "Not settled yet: {names}."
ALL_SETTLED = "Every parameter has settled."
FOCAL = "fx {value} ± {sigma} px, from {views}."
FROM_VIEW, FROM_VIEWS = "one view", "{count} views"
FROM_SOME_VIEWS = "{count} of {all} views"
END_NOW, GO_ON, NEW_SESSION = "End now", "Go on", "New session"
RESULT_TITLE = "The camera"
RESULT_HINT = "Each value with its uncertainty (one standard deviation)."
HELD = "held fixed"
MEASURE = "Measure"
MEASURE_HINT = (
    "Another tab: two clicks in the live picture are a length on the board, to be checked with a "
    "tape"
)
RESULT_LINE = "From <b>{views}</b>, rms <b>{rms}</b> px, uncertainty <b>{error}</b> px"
FIELD_OF_VIEW = (
    "Field of view: <b>{wide:.1f}°</b> horizontal, <b>{high:.1f}°</b> vertical, "
    "<b>{across:.1f}°</b> diagonal"
)
FIELD_OF_VIEW_HINT = "From edge to edge and from corner to corner, through the lens as it is."
COPY_ONE = "Copy {name} in full"
COPY_PYTHON = ("Copy for Python", "The camera matrix and the distortion as OpenCV takes them")
PYTHON = "K = np.array({matrix})\ndistortion = np.array({lens})\n"
COPY_TABLE = ("Copy as a table", "Names, values and uncertainties, for a spreadsheet")
COMPARED = "Undistorted"
COMPARED_HINT = (
    "Left of the line the picture is shown without the lens's distortion, right of it as it comes."
)

# -- controls --------------------------------------------------------------------------------------

CAPTURE = "Capture this view (C)"
CAPTURE_HINT = (
    "Take the picture as it is now. It is also taken by itself when the board is where it should "
    "be and still."
)
ROWS = {
    "view": (
        "View",
        "Ask for another target; take back the last view; end the calibration and keep it.",
    ),
    "step": ("Step", "Look at each of the four steps, one by one or as an animation."),
    "show": (
        "Show",
        "Follow the step that the board is on; spread the steps out; a light or a dark page.",
    ),
    "run": (
        "Picture",
        "Stop taking pictures and go on; show them without the lens's distortion once it is known.",
    ),
    "end": ("Then", "End and keep the result; go on with all views; begin without any."),
    "explain": (
        "Explain",
        "Left and right of whoever holds the board, or of the camera's picture; the same pose, "
        "built step by step from an upright board; the method's loop in a line above the page, "
        "with what goes on now and how long it takes.",
    ),
    "page": (
        "Page",
        "The keys and what they do; what stands where on this page; the whole scene, after you "
        "have turned it.",
    ),
}
"""Label of a row of buttons, and its hint."""
AUTOPILOT_HINT = " Autopilot lets a simulated hand move the board."
BUTTONS: dict[str, tuple[str, ...]] = {
    "skip": ("Skip G",),
    "undo": ("Undo ⌫",),
    "finish": ("Finish",),
    "previous": ("Back P",),
    "play": ("Play ⇧␣", "Stop ⇧␣"),
    "next": ("Next N",),
    "follow": ("Follow F",),
    "strip": ("Spread T",),
    "theme": ("Light B", "Dark B"),
    "words": ("The camera's X", "The holder's X"),
    "built": ("The pose",),
    "pause": ("Pause ␣", "Go on ␣"),
    "straight": ("Straight ⇧F",),
    "autopilot": ("Autopilot ⇧P",),
    "explain": ("The loop 9",),
    "help": ("Keys H",),
    "tour": ("Tour",),
    "fit": ("Fit Home",),
}
"""Labels of a button; of two, the second while it is on."""
COMMANDS: dict[str, tuple[str, str]] = {
    "capture": ("Capture this view", "Take the picture as it is now"),
    "skip": ("Skip this target", "Ask for another pose"),
    "undo": ("Undo the last view", "Take back what was captured last"),
    "previous": ("Previous step", "Show the step before"),
    "next": ("Next step", "Show the step after"),
    "play": ("Play the steps", "Show the four steps as an animation, or stop it"),
    "strip": ("Steps side by side", "Spread the four steps out, or put them back"),
    "all_steps": (
        "Show all steps",
        "Where each of the four steps ends, in place, or only this one",
    ),
    "surroundings": ("Floor and figure", "Show or hide the floor and who holds the board"),
    "follow": ("Follow the board's step", "Show the step that the board is on"),
    "theme": ("Light or dark", "Change the page's brightness"),
    "words": ("Holder's or camera's words", "Whose left and right the whole page means"),
    "built": ("How this pose is built", "Show the target's four steps from an upright board"),
    "pause": ("Pause", "Stop taking pictures, or go on"),
    "straight": ("Straight picture", "Show the picture without the lens's distortion"),
    "finish": ("Finish", "Ask what ending now means; once more, end and keep the result"),
    "go_on": ("Go on", "Do not end, or go on after the end, with all views"),
    "new": ("New session", "Begin a new calibration; this one's result stays in its files"),
    "autopilot": ("Autopilot", "Let the simulated hand move the board, or take it yourself"),
    "explain": (
        "How it works",
        "Show or hide the method's loop: detect, calibrate, search, decompose, capture",
    ),
}

BUILT_TITLE = "How this pose is built"
BUILT_INTRO = (
    "Pose {number} in four steps from an upright board that faces the camera, 50 cm away. What to "
    "do now counts from where the board is held and stands above."
)
BUILT_FACT = "Step {number} of 4 · {amount} in all"

# -- other targets ---------------------------------------------------------------------------------

OTHERS_TITLE = "Or nearly as good{instead}; left and right are the picture's"
OTHERS_INSTEAD = ", instead of {error} px"
OTHER_TEXT = "{held}: {error} px"
OTHER_HINT = "Ask for this pose instead; its number is its key."
OTHER_COMMANDS = (
    "Another pose as good",
    "Another pose as good: the second",
    "Another pose as good: the third",
)
OTHER_COMMAND_HINT = "Ask for another pose that is nearly as good as the target"

# -- what a run says -------------------------------------------------------------------------------

DRAG_HINT = Sentence(
    "Drag the board by its handles, move it by keys (H shows them), or press Shift+P for the "
    "autopilot."
)
FROM_CAMERA = Sentence(
    "A known camera is the start: the first poses are for what it leaves open. The result comes "
    "from the new views alone."
)
FROM_CAMERA_ALONE = Sentence(
    "A known camera is the start; how well it is known, its file does not say. The result comes "
    "from the new views alone."
)
VERIFYING = Sentence(
    "Fresh views are taken to check a calibration that exists. Once the camera is known, Ctrl-C in "
    "the terminal ends it, and the terminal says whether it still holds."
)
GOING_ON_FROM = Sentence("Going on from {count} views of an earlier calibration.")
HAS_ENDED = "This calibration has ended; no more views are taken."
NOTHING_TO_CAPTURE = "Nothing to capture: no board is seen, or this view is taken."
NO_VIEW_LEFT = "There is no view to take back."
VIEWS_STAY = "This calibration has ended; its views stay as they are."
ANOTHER_TARGET = "Meanwhile there is another target; choose among its neighbours."
NO_OTHER_POSE = "No other pose is nearly as good; G asks for another one."
NO_POSE_TO_CHOOSE = "There is no other pose to choose just now."
NOT_SAVED = "Not saved: {error} It is tried again every two seconds."
NOT_SAVED_MISTAKE = "Not saved; the terminal says why. The next view is tried again."

# -- the camera's settings -------------------------------------------------------------------------

CAMERA_FOLDER = "The camera's settings"
CAMERA_SETTINGS = {
    "exposure": ("Exposure", "Exposure time, in the driver's unit (Linux: 0.1 ms)"),
    "gain": ("Gain", "Amplification, in the driver's unit; more of it is more noise"),
    "focus": ("Focus", "In the driver's unit; another focus is another camera to calibrate"),
    "white_balance": ("White balance", "Colour temperature"),
}
CAMERA_RANGE = "{name}, {least} to {greatest}"
CAMERA_WHO = "Set"
CAMERA_WHO_HINT = (
    "Automatic: by the camera. Locked: stays as it is now, also when it is opened again."
)
CAMERA_AUTOMATIC, CAMERA_LOCKED = "Automatic", "Locked"
FOCUS_LOCKED = "The focus is locked."
FOCUS_CHANGED = (
    "Another focus is another camera: the views before do not go with those that come. Begin a new "
    "session."
)

# -- how the next pose is found --------------------------------------------------------------------

METHOD_FOLDER = "How the next pose is found"
METHOD = "Method"
METHOD_WITH_COST = "{method}; minimises: {cost}"
METHOD_WORDS: dict[Method, str] = {
    "global": "Best of all poses (global)",
    "venus": "The paper's (venus)",
    "pose-selection": "By Rojtberg's rule (pose-selection)",
    "random": "By chance (random)",
}
COST_WORDS: dict[Cost, str] = {
    "projection-variance": "Uncertainty over the picture (projection-variance)",
    "max-ere": "Largest uncertainty in the picture (max-ere)",
    "trace": "Sum of the uncertainties (trace)",
    "log-det": "Volume of the uncertainty (log-det)",
    "sum-iod": "The paper's index, summed (sum-iod)",
    "max-iod": "The paper's index, largest (max-iod)",
    "rms": "Misfit of a trial calibration, slow (rms)",
}
METHOD_HINT = (
    "global evaluates thousands of poses and needs the fewest views. venus starts from the paper's "
    "rule and searches nearby. More methods on the command line (--method, --cost)."
)
METHOD_COMMAND = "Method: {words}"

# -- progress --------------------------------------------------------------------------------------

PROGRESS_TAB, PARAMETERS_TAB = "Progress", "Parameters"
NOT_KNOWN_YET = (
    "The camera is not known yet. After the first view its parameters appear under “Parameters”."
)
VIEW_CAPTURED, VIEWS_CAPTURED = "view captured", "views captured"
RMS, RMS_HINT = (
    "px rms, misfit of the corners",
    "How far the corners found are from where the calibrated camera would see them. A small one "
    "proves little: it says nothing of what the views do not show.",
)
UNCERTAINTY, UNCERTAINTY_HINT = (
    "px, uncertainty in the image",
    "How far off a point drawn with this camera is to be expected, on average over the whole "
    "picture. The guidance minimises it.",
)
LAST_VIEW = "The last view: {before} → {now} px{promised}."
LAST_VIEW_ALONE = "The last view brought the uncertainty to {now} px."
PROMISED = " (promised {error})"
FORECAST_GOAL = "until {error:g} px"
FORECAST_REACHED = "The uncertainty is below {error:g} px already{why}."
FORECAST_ONE_UNSETTLED = "; one parameter is still to settle"
FORECAST_SOME_UNSETTLED = "; {count} of {all} parameters are still to settle"
FORECAST_NONE_SETTLED = "; no parameter has settled yet"
FORECAST_LEAST = "{least} more views or more {goal}."
FORECAST_OPEN = "About {views} more views {goal} ({low} or more)."
FORECAST_ONE, FORECAST_MANY = "About {views} more view {goal}", "About {views} more views {goal}"
FORECAST_RANGE = "{words} ({low} to {high})."
PROMISE = "It should bring the uncertainty from {now} to {then} px."
WHAT_FOR = "What the next pose is for"
WHAT_FOR_HINT = "Why the board should go there: what its view tells of the camera."
LOOKED_AT = "{count} poses were evaluated. "
SERVES = "Helps most: {names}."

# -- the camera's parameters -----------------------------------------------------------------------

TREND_TITLE = "Sigma over the views (first full set = 100 %)"
TREND_HINT = "How the uncertainty of each parameter shrinks as views are added."
TREND_KEYS = ("focal length", "centre", "distortion")
TREND_VIEWS = "views"

# -- what makes the numbers doubtful ---------------------------------------------------------------

DIAGNOSES_TITLE = "Before you trust this"
DIAGNOSES_MORE = "and {count} more"
SEVERITIES = {"wrong": "Wrong", "weak": "Weak", "note": "Note"}
DIAGNOSIS_TITLES: dict[DiagnosisKind, str] = {
    "wrong-dictionary": "other markers than asked for",
    "swapped-size": "rows and columns do not fit",
    "mirrored": "the picture is mirrored",
    "other-pattern": "another kind of pattern",
    "wrong-polarity": "white circles, or black ones",
    "unread-markers": "markers that cannot be read",
    "two-boards": "two equal boards in view",
    "small-board": "the board is too small",
    "impossible-distance": "impossible distance",
    "fisheye-lens": "a fisheye lens",
    "wrong-lens": "another lens model is needed",
    "cropped-pictures": "part of a larger picture",
    "turned-pictures": "pictures turned by 180°",
    "changed-focal-length": "the focal length changed",
    "bent-board": "the board is not flat",
    "rolling-shutter": "moved while being read",
    "poor-fit": "the model does not fit",
    "parallel-views": "views nearly parallel",
    "weak-focal-length": "focal length uncertain",
    "folding": "lens model folds back",
    "left-out-view": "a view was left out",
    "left-out-corners": "corners were left out",
    "repeated-views": "views that repeat others",
    "outlying-view": "one view stands out",
    "unseen-side": "part of the picture never used",
    "correlated": "parameters not told apart",
    "same-depth": "always the same distance",
    "bowed-board": "the board is bowed",
    "stretched-print": "the print is stretched",
    "second-board": "another board in view",
    "wrong-layout": "another layout of the board",
    "other-first-id": "the marker ids start elsewhere",
    "wrong-marker-size": "another size of the markers",
    "thin-border": "thin borders around the markers",
}
"""Short forms."""

# -- the loop of the method ------------------------------------------------------------------------

LOOP_PARTS: dict[LoopPart, tuple[str, str]] = {
    "detect": ("Detect", "Finds the board's corners in each picture."),
    "calibrate": ("Calibrate", "Works the camera out from all views captured so far."),
    "search": ("Search", "Looks for the pose whose view would help most."),
    "decompose": ("Decompose", "Splits the way to that pose into a move and three turns."),
    "capture": ("Capture", "Takes the view when the board is in place and still; then all again."),
}
"""Name of each part, and what it does."""
LOOP_CORNERS = "{count} corners"
LOOP_VIEW, LOOP_VIEWS = "1 view", "{count} views"
LOOP_RMS = "{views}, rms {rms} px"
LOOP_POSES = "{count} poses"
LOOP_STEPS, LOOP_STEP_LEFT, LOOP_STEPS_LEFT = "to the target", "1 step", "{count} steps"
LOOP_GAIN, LOOP_GAINED, LOOP_FIRST_GAIN = "uncertainty", "{before} → {after} px", "{after} px"

# -- the film strip --------------------------------------------------------------------------------

FILM_ROW = (
    "Captured views",
    "The views captured so far; a click opens one. A number that is missing was taken back.",
)
FILM_EMPTY = "The views that are captured appear here."
FILM_VIEW = "{number}"

# -- the tour --------------------------------------------------------------------------------------

TOUR = (
    (
        "You hold the board, the page guides you",
        "To calibrate a camera you show it a board from several sides. This page finds out which "
        "side helps most next, and leads you there in four small steps.",
    ),
    (
        "What to do now",
        "The large text on the left is all you need while you hold the board: which step, which "
        "way, and how much is left. It can be read from two metres away.",
    ),
    (
        "What the camera sees",
        "On the right is the live picture. Bring the board onto the thick outline; the dashes are "
        "where it ends up. Below are the four steps: move, tilt, swing, rotate.",
    ),
    (
        "The same in space",
        "The middle shows camera, board and target in 3D. Drag to look around, scroll to come "
        "nearer.",
    ),
    (
        "Hold still, and it is captured",
        "When the board is where it should be, hold it still: the picture is taken by itself. "
        "After ten views or so the camera is known. H shows all keys.",
    ),
)
"""Title and text of each step of the tour; the first is about the whole page."""

speak(__name__)
