"""`venus3d study figures` from the command line: what it writes, resumes and refuses."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from venus3d.cli import main
from venus3d.study.figures import run_figures

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Run:
    """`venus3d study figures ARGUMENTS` in this process: exit code, stdout, stderr."""

    def call(*arguments: object) -> tuple[int, str, str]:
        code = main(["study", "figures", *map(str, arguments)])
        out, err = capfd.readouterr()
        return code, out, err

    return call


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--views", "2"], "--views must be from 3 to 200, not 2."),
        (["--repeats", "0"], "--repeats must be from 1 to 10000, not 0."),
        (["--jobs", "0"], "--jobs must be from 1 to 1024, not 0."),
        (["--seed", "-1"], "--seed must be from 0 to 9.22337e+18, not -1."),
    ],
)
def test_impossible_numbers(run: Run, tmp_path: Path, options: list[str], sentence: str) -> None:
    code, out, err = run(*options, "--output", tmp_path / "out")
    assert (code, out, err) == (2, "", f"venus3d: {sentence}\n")
    assert not (tmp_path / "out").exists()


def test_an_output_that_cannot_be_written(run: Run, tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file")
    code, out, err = run("--output", taken)
    assert (code, out) == (2, "")
    assert err == (
        f"venus3d: Nothing can be written to {taken} (not a directory); choose another folder with "
        "--output.\n"
    )


@pytest.mark.parametrize(
    ("missing", "extra", "options"),
    [
        ("joblib", "study", []),
        ("tqdm", "study", []),
        ("matplotlib", "study", []),
        ("distributed", "cluster", ["--dask", "tcp://127.0.0.1:9"]),
    ],
)
def test_a_missing_extra_is_named_before_the_work_starts(
    run: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    missing: str,
    extra: str,
    options: list[str],
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)  # Python's own way to say: not installed
    code, out, err = run(*options, "--output", tmp_path / "out")
    assert (code, out) == (2, "")
    assert err.splitlines()[-1] == (
        f"venus3d: This needs the package {missing}; install it with: pip install "
        f"'venus3d[{extra}]'."
    )


SMALL = ("study", "figures", "--views", "3", "--repeats", "1")


def _started(folder: Path, *options: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "venus3d", *SMALL, "--output", str(folder), *options],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that an undisturbed run on one core leaves."""
    folder = tmp_path_factory.mktemp("whole")
    assert main([*SMALL, "--jobs", "1", "--output", str(folder)]) == 0
    return folder


@pytest.mark.slow
def test_a_run_writes_rows_verdicts_and_ten_pictures(whole: Path) -> None:
    pictures = {f"figure{n}.{kind}" for n in range(6, 11) for kind in ("png", "svg")}
    others = {"rows.csv", "rows.journal.jsonl", "verdicts.md"}
    assert {path.name for path in whole.iterdir()} == pictures | others
    assert (whole / "verdicts.md").read_text().count("**Figure") == 5


@pytest.mark.slow
def test_a_run_that_is_stopped_goes_on_and_ends_with_the_same_rows(
    whole: Path, tmp_path: Path
) -> None:
    """Stopped three times, each time after another trial: one core before, two for the rest."""
    journal, begun = tmp_path / "rows.journal.jsonl", ""
    for blow in (signal.SIGINT, signal.SIGHUP, signal.SIGKILL):
        process, most = _started(tmp_path, "--jobs", "1"), max(1, begun.count("\n"))
        while process.poll() is None and not (
            journal.exists() and journal.read_text().count("\n") > most
        ):
            time.sleep(0.02)
        os.kill(process.pid, blow)
        _, told = process.communicate()
        if blow is not signal.SIGKILL:
            assert process.returncode == 130, told
            assert re.search(
                r"venus3d: stopped: \d of 7 trials are kept; the same command goes on .*\n$", told
            )
        kept, begun = begun[: begun.rfind("\n") + 1], journal.read_text()
        assert begun.startswith(kept)
        assert begun.count("\n") < 8 and not (tmp_path / "rows.csv").exists()

    run_figures(tmp_path / "rows.csv", views=3, repeats=1, seed=0, jobs=2)
    assert (tmp_path / "rows.csv").read_bytes() == (whole / "rows.csv").read_bytes()
    assert journal.read_text().startswith(begun[: begun.rfind("\n") + 1])
