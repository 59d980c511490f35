"""The processes of their own end with the program, even one that is killed."""

from __future__ import annotations

import subprocess
import sys

import psutil
import pytest

WORK = "from venus3d.threads.work_process import WorkProcess as Begun\nhow = (print,)"
DETECTION = """
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.sources.detection_process import DetectionProcess as Begun
how = (Detector(Board()), (1280, 720))
"""
PROGRAM = """
import time
if __name__ == "__main__":
    begun = Begun(*how)
    print("there", flush=True)
    time.sleep(600)
"""


@pytest.mark.parametrize("begins", [WORK, DETECTION], ids=["work", "detection"])
def test_it_ends_with_a_program_that_is_killed(begins: str) -> None:
    command = [sys.executable, "-c", begins + PROGRAM]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as killed:
        assert killed.stdout is not None and killed.stdout.readline() == "there\n"
        children = psutil.Process(killed.pid).children(recursive=True)
        assert children
        killed.kill()
        gone, left = psutil.wait_procs(children, timeout=30)
    assert len(gone) == len(children) and not left
