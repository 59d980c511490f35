"""No code recognises a label: all texts are the same nonsense, and each control still works."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PAGES = "nonsense_pages.py"

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def test_every_control_works_whatever_stands_on_it() -> None:
    here = Path(__file__).parent
    pytest_again = (sys.executable, "-m", "pytest", "-q", "-p", "tests.browser.nonsense")
    done = subprocess.run(
        [*pytest_again, "-p", "no:cacheprovider", str(here / PAGES)],
        cwd=here.parents[1],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
