"""The benchmark's judgement on rows of known outcome, and its parts on small work.

No test looks at how fast this machine is: `venus3d study bench` does that.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from venus3d.cli import main
from venus3d.sources.view_errors import ViewErrors
from venus3d.study import bench
from venus3d.study.bench import Bar, BenchTrial, bench_table, bench_trial, judged
from venus3d.study.runner import Value


def _rows(better: float, gain: float, above: float) -> list[dict[str, Value]]:
    """venus' variance is 1/views; global's is `better` times smaller."""
    rows: list[dict[str, Value]] = [
        {"kind": "state", "repeat": n, "views": n + 2, "global_cost": above, "best_cost": 1.0}
        for n in range(10)
    ]
    rows += [
        {"kind": kind, "repeat": n, "views": 14, "promised_px": 0.1, "came_px": 0.1 * came}
        for n in range(3)
        for kind, came in (("shared", gain), ("rendered", 0.9))
    ]
    for repeat in range(3):
        for kind, factor in (("venus", 1.0), ("global", better)):
            for views in range(1, bench.VIEWS + 1):
                known = views > 1
                rows.append(
                    {
                        "kind": kind,
                        "repeat": repeat,
                        "views": views,
                        "projection_variance": 1 / views / factor,
                        "promised_gain": 0.1 if known else float("nan"),
                        "gain": 0.1 * gain if known else float("nan"),
                    }
                )
    return rows


def test_bars_of_known_rows() -> None:
    ratio, needed, near, gain, kept, rendered = judged(_rows(better=7.0, gain=1.1, above=1.04))
    assert ratio.value == pytest.approx(1 / 7) and ratio.ok
    assert needed.value == 2 and needed.ok  # 1/2/7 is 1/14
    assert near.value == 10 and near.ok
    assert gain.value == pytest.approx(1.1) and gain.ok
    assert kept.value == pytest.approx(1.1) and kept.ok
    assert rendered.value == pytest.approx(0.9) and rendered.ok

    ratio, needed, near, gain, kept, rendered = judged(_rows(better=2.0, gain=1.5, above=1.06))
    assert ratio.value == pytest.approx(1 / 2) and not ratio.ok
    assert needed.value == 7 and not needed.ok
    assert near.value == 0 and not near.ok and not gain.ok and not kept.ok


def test_a_level_never_reached_is_infinite_not_one() -> None:
    needed = judged(_rows(better=0.5, gain=1.0, above=1.0))[1]
    assert np.isinf(needed.value) and not needed.ok


def test_a_state_is_searched_by_both(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "LONG_RUNS", 2)
    monkeypatch.setattr(bench, "LONG_BUDGET", 300)
    (row,) = bench_trial(BenchTrial("state", 1, 0))
    # Long runs this short find less than `global` does with ten times as many looks.
    assert row["views"] == 3 and 0 < float(row["global_cost"]) < float(row["best_cost"])


def test_pictures_with_shared_errors_promise_more_than_the_noise_of_their_corners(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(bench, "VIEWS", 6)
    (row,) = bench_trial(BenchTrial("rendered", 0, 0))
    (again,) = bench_trial(BenchTrial("rendered", 0, 0))
    assert row == again
    monkeypatch.setattr(bench, "VIEW_ERRORS", ViewErrors())
    (clean,) = bench_trial(BenchTrial("rendered", 0, 0))
    assert row["views"] == clean["views"] == 6
    for told in ("promised_px", "came_px"):
        assert float(row[told]) > 3 * float(clean[told]) > 0


def test_both_speeds_are_ratios(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "TIMINGS", 2)
    bars = (bench.candidate_speed(0), *bench.suggestion_speed(0))
    assert all(np.isfinite(bar.value) and bar.value > 0 for bar in bars)
    assert bars[2].value >= 3000 and bars[2].ok


def test_the_command_prints_a_table_and_json(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bars = [Bar("views", 4.0, "<= 5", True, (3.0, 5.0)), Bar("gain", 2.0, "0.8 ... 1.25", False)]
    monkeypatch.setattr(bench, "bench", lambda *_args, **_named: bars)
    assert main(["study", "bench", "--json", "--output", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert bench_table(bars) in out and "NO" in out
    told = json.loads(out.splitlines()[-1])
    assert told[0] == {
        "name": "views",
        "value": 4.0,
        "bar": "<= 5",
        "ok": True,
        "quartiles": [3.0, 5.0],
    }


def test_mistakes_are_one_sentence(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for arguments, words in (
        (["figures", "--views", "1"], "--views must be from 3 to 200, not 1."),
        (["figures", "--repeats", "0"], "--repeats must be from 1 to 10000, not 0."),
        (["bench", "--jobs", "0"], "--jobs must be from 1 to 1024, not 0."),
        (["bench", "--output", str(tmp_path / "file" / "x")], "Nothing can be written to"),
    ):
        (tmp_path / "file").touch()
        assert main(["study", *arguments]) == 2
        err = capsys.readouterr().err
        assert err.startswith("venus3d: ") and words in err and err.count("\n") == 1
