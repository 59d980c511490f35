"""Trials over cores and a cluster: the same rows everywhere, and nothing lost on the way."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.study.trials import Draw, drawn
from venus3d.engine.errors import StorageError, VenusError
from venus3d.study.runner import run_trials
from venus3d.study.simulated import ArmTrial, run_arm

TRIALS = tuple(Draw(seed) for seed in (3, 1, 4, 5, 9, 2))


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file that one process makes."""
    path = tmp_path_factory.mktemp("alone") / "rows.csv"
    run_trials(drawn, TRIALS, path, jobs=1)
    return path


def test_rows_are_those_of_the_trials_in_order(alone: Path) -> None:
    with alone.open() as file:
        rows = list(csv.DictReader(file))
    assert [row["trial"] for row in rows[::3]] == [trial.key for trial in TRIALS]
    for trial, row in zip(TRIALS, rows[::3], strict=True):
        rng = np.random.default_rng(trial.seed)
        rng.standard_normal((64, 64))
        assert float(row["value"]) == rng.random()


def test_two_processes_make_the_same_bytes(alone: Path, tmp_path: Path) -> None:
    run_trials(drawn, TRIALS, tmp_path / "rows.csv", jobs=2)
    assert (tmp_path / "rows.csv").read_bytes() == alone.read_bytes()


@pytest.fixture
def scheduler() -> Iterator[str]:
    import distributed

    local: Any = distributed.LocalCluster  # its own annotations are those of its async form
    with local(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        yield cluster.scheduler_address


@pytest.mark.slow
def test_a_cluster_of_two_processes_makes_the_same_bytes(
    alone: Path, tmp_path: Path, scheduler: str
) -> None:
    run_trials(drawn, TRIALS, tmp_path / "rows.csv", dask=scheduler)
    assert (tmp_path / "rows.csv").read_bytes() == alone.read_bytes()

    arms = [ArmTrial(arm, 0, 5, 3) for arm in ("global", "venus", "random")]
    for place, name in ((scheduler, "there"), (None, "here")):
        run_trials(run_arm, arms, tmp_path / name, jobs=1, dask=place)
    assert (tmp_path / "there").read_bytes() == (tmp_path / "here").read_bytes()


def test_no_scheduler_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("venus3d.study.runner.REACH_S", 1.0)
    with pytest.raises(VenusError, match=r"No Dask scheduler answers at tcp://127\.0\.0\.1:9;"):
        run_trials(drawn, TRIALS, tmp_path / "rows.csv", dask="tcp://127.0.0.1:9")


@pytest.mark.slow
def test_a_run_whose_process_is_killed_goes_on_where_it_stopped(
    alone: Path, tmp_path: Path
) -> None:
    bomb, rows = tmp_path / "bomb", tmp_path / "rows.csv"
    bomb.touch()
    trials = tuple(Draw(trial.seed, str(bomb)) for trial in TRIALS)
    with pytest.raises(VenusError, match="what is done is kept"):
        run_trials(drawn, trials, rows, jobs=2)
    journal = tmp_path / "rows.journal.jsonl"
    begun = journal.read_text()
    assert "draw-3" in begun and "draw-5" not in begun and not rows.exists()

    journal.write_text(begun + '{"trial": "draw-9", "ro')  # a write that was cut off
    bomb.unlink()
    run_trials(drawn, trials, rows, jobs=2)
    assert rows.read_bytes() == alone.read_bytes()
    assert journal.read_text().startswith(begun)


def test_what_is_there_is_not_done_again_and_more_can_follow(tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    run_trials(drawn, TRIALS[:2], rows, jobs=1, setup="a")
    journal = tmp_path / "rows.journal.jsonl"
    journal.write_text(journal.read_text().replace("0.", "7."))
    table = run_trials(drawn, TRIALS, rows, jobs=1, setup="a")
    assert float(table[0]["value"]) > 7 and float(table[-1]["value"]) < 1

    with pytest.raises(VenusError, match="belongs to another run \\(a\\); name another output"):
        run_trials(drawn, TRIALS, rows, jobs=1, setup="b")


@pytest.mark.parametrize(
    "text", ["no journal", "no journal\n", "{}\n", '{"setup": ""}\n{"trial": 1\n']
)
def test_a_file_that_is_no_journal_is_left_alone(tmp_path: Path, text: str) -> None:
    journal = tmp_path / "rows.journal.jsonl"
    journal.write_text(text)
    with pytest.raises(StorageError, match=r"is (damaged|no journal of a study); name another"):
        run_trials(drawn, TRIALS, tmp_path / "rows.csv", jobs=1)
    assert journal.read_text() == text
