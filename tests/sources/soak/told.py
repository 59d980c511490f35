"""The whole program, which writes into a file what its page shows: the target, the board's pose,
the views, the phase. The file is named in TOLD; `session.py` reads it."""

from __future__ import annotations

import os
import pickle
import sys
from pathlib import Path

from venus3d.cli import main
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.viewer import Viewer

_FILE = Path(os.environ["TOLD"])
_show = Viewer.show


def _told(viewer: Viewer, snapshot: Snapshot) -> None:
    _show(viewer, snapshot)
    known = snapshot.calibration
    content = {
        "target": snapshot.target,
        "pose": snapshot.pose,
        "captured": snapshot.captured or (),
        "phase": snapshot.phase,
        "camera": snapshot.camera,
        "rms_px": None if known is None else known.rms_px,
    }
    beside = _FILE.with_suffix(".new")
    beside.write_bytes(pickle.dumps(content))
    beside.replace(_FILE)


Viewer.show = _told  # type: ignore[method-assign]
if __name__ == "__main__":
    sys.exit(main())
