"""Labels around the active step; its instruction is in `engine/guidance/prompts.py`."""

HOLD_HEADLINE = "Hold still"
STEP_OF_FOUR = "Step {number} of 4:"
TO_GO = "to go"
IN_THE_PICTURE = "In the camera's picture: {words}"
DONE = "✓ done"
CHIP_HINT = "Step {number}, {title}: {fact}"
PICTURE_LEGEND = (
    ("Outline", "step's end"),
    ("dashes", "the target"),
    ("dots", "corners"),
)
