"""Texts of the second monitor, and of its controls on the operator's page. One sentence at a time,
addressed to the board's holder. How to move the board is said by `engine/guidance/prompts.py`."""

from venus3d.languages.texts_module import speak
from venus3d.scene.pages.audience.state import Sound

STARTING = ("…", "Starting", "Waiting for the first picture.")
LOST = "No connection since {since}. The picture is old; this page goes on by itself."
NO_PICTURES = ("!", "No new pictures", "No new pictures since {since}. Please wait.")
PAUSED = ("II", "Paused", "Paused. You may rest your arms.")
SHOW_BOARD = ("?", "Show the board")
NOT_SEEN = ("?", "Board not seen")
OTHER_BOARD = ("!", "Another board")
NO_TARGET = ("?", "Your turn")
REFUSED = ("!", "Not captured yet")
HOLD_STILL = ("✓", "Hold still", "Hold the board still.")
TAKEN_BACK = (
    "↩",
    "Taken back",
    "Move the board away from here: only then is this pose captured again.",
)
CAPTURED = ("✓", "Captured", "Captured. You may relax your arms.")
THINKING = ("…", "One moment", "One moment: the next pose is being worked out.")
CONVERGED = ("✓", "Done", "Done. The camera is calibrated; thank you.")
FINISHED = ("✓", "Finished", "Finished. You may put the board down.")
ENDED = ("■", "Ended", "Ended. You may put the board down.")
DOUBTED = ("!", "Not done yet", "The operator reads a warning; please wait.")
"""Badge, title and sentence of each state; four have the engine's sentence."""

STEP_DONE = "{title}: done. Leave it like that."
VIEWS = ("nothing captured yet", "{count} picture captured", "{count} pictures captured")
TO_GO = "to go"
DONE = "done"

LEFT_RIGHT = ("left", "right")
UP_DOWN = ("up", "down")
NEAR_FAR = ("nearer", "farther")
"""Ends of the three scales of a move; left and right are the holder's."""
MOVE_PARTS = (
    ("← {mm} mm", "{mm} mm →"),
    ("↑ {mm} mm", "{mm} mm ↓"),
    ("{mm} mm", "{mm} mm"),
)
"""Amount towards the first and the second end of each scale; no arrow shows depth."""

DIAL_LABEL = "{amount} to go; done within {limit}"
SOUNDS = {
    "tones": ("♪ Tones", "Tones that quicken as the board comes nearer, in this browser"),
    "voice": ("Voice", "The sentence spoken aloud, in this browser"),
}
"""Label and hint of this browser's switches."""
SOUND_HINT = "Click once anywhere: browsers stay silent until then."
SPOKEN_UNITS = ((" mm", " millimetres"), ("°", " degrees"))

PANEL = "Second monitor"
CONTROLS = {
    "mirror": ("Mirrored picture", "Reversed, for somebody who faces the camera"),
    "lens": (
        "Through the lens",
        "Through the glass: the 3D steps, standing in the live picture",
    ),
    "light": ("Bright room", "Dark letters on a light ground"),
}
"""Label and hint of each switch, by its field."""
SOUND_LABEL = "Sound"
SOUND_OPTIONS: dict[Sound, str] = {
    "off": "Off",
    "tones": "Tones",
    "voice": "Voice",
    "both": "Tones and voice",
}
SOUND_CHOICE_HINT = (
    "Tones quicken as the board comes nearer; the voice speaks the sentence. Whoever looks can "
    "switch both for themselves."
)
SOUND_COMMAND, SOUND_COMMAND_HINT = "next sound", "Off, tones, voice, or both"

DRAWN_ANEW = "The second monitor was reloaded after a drawing error ({cause}). Nothing is lost."

speak(__name__)
