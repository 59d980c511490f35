"""A command whose OpenGL opens and then fails: it ends well and says so once."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

# Without its handler for what `ctypes.byref` makes, PyOpenGL opens a context and can make no
# texture: it is as on Python 3.12 and newer if nobody told PyOpenGL of the type's new name.
PROGRAM = """
import sys
from OpenGL.plugins import FormatHandler
from venus3d.cli import main
from venus3d.render.offscreen import Offscreen
Offscreen().close()
for handler in FormatHandler.all():
    handler.check = [name for name in handler.check or () if "CArgObject" not in name]
sys.exit(main(sys.argv[1:]))
"""
POSE = ("30", "-20", "10", "50", "0", "500")


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ("decompose", *POSE, "--output", "."),
        ("teach", "--export", "lesson.html"),
        (
            *("guide", "sim", "--headless", "--autopilot", "--camera-size", "640x360"),
            *("--max-views", "3", "--output", "."),
        ),
    ],
    ids=["decompose", "teach", "guide"],
)
def test_the_painter_finishes_what_opengl_began(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments], capture_output=True, text=True, cwd=tmp_path
    )
    assert ran.returncode == 0, ran.stderr
    if "cannot be used here" in ran.stderr:
        pytest.skip(ran.stderr)
    said = [line for line in ran.stderr.splitlines() if "OpenGL failed while it drew" in line]
    assert len(said) == 1 and "from now on (" in said[0], ran.stderr
    assert "Traceback" not in ran.stderr
    if arguments[0] == "decompose":
        assert len({Image.open(path).tobytes() for path in tmp_path.glob("step-*.png")}) == 4
