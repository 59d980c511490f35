"""The documentation: every link leads somewhere, the site is built, every public name is told."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import venus3d

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize("name", venus3d.__all__)
def test_api_page_has_every_public_name(name: str) -> None:
    assert re.search(rf"\b{name}\b", (ROOT / "docs" / "api.md").read_text())


@pytest.mark.slow
def test_site_is_built(tmp_path: Path) -> None:
    """Its builder ends with an error at a link that leads nowhere."""
    done = subprocess.run(
        [sys.executable, str(ROOT / "scripts" / "docs.py"), str(tmp_path / "site")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert "<h1" in (tmp_path / "site" / "index.html").read_text()
    documented = (tmp_path / "site" / "api" / "venus3d.html").read_text()
    assert [name for name in venus3d.__all__ if f'id="{name}"' not in documented] == []
