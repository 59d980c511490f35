"""`venus3d doctor`: each line is ok or says how to mend it, and the exit code tells."""

from __future__ import annotations

import socket
from collections.abc import Callable
from types import SimpleNamespace

import pytest

from tests.cli.conftest import Ran
from tests.ports import free_port
from venus3d.cli import doctor

Run = Callable[..., Ran]
WHATS = ["versions", "OpenCV", "OpenGL", "page", "port", "browser", "cameras", "films", "disk"]


def test_a_machine_that_runs_the_tests_is_well(run: Run) -> None:
    ran = run("doctor", "--port", free_port())
    assert ran.code == 0, ran.out
    lines = [line for line in ran.out.splitlines() if not line.startswith(" ")]
    assert [line.split()[1] for line in lines] == WHATS
    assert all(line.split()[0] in ("ok", "without") for line in lines)


def test_what_is_missing_is_told_with_its_cure(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def nearly_full(_: object) -> SimpleNamespace:
        return SimpleNamespace(free=1e6)

    monkeypatch.setattr(doctor.shutil, "disk_usage", nearly_full)
    monkeypatch.setattr(doctor, "list_cameras", list)
    monkeypatch.setattr(doctor, "_OPENCVS", ("numpy", "scipy"))  # two that are installed

    def broken() -> doctor.Finding:
        raise RuntimeError("no such library")

    monkeypatch.setattr(doctor, "_opengl", broken)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        ran = run("doctor", "--port", taken.getsockname()[1])
    lines = [line for line in ran.out.splitlines() if not line.startswith((" ", "Missing"))]
    found = {line.split()[1]: line for line in lines}
    assert ran.code == 1 and "Missing: OpenGL, disk;" in ran.out
    assert "no such library" in found["OpenGL"] and "0.0 GB" in found["disk"]
    assert found["port"].startswith("without") and found["cameras"].startswith("without")
    assert "more than one" in found["OpenCV"]
    assert ran.out.count("->") == 5


def test_a_port_that_there_is_not_is_refused(run: Run) -> None:
    for port in (0, 65536):
        assert run("doctor", "--port", port).sentence.startswith(f"There is no port {port};")
