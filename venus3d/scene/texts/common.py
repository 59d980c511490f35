"""What all pages say: the help with the keys, and how to get about."""

HELP_TITLE = "Keys and commands"
HELP_INTRO = (
    "Everything here works by keyboard. Ctrl+K (on a Mac ⌘K) finds any command by its name."
)
HELP_CAMERA = (
    "The scene: drag to look around, scroll to come nearer, right-drag to shift. The arrow keys "
    "and W A S D Q E fly through it."
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
