"""Texts on the camera's uncertainty: maps, captured views, the search."""

from typing import Literal

from venus3d.languages.texts_module import speak

TAB = "What is known"
MapKind = Literal["now", "after", "corners", "lens", "misfit"]
MAPS: dict[MapKind, str] = {
    "now": "Now",
    "after": "Next",
    "corners": "Seen",
    "lens": "Lens",
    "misfit": "Misfit",
}
"""Labels of the maps' buttons, in order."""
MAPS_LABEL = "Map"
MAPS_HINT = "Choose what is shown about the camera's picture. M goes through all five."
NOTHING_YET = (
    "Nothing is known yet. After two views this shows where in the picture the camera can be "
    "trusted, and what each view gave."
)

NOW_TITLE = "How far off a point may be, now"
NOW_TEXT = (
    "Where a point really is and where this calibration puts it differ by about this many pixels. "
    "The mean over the picture is {error} px."
)
AFTER_TITLE = "How far off it may be after the next pose"
AFTER_TEXT = (
    "The colours are those of “Now”. With one view at the next pose the mean should "
    "fall from {before} to {after} px."
)
AFTER_NONE = "There is no next pose, so nothing is forecast."
AFTER_UNKNOWN = "The views so far say too little to forecast what the next pose brings."
CORNERS_TITLE = "Where the board's corners were"
CORNERS_TEXT = (
    "Each dot is a corner of a captured view. Striped parts have never been used: what the lens "
    "does there is only guessed."
)
CORNERS_FULL = "Each dot is a corner of a captured view. Every part of the picture has been used."
LENS_TITLE = "What the lens does to the picture"
LENS_TEXT = (
    "The arrows lead from where a perfect lens would show a point to where this lens shows it"
    "{magnified}. The largest shift is {largest} px."
)
LENS_NONE = "The lens is taken as perfect so far; its distortion comes with the second view."
MISFIT_TITLE = "Where corners were found, against where they should be"
MISFIT_TEXT = (
    "Each line leads from a corner that was found along its misfit, drawn {magnified} times as "
    "long. Lines in all directions are plain noise; lines that agree hint at a fault."
)
MISFIT_CHOSEN = " View {number} is drawn strongly."
MAGNIFIED = ", drawn {factor} times as long"
PIXELS = "px"
CORNERS_UNIT = "corners"
PICTURE_ALT = "{title}"

SHOW_LABEL = "In the scene"
SHOW_HINT = "Put the captured views into the scene; watch how the next pose was found."
SHOW_VIEWS, SHOW_SEARCH = "Views ⇧V", "Search ⇧G"
VIEWS_LABEL = "View"
VIEWS_HINT = "Choose a captured view to see it. In the scene, click it (V shows the views there)."
VIEW_OPTION = "{number} · {rms} px"
NO_VIEW = "–"
VIEW_TITLE = "View {number}"
VIEW_ALT = "The picture of view {number}"
VIEW_HELD = "The board was held {held}."
VIEW_POSE = (
    "Turned {x}° about X, {y}° about Y, {z}° about Z; centre {right} mm right, {down} mm down, "
    "{away} mm in front of the lens."
)
VIEW_LEFT_OUT = "{count} more fit no pose and do not count."
VIEW_ERROR = "Misfit of its {count} corners: {rms} px ({against} all views' {all} px)."
VIEW_ABOVE, VIEW_BELOW, VIEW_LIKE = "more than", "less than", "about"
VIEW_GAVE = (
    "What it gave: the uncertainty fell from {without} to {now} px, and {most} became {ratio} "
    "times as sure."
)
WITHOUT_TITLE = "If you leave it out"
WITHOUT_ROWS = ("Uncertainty over the picture", "Sigma of fx", "Sigma of fy", "Misfit of the rest")
WITHOUT_NOW, WITHOUT_THEN = "now", "without"
WITHOUT = {
    "unknown": "The other views alone would not determine the camera.",
    "outlying": "Leave it out, and take it again: its corners fit far worse than all others'.",
    "same": "It hardly matters: the result would be about as certain.",
    "worse": "Leave it in: the result would be {percent} % less certain.",
    "better": "Leave it out: the result would be {percent} % more certain.",
}
"""What leaving a view out would do, by its judgement."""
LEAVE_OUT = "Leave this view out"
LEAVE_OUT_HINT = "Calibrate again without the view shown above. What would change stands there."
CLOSE_VIEW = "Close (Esc)"
CLOSE_VIEW_COMMAND = "Close the captured view"
CLOSE_VIEW_HINT = "Back to the page. The view stays in."

CAPTURED_VIEWS_LEGEND = "The views in the scene: their colour is their misfit. Click one to see it."
CAPTURED_VIEW_LABEL = "{number}"

SEARCH_TITLE = "The search for the next pose"
SEARCH_BATCH = "{looked} poses looked at, best so far: {best}"
SEARCH_MOVE = "Move {move} of {moves}: {verdict}. {accepted} taken, best so far: {best}"
SEARCH_TAKEN, SEARCH_REFUSED = "taken", "refused"
SEARCH_DONE = "Found after {looked} poses: {best}"
SEARCH_DONE_WALK = "The walk ends here after {looked} poses: {end}; the best on the way: {best}"
SEARCH_PX = "uncertainty {value} px"
SEARCH_COST = "cost {value}"
SEARCH_CHOSEN = "the pose chosen"
SEARCH_BEST = "best so far"
SEARCH_NOTHING = "Nothing was searched for this pose: it follows from a rule, or from chance."
SEARCH_BOX = "the same poses, ±90°, 0–1.2 m"
SEARCH_AXES = ("turn about X", "turn about Y", "distance")

SEARCH_LEGEND_DARK = "The search: a dot is a pose looked at; the brighter, the better."
SEARCH_LEGEND_LIGHT = "The search: a dot is a pose looked at; the darker, the better."

NEXT_MAP = "Next map of what is known"
NEXT_MAP_HINT = "Uncertainty now and after the next pose, corners seen, lens, misfit"
TOGGLE_VIEWS = "Captured views in the scene"
TOGGLE_VIEWS_HINT = "Show where the board was in each captured view, or hide it"
NEXT_VIEW = "Look at the next captured view"
NEXT_VIEW_HINT = "Its picture, its pose, what it gave, and what if it were left out"
REPLAY_SEARCH = "Watch the search"
REPLAY_SEARCH_HINT = (
    "Replay slowly how the target was found, now and for each new target, or stop that"
)

NO_PARAMETERS = "After the first view the camera's numbers appear here."
PARAMETERS_TITLE = "The camera's numbers, value ± one sigma"
SIGMA_HINT = "In two of three cases the true value is within ± one sigma of the value given."
SETTLED, IMPROVING, NOT_YET = "✓ settled", "improving", "not yet estimated"
TREND_ALT = "its sigma from view to view, falling to {percent} %"
PARAMETER_SENTENCES = {
    "fx": "How strongly the lens enlarges sideways: a larger fx makes everything wider in "
    "the picture.",
    "fy": "How strongly the lens enlarges up and down: a larger fy makes everything taller.",
    "cx": "Where the lens points, from the left: a larger cx shifts the whole picture to "
    "the right.",
    "cy": "Where the lens points, from the top: a larger cy shifts the whole picture down.",
    "k1": "Bends straight lines, most at the border: negative like a barrel, positive like "
    "a cushion.",
    "k2": "Corrects k1 towards the corners, where k1 alone bends too much or too little.",
    "p1": "The lens sits slightly tilted, up or down: the picture's top and bottom are "
    "bent unequally.",
    "p2": "The lens sits slightly tilted, sideways: left and right are bent unequally.",
    "k3": "The last correction, for the far corners only; the hardest of them to know.",
    "k4": "Corrects the bending further, for a wide lens only; alone it means little.",
    "k5": "As k4, nearer to the corners.",
    "k6": "As k4, for the far corners.",
    "s1": "The sensor is not quite square to the lens: bends the picture sideways.",
    "s2": "As s1, nearer to the corners.",
    "s3": "The sensor is not quite square to the lens: bends the picture up or down.",
    "s4": "As s3, nearer to the corners.",
}
"""Effect of each parameter on the picture, by name."""
PARAMETERS_HINT = "Click a row to read what the number does to the picture."
SHARED_ERRORS = (
    "± includes what all corners of a view have wrong together; counted as separate errors, as in "
    "OpenCV, it would be ± {noise_only} for fx."
)

speak(__name__)
