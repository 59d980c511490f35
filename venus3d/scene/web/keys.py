"""Which key means what, on every page: no page writes a key of its own. docs/keys.md is this table.

H and Esc belong to the help, W A S D Q E and the arrows to the browser's camera, I J K L U O to the
board (`board_keys`), and the digits choose the answer, the level or the pose of that number.
"""

from __future__ import annotations

KEYS: dict[str, str] = {
    "go_on": "space",
    "theme": "B",
    "other_pose": "G",
    "next_step": "N",
    "previous_step": "P",
    "reset": "R",
    "steps_apart": "T",
    "all_steps": "shift+R",
    "surroundings": "shift+B",
    "viewpoint": "V",
    "fit": "home",
    "autopilot": "shift+P",
    # guide
    "capture": "C",
    "undo": "backspace",
    "follow": "F",
    "map": "M",
    "words": "X",
    "play_steps": "shift+space",
    "views": "shift+V",
    "next_view": "shift+N",
    "search": "shift+G",
    "straight": "shift+F",
    "finish": "end",
    "resume": "shift+end",
    "explain": "9",
    # the second monitor, on the guide page
    "lens": "shift+C",
    "mirror": "shift+X",
    # teach
    "free": "0",
    "menu": "shift+M",
    "speed": "Z",
    "loop": "shift+Z",
    "axes": "shift+T",
    "order": "Y",
    "next_order": "shift+Y",
    "next_page": "pagedown",
    "previous_page": "pageup",
    "next_lesson": "shift+pagedown",
    # practice
    "other_help": "shift+H",
}
"""The key of each meaning, as `Command.hotkey`; no two share one."""
