"""It starts on every Python that it promises: the oldest and the newest that this machine has."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

from venus3d.render.offscreen import Offscreen

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
HERE = sys.version_info[:2]
Version = tuple[int, ...]
# What pip says where there is no network at all, as against an index that lacks something.
NO_NETWORK = re.compile("Failed to establish a new connection|name resolution|NameResolutionError")


def promised() -> set[Version]:
    """The Pythons named in the project's classifiers."""
    classifiers = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["classifiers"]
    named = re.findall(r"Python :: (\d+)\.(\d+)", "\n".join(classifiers))
    return {(int(major), int(minor)) for major, minor in named}


def version_of(python: Path) -> Version | None:
    """Which Python it is; None if it does not start (as a shim may not) or can make no venv."""
    program = "import sys, venv, ensurepip; print(*sys.version_info[:2])"
    try:
        out = subprocess.run([python, "-c", program], capture_output=True, timeout=20, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return tuple(map(int, out.stdout.split()))


@pytest.fixture(scope="module")
def others() -> dict[Version, Path]:
    """The promised Pythons on this machine but for the one that runs this."""
    folders = [Path(folder) for folder in os.get_exec_path()]
    folders += sorted(Path.home().glob(".pyenv/versions/*/bin"))
    wanted, found = promised() - {HERE}, dict[Version, Path]()
    for major, minor in sorted(wanted):
        for python in (folder / f"python{major}.{minor}" for folder in folders):
            if (major, minor) not in found and version_of(python) == (major, minor):
                found[major, minor] = python
    if not found:
        pytest.skip("there is no other Python here than the one that runs these tests")
    return found


@pytest.mark.slow
@pytest.mark.parametrize("end", [min, max], ids=["oldest", "newest"])
def test_it_installs_draws_and_calibrates(
    others: dict[Version, Path], tmp_path: Path, end: Callable[[Iterable[Version]], Version]
) -> None:
    version = end({HERE, *others})
    if version == HERE:
        pytest.skip("this one runs all the other tests")
    # Modules are not compiled beforehand, as some installers leave them: newer Pythons warn of old
    # habits in the sources of others when they compile them.
    made = subprocess.run(
        ["sh", "scripts/setup.sh", "venv", tmp_path / "venv", ROOT],
        cwd=ROOT,
        env={**os.environ, "PYTHON": str(others[version]), "PIP_COMPILE": "0"},
        capture_output=True,
        text=True,
    )
    if made.returncode and NO_NETWORK.search(made.stderr):
        pytest.skip(f"no network: {made.stderr.splitlines()[-1]}")
    assert made.returncode == 0, made.stderr

    def ran(*arguments: str) -> subprocess.CompletedProcess[str]:
        program = tmp_path / "venv/bin/venus3d"
        done = subprocess.run(
            [program, *arguments, "--output", tmp_path], capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return done

    said = ran("decompose", "30", "-20", "10", "50", "0", "500").stderr
    with Offscreen() as offscreen:
        assert said.strip() == offscreen.note
    assert len([*tmp_path.glob("step-*.png")]) == 4
    headless = ("guide", "sim", "--headless", "--autopilot", "--camera-size", "640x360")
    guided = ran(*headless, "--max-views", "3", "--json")
    assert json.loads(guided.stdout.splitlines()[-1])["views"] == 3
