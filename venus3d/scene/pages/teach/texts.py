"""Texts of the teaching page."""

from __future__ import annotations

from venus3d.languages.texts_module import speak
from venus3d.scene.pages.teach.actions import (
    Action,
    Answer,
    Arrange,
    FileKind,
    LookFrom,
    PageAction,
    Save,
)

# -- the lesson ------------------------------------------------------------------------------------

LESSON_TAB = "Lesson"
LESSON = "Lesson"
LESSON_HINT = "Choose a lesson, or try things out by yourself. 0 goes to the free page."
FREE = "Try it yourself"
FREE_TITLE = "Try it yourself"
FREE_TEXT = (
    "Move the six sliders below: they say where the board is and how it is turned. The four steps "
    "on the right say how a person brings it there from an upright board.\n\n"
    "**Space bar**: watch the board get there. **N** and **P**: one step at a time."
)
PAGE_OF = "Page {page} of {pages}"
PAGES = "Page"
PAGES_HINT = "Turn the pages of the lesson."
RIGHT = "✓ Right."
WRONG = "✕ Not quite."
ANSWER = "{number}  {answer}"
ANSWER_RIGHT = "✓  {answer}"
ANSWER_WRONG = "✕  {answer}"
ANSWER_HINT = "Give this answer; the number on your keyboard does the same."

SIGMA_TITLE = "What views like this one tell"
SIGMA_SHARE = "± {px} px"
SIGMA_NOTHING = "nothing"
SIGMA_BAR = "The shorter the bar, the better the focal length is known."
LENS_TITLE = "How this lens bends the picture"
LENS_LEGEND = (
    "Each arrow leads from where a perfect lens would show a point to where this lens shows it, "
    "drawn {times:g} times as long. The largest shift is {shift:.1f} px."
)

# -- the class, with --follow-me ------------------------------------------------------------------

CLASS, CLASS_HINT = "Class", "Whether all other tabs show what this one shows."
LEADS = "You lead the class: {others} other tabs follow."
LEADS_ONE = "You lead the class: one other tab follows."
LEADS_NONE = "You lead the class. Whoever opens this page follows."
FOLLOWS = "You follow the teacher. Answers, and light or dark, are your own."
MAY_LEAD = "The class goes its own ways. If you lead, all tabs show what this one shows."

# -- two results side by side ----------------------------------------------------------------------

COLUMNS = {
    "axes": ("The camera's axes", "The board's own axes"),
    "order": ("First X, then Y, then Z", "{order}"),
}
ORDER_NAME = "First {one}, then {two}, then {three}"
COMPARE_TITLES = {"axes": "Fixed axes or the board's own", "order": "The order of turns"}
COMPARE_WHY = {
    "axes": (
        "Both boards get the same three numbers. On the left, each turn is about an axis of the "
        "<b>camera</b>, which never moves. On the right, the axes are painted on the <b>board</b>: "
        "the first turn carries the other two axes along, so the later turns are about other lines "
        "in space. It ends like a board turned about fixed axes in the order Z, Y, X."
    ),
    "order": (
        "Both boards get the same three numbers about the same fixed axes; only the order differs. "
        "The first turn carries the board along, so the next one meets it in another position. "
        "A move may come when it likes; turns may not."
    ),
}
APART = "{angle} apart"
APART_LABEL = "Turn the left board by this much, and it stands like the right one."
SAME = "the same"
SAME_LABEL = "With these numbers both end alike; turn about two axes at least."
COMPARE_TURN = "Turn {number} of 3: about {left}"
COMPARE_TURN_TWO = "Turn {number} of 3: {left} on the left, {right} on the right"
COMPARE_START = "Both boards stand upright"
COMPARE_END = "Both got the same numbers"
COMPARE_SENTENCES = {
    "axes": "Left: about the camera's {axis}. Right: about the board's own {axis}.",
    "order": "Left: {left_axis} by {left}. Right: {right_axis} by {right}.",
}
COMPARE_PROMPT = "Space bar: watch the three turns."

# -- the pose --------------------------------------------------------------------------------------

POSE_TITLE = "The pose in six numbers"
ACCEPTED = "✓ The camera sees all of it; a person can hold it so."
REFUSED = "A person is not asked for this pose"
MORE = "… and {count} more"
REFUSED_LABEL = "Target: refused"
LOCKED_TITLE = "Gimbal lock"
LOCKED = (
    "Y is near 90°: now turning about X and turning about Z do the same to the board. "
    "One way of turning is lost."
)
LOCKED_TRY = "Move the X and the Z slider and watch."

# -- what happens now ------------------------------------------------------------------------------

PICTURE_TITLE = "What the camera sees"
STEPS_PICTURE_TITLE = "The four steps as the camera sees them"
STEP_ALT = "Step {number}: {words}"
STEP = "Step {number} of 4: {title}"
OF = "of {whole}"
START_HEADLINE = "An upright board"
START_SENTENCE = "Half a metre in front of the lens. From here, four steps lead to the pose."
THERE_HEADLINE = "This is the pose"
THERE_SENTENCE = "Space bar: watch the board get here in four steps."
NO_WAY_SENTENCE = "It is where every way starts, so no step is needed."
SIDES = {
    "camera": "in the picture",
    "holder": "for your hands",
    "both": "in the picture and for your hands",
}
HOLDER = "For your hands: {words}"

# -- controls --------------------------------------------------------------------------------------

STEPS, STEPS_HINT = (
    "Steps",
    "Let the board go through the four steps, or one of them. Menu: comparisons, files and more.",
)
PROGRESS, PROGRESS_HINT = (
    "Way (%)",
    "Drag to carry the board along its way: 0 is upright, 100 is the pose.",
)
PROGRESS_MARKS = ("start", "1", "2", "3", "pose")
TEMPO, TEMPO_HINT = "Play", "How fast the board goes, and whether it starts over by itself."
LOOK, LOOK_HINT = "Look from", "Where you look from. You can also turn the scene with the mouse."
SHOW, SHOW_HINT = (
    "Compare",
    "All four steps side by side; the camera's axes and the board's own; two orders of turns. "
    "Press once more for the steps where they happen.",
)
MORE_TITLE, MORE_HINT = (
    "More",
    "The pose that the page began with; a page without a lesson; brightness.",
)
MENU_TITLE = "Menu"
MENU_CLOSE, MENU_CLOSE_HINT = "Close  Esc", "All keys, or back to the page"
HELP_BUTTON = "All keys  H"
SAVE, SAVE_HINT = "Save as", "A file to hand out: it works without this program and offline."
SAVING = "{kind}: the file is being made. This can take a minute; go on as you like."
SAVED = "{name} is done: it is among your browser's downloads."
SAVING_FAILED = "The file could not be made; the window that venus3d was started in says why."
NOTHING_TO_SAVE = "Files cannot be written here."
FILE_NAME = "venus3d-{name}.{kind}"
ANNOUNCED = "Lessons"

ON_TO_LESSON = "Next lesson  PgDn ▶"
PAUSE, DARK = "❚❚ Pause ␣", "Dark  B"
IS_ON = "✓ {label}"
LABELS: dict[Action, str] = {
    PageAction.PREVIOUS_STEP: "◀  P",
    PageAction.PLAY: "▶ Play ␣",
    PageAction.NEXT_STEP: "N  ▶",
    PageAction.MENU: "☰ Menu  ⇧M",
    PageAction.SPEED: "{speed} speed  Z",
    PageAction.LOOP: "Loop  ⇧Z",
    LookFrom("outside"): "Outside",
    LookFrom("camera"): "Camera",
    LookFrom("holder"): "Holder",
    LookFrom("above"): "Above",
    Arrange("strip"): "Steps  T",
    Arrange("axes"): "Axes  ⇧T",
    Arrange("order"): "Orders  Y",
    PageAction.NEXT_ORDER: "Next order  ⇧Y",
    PageAction.RESET: "Pose again  R",
    PageAction.FREE: "Free page  0",
    PageAction.BRIGHTNESS: "Light  B",
    PageAction.LEAD: "Lead the class",
    PageAction.PREVIOUS_PAGE: "◀ Back  PgUp",
    PageAction.NEXT_PAGE: "Next page  PgDn ▶",
}
LET_GO = "Let the class go"
SPEED_NAMES = {0.5: "½×", 1.0: "1×", 2.0: "2×"}
SAVE_LABELS: dict[FileKind, str] = {
    "html": "Web page",
    "png": "Picture",
    "mp4": "Film",
    "gif": "GIF",
}

COMMANDS: dict[Action, tuple[str, str]] = {
    PageAction.PLAY: ("Play or pause", "Let the board go through the four steps"),
    PageAction.NEXT_STEP: ("Next step", "Let one step happen"),
    PageAction.PREVIOUS_STEP: ("Previous step", "Go back before this step"),
    PageAction.SPEED: ("Speed", "Half, usual or double speed"),
    PageAction.LOOP: ("Loop", "Start over by itself, or not"),
    LookFrom(None): ("Other view", "From outside, the camera, the holder, above, in turn"),
    LookFrom("outside"): ("Look from outside", "From behind, above and beside the camera"),
    LookFrom("camera"): ("Look through the camera", "Stand where the camera stands"),
    LookFrom("holder"): (
        "Look from the holder's side",
        "Stand behind the board; left and right are swapped",
    ),
    LookFrom("above"): ("Look from above", "Like a map"),
    Arrange("strip"): ("Steps side by side", "Spread the four steps out, or put them back"),
    Arrange("axes"): ("Fixed axes or own axes", "The same numbers read in two ways"),
    Arrange("order"): ("Order of turns", "The same turns in two orders"),
    PageAction.NEXT_ORDER: (
        "Another order",
        "Compare X, Y, Z with the next of the other five orders of turns",
    ),
    PageAction.NEXT_PAGE: (
        "Next page",
        "The next page; after a lesson's last, the next lesson",
    ),
    PageAction.PREVIOUS_PAGE: ("Previous page", "The page before"),
    PageAction.NEXT_LESSON: ("Next lesson", "Open the next lesson"),
    PageAction.FREE: ("Try it yourself", "No lesson: just the sliders"),
    PageAction.RESET: ("Pose again", "The pose that this page began with"),
    PageAction.BRIGHTNESS: ("Light or dark", "Change the page's brightness"),
    PageAction.MENU: ("Menu", "Comparisons, speed, files to hand out and more"),
    PageAction.LEAD: (
        "Lead the class, or let go",
        "With --follow-me, in a tab on the machine that venus3d runs on",
    ),
    PageAction.SURROUNDINGS: ("Floor and figure", "Show or hide the floor and who holds the board"),
    PageAction.ALL_STEPS: ("Show all steps", "Show where each step ends, or only the active one"),
    Answer(1): ("Answer 1", "Give the first answer"),
    Answer(2): ("Answer 2", "Give the second answer"),
    Answer(3): ("Answer 3", "Give the third answer"),
    Answer(4): ("Answer 4", "Give the fourth answer"),
    Answer(5): ("Answer 5", "Give the fifth answer"),
    Save("html"): ("Save as a web page", "One file with everything in it, for offline"),
    Save("png"): ("Save as a picture", "A sheet of the four steps"),
    Save("mp4"): ("Save as a film", "The animation as MP4"),
    Save("gif"): ("Save as a GIF", "The animation for a slide or a mail"),
}

speak(__name__)
