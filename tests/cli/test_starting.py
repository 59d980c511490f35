"""The program's first second, in which it loads its libraries."""

from __future__ import annotations

import subprocess
import sys

STOPPED = """
import sys

class Pressed:
    def find_spec(self, name, path=None, target=None):
        if name == "tyro":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Pressed())
from venus3d.__main__ import run
sys.exit(run())
"""


def test_ctrl_c_while_the_libraries_load_is_no_traceback() -> None:
    """Every other Ctrl-C in the first second ended in Python's traceback."""
    ran = subprocess.run([sys.executable, "-c", STOPPED], capture_output=True, text=True)
    assert (ran.returncode, ran.stderr) == (130, "venus3d: stopped.\n")


def test_the_program_is_its_module_too() -> None:
    ran = subprocess.run(
        [sys.executable, "-m", "venus3d", "--version"], capture_output=True, text=True
    )
    assert ran.returncode == 0 and ran.stdout.startswith("venus3d ")
