"""Kills the real program at random moments, and checks that nothing that it reported is lost.

    python -m tests.cli.killed --runs 200

Each run guides on the simulated camera without a viewer and is killed by SIGKILL after a random
time. Every view that it had reported must then be in its folder, with its picture, and a session
must go on with all of them.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from venus3d.engine.guidance.session import Session
from venus3d.storage.places import is_session
from venus3d.storage.session_folder import SessionFolder

_REPORTED = re.compile(r"View (\d+) is kept")


def killed_after(folder: Path, views: int, seconds: float) -> list[int]:
    """Numbers of the views that a run reported before it was killed: so long after that many."""
    command = [sys.executable, "-m", "venus3d", "guide", "sim", "--headless"]
    command += ["--camera-size", "640x360", "--output", str(folder), "--max-views", "9"]
    path = folder.parent / f"{folder.name}.log"
    with path.open("w") as log:
        program = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=log, start_new_session=True
        )
        while program.poll() is None and len(_reported(path)) < views:
            time.sleep(0.02)
        time.sleep(seconds)
        if program.poll() is None:
            os.killpg(program.pid, signal.SIGKILL)
        program.wait()
    return _reported(path)


def _reported(path: Path) -> list[int]:
    return [int(number) for number in _REPORTED.findall(path.read_text())]


def check(folder: Path, reported: list[int]) -> str:
    """What is missing after a kill; empty if nothing is."""
    if not is_session(folder):
        return f"{reported} reported, and no session" if reported else ""
    session_folder = SessionFolder.open(folder, lambda _: None)
    try:
        state = session_folder.state()
        kept = [] if state is None else [view.number for view in state.views]
        if missing := set(reported) - set(kept):
            return f"views {sorted(missing)} are lost"
        if state is None:
            return ""
        pictures = [number for number, _ in session_folder.pictures(state)]
        if pictures != kept:
            return f"pictures of {kept}: {pictures}"
        session = Session(state.board, state.views[0].observation.image_size)
        session.restore(state)
        if len(session.run_pending(stop=lambda: True).views) != len(kept):
            return f"the session does not go on with {kept}"
    finally:
        session_folder.close()
    return ""


def one_run(number: int, folder: Path) -> tuple[int, str]:
    """Number of views reported, and what is missing."""
    chance = random.Random(number)
    reported = killed_after(folder, chance.randrange(7), chance.uniform(0.0, 2.0))
    return len(reported), check(folder, reported)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=200)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda n: one_run(n, Path(name) / str(n)), range(options.runs)))
    views = [count for count, _ in results]
    lost = [said for _, said in results if said]
    print(f"{options.runs} runs killed; {sum(views)} views reported, {max(views)} at most in one.")
    print(*lost or ["None is lost."], sep="\n")


if __name__ == "__main__":
    main()
