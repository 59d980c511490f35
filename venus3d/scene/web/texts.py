"""Texts of all pages: the help with the keys, and navigation."""

from venus3d.languages.texts_module import speak

HELP_TITLE = "Keys and commands"
HELP_INTRO = (
    "Everything here works by keyboard. Ctrl+K (on a Mac ⌘K) finds any command by its name."
)
HELP_CAMERA = (
    "The scene: drag to look around, scroll to come nearer, right-drag to shift. The arrow keys "
    "and W A S D Q E fly through it. Home shows all of it again."
)
HELP_CLOSE = "Close (H or Esc)"
HELP_CLOSE_HINT = "Back to the page."
HELP_COMMAND = "Help: all keys"
HELP_COMMAND_HINT = "Show every key and what it does, or put it away"
ESCAPE_COMMAND = "Close the help"
ESCAPE_COMMAND_HINT = "Put away what lies over the page"
NO_KEY = "Ctrl+K"
SHIFTED = "Shift+{key}"
KEY_NAMES = {
    "space": "Space",
    "enter": "Enter",
    "escape": "Esc",
    "tab": "Tab",
    "backspace": "Backspace",
    "delete": "Delete",
    "insert": "Insert",
    "home": "Home",
    "end": "End",
    "pageup": "Page up",
    "pagedown": "Page down",
}
FIT_COMMAND = "Fit the view"
FIT_COMMAND_HINT = "Show the whole scene again, after you have turned or moved it"
VIEW_TURNED = "The view stays as you turned it"
VIEW_TURNED_HOW = "Home fits it to the scene again."
BY_NAME = "By name only ({key}):"
TOUR_NEXT, TOUR_BACK, TOUR_SKIP, TOUR_END = "Next", "Back", "Skip the tour", "Start"
TOUR_NEXT_HINT = "Go on with the tour (Enter)."
TOUR_ROW, TOUR_ROW_HINT = "Tour", "Go back one step, or leave the tour; it does not come again."
TOUR_COUNT = "{number} of {count}"
TOUR_COMMAND = "Show the tour"
TOUR_COMMAND_HINT = "What stands where on this page, in a few steps"
DRAWN_ANEW = "The page was reloaded"
DRAWN_ANEW_WHY = (
    "Drawing it failed ({cause}). Nothing is lost, and it continues where it was. The terminal has "
    "the details."
)
ACTION_FAILED = "That did not work"
ACTION_FAILED_WHY = (
    "It failed inside the program ({cause}). Nothing is lost, and all else goes on. The terminal "
    "has the details."
)
LOST = "No connection to the program. This page goes on by itself once it runs again."
TAB_BROKEN = "This page has stopped after an error. Reload it to continue."
SWITCHED_ON = "✓ {label}"
"""Label of a button whose option is on."""

# -- copying ---------------------------------------------------------------------------------------

COPY_HINT = "Copy"
TYPING = "Keys go to this field. Enter or Esc gives them back to the page."
"""Shown while a field has the keyboard (fields.js)."""

speak(__name__)
