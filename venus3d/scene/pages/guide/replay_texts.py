"""What the time line of a replayed session says."""

from __future__ import annotations

from venus3d.languages.texts_module import speak

TAB = "Recorded session"
TIME = "Time"
TIME_HINT = "Seconds since the first view; pauses are shortened. Shown is what was known then."
ROW = "Session"
ROW_HINT = "Play the session, or go from view to view"
PLAY = "▶ Play"
PAUSE = "❚❚ Pause"
PREVIOUS = "‹ View"
NEXT = "View ›"
SPEED = "Speed"
SPEED_HINT = "How many times faster than it was"
VIEW = "Jump to view"
VIEW_HINT = "The moment at which this view was captured"
TIMES = "{speed}×"
WHERE = {
    "captured": "{at}: view {number} is captured. The calibration is that of before.",
    "calibrated": "{at}: calibrated with view {number}.",
    "changed": "{at}: the views or the target were changed.",
}
COMING = "Worked out so far: {done} of {all} moments."
COMMAND_PLAY = "Play or pause"
COMMAND_PLAY_HINT = "Play the recorded session, or stop it"
COMMAND_NEXT = "Next view"
COMMAND_NEXT_HINT = "Go to the next captured view"
COMMAND_PREVIOUS = "Previous view"
COMMAND_PREVIOUS_HINT = "Go to the captured view before"
FILM_TITLES = {
    "captured": "View {number} is captured",
    "calibrated": "Calibrated with view {number}",
    "changed": "Views or target changed",
}
FILM_KNOWN = "{at}   {views} views, rms {rms} px, f {fx} ± {sigma} px, uncertainty {error} px"
FILM_UNKNOWN = "{at}   The camera is not determined yet."
DOCUMENT_TITLE = "Session {name}"
DOCUMENT_SUMMARY = (
    "A guided calibration of {began}: {views} views, as they were asked for and taken."
)
DOCUMENT_VIEW = "View {number}"
DOCUMENT_RESULT = "The result"
BEFORE = "Known before this view"
AFTER = "Known with it"
STEPS = "The four steps from the view before"
STEPS_FROM_UPRIGHT = "The four steps from an upright board"
STEP_ALT = "Step {number} as the camera sees it"
TAKEN_BACK = "This view was taken back later."
NO_PICTURE = "The picture of this view was not kept."

speak(__name__)
