"""Texts of the trial page."""

TAB, GUIDANCE_TAB = "Trial", "What to do now"
START, START_HINT = (
    "Start (space bar)",
    "Show the first pose. The clock counts from when it has been reached.",
)
GIVE_UP, GIVE_UP_HINT = (
    "Give up this pose (K)",
    "Go on to the next pose; it is written as given up.",
)
COMMANDS = {
    "next": ("Start", "Show the first pose"),
    "give_up": ("Give up this pose", "Go on to the next"),
    "theme": ("Light or dark", "Change the brightness"),
    "autopilot": ("Autopilot", "Let the simulated hand move the board, or take it yourself"),
}
SERVING = "Viewer"
DRAG_HINT = "Drag the board by its handles in the scene, or press O for the simulated hand."

HELP_NAMES = {"steps": "the four steps", "axes": "the axes", "outline": "the filled outline"}
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
NEXT = "Next: {name}. Press Start when ready."
NOT_SEEN, HOLD_STILL = "Board not seen", "Hold still"
POSE_OF = "Pose {pose} of {poses}"
OF_POSES = "of {poses}"
POSE = "pose"
SINCE_START, SINCE_FIRST = "since the start", "since the first pose"
AXES_LEGEND = (
    ("Solid X Y Z", "the board"),
    ("dashed X' Y' Z'", "the target"),
)
AXES_MEANING = "X to the right, Y down, Z out of the back"
OUTLINE_LEGEND = ("the target", "covered", "the board")
RESULT_HEAD = ("help", "median of a pose", "all poses after the first", "given up")
WRITTEN = "Written: {path}"
SECONDS_SINCE = "seconds since the first pose"
