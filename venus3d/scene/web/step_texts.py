"""Labels around the steps to do; their instructions are in `engine/guidance/prompts.py`."""

from venus3d.engine.guidance.prompts import Wording
from venus3d.languages.texts_module import speak

STEP_OF_FOUR = "Step {number} of 4:"
TO_GO = "to go"
OTHER_WORDING: dict[Wording, str] = {
    "holder": "In the camera's picture: {words}",
    "camera": "For whoever holds the board: {words}",
}
"""The same in the other wording, below the one that was chosen."""
DONE = "✓ done"
CHIP_HINT = "Step {number}, {title}: {fact}"
FROM_UPRIGHT = "Until then the steps count from upright."
PICTURE_LEGEND = (
    ("Outline", "step's end"),
    ("dashes", "the target"),
    ("dots", "corners"),
)
HALVES_LEGEND = (
    ("Left of the line", "without distortion"),
    ("right", "as it comes"),
)

TILES_TITLE = "Four steps from here, as the camera sees them"
TILES_FROM_UPRIGHT = "Four steps from upright, as the camera sees them"
TILES_HINT = (
    "Each picture shows the board after its step; all four in a row bring the board from where it "
    "is held now to the target. They are drawn again when a step is done or the board is elsewhere."
)
TILES_EMPTY = "The four steps of the next target appear here."
TILE_FACT = "Step {number} of 4 · {fact}"
TILE_ALT = "Step {number} as the camera sees it"
TILE_WAITING = "Step {number}"
TILE_FAILED = "This picture could not be drawn; the terminal says why."
READERS: dict[Wording, str] = {
    "holder": "For the holder: your left is the picture's right.",
    "camera": "For the camera: left and right as in the picture.",
}

speak(__name__)
