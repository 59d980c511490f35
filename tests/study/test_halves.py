"""Random halves of recordings: real ones keep what the covariance promises; simulated ones with
errors that a view's corners share do not keep that of independent noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from venus3d.cli import main
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Pose
from venus3d.study.halves import halves
from venus3d.study.pool import ViewPool
from venus3d.study.runner import Row
from venus3d.study.simulated import observed


def beyond(rows: list[Row], kind: str) -> float:
    values = [[float(row[f"{kind}_{p}"]) for p in ("fx", "fy", "cx", "cy")] for row in rows]
    return float(np.mean(np.abs(values) > 2))


def simulated(views: int, shared_px: float) -> ViewPool:
    rng = np.random.default_rng(4)
    board, seen = Board(), []
    while len(seen) < views:
        place = rng.uniform([-0.08, -0.05, 0.3], [0.08, 0.05, 0.45])
        pose = Pose.from_rvec_tvec(rng.uniform(-0.7, 0.7, 3), place)
        observation = observed(PAPER_CAMERA, board, pose, rng, 0.1, shared_px)
        if observation.count == len(board.corners):
            seen.append(observation)
    return ViewPool("simulated", board, tuple(seen), views)


def test_shared_errors_break_the_noise_only_promise_and_keep_the_other() -> None:
    rows = halves(simulated(20, 0.07), cuts=20, seed=0)
    assert beyond(rows, "noise_only") > 0.2
    assert beyond(rows, "shared") < 0.12
    assert 0.6 < np.median([float(row["shared_distance"]) for row in rows]) < 1.5


def test_with_independent_noise_both_are_the_same() -> None:
    rows = halves(simulated(20, 0.0), cuts=10, seed=0)
    for row in rows:
        assert row["shared_distance"] == pytest.approx(float(row["noise_only_distance"]), rel=0.05)


def test_too_few_views_are_refused() -> None:
    with pytest.raises(CalibrationError, match="at least 8"):
        halves(simulated(7, 0.0), cuts=1, seed=0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("recording", "columns", "rows", "square", "marker"),
    [("lifecam-charuco-8x8", 8, 8, 25.4, 19.05), ("sleap-charuco-8x11-top", 8, 11, 24.0, 18.75)],
)
def test_real_halves_keep_the_promise(
    shared_data: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    recording: str,
    columns: int,
    rows: int,
    square: float,
    marker: float,
) -> None:
    """The bars: at most 12 % of fx, fy, cx, cy beyond 2 sigma, the distance's median 0.6 to 1.5."""
    board = ["--board.columns", f"{columns}", "--board.rows", f"{rows}"]
    board += ["--board.square-mm", f"{square}", "--board.marker-mm", f"{marker}"]
    board += ["--board.dictionary", "DICT_4X4_1000", "--output", str(tmp_path)]
    assert main(["study", "halves", str(shared_data / recording), *board]) == 0
    noise_only, shared = capsys.readouterr().out.splitlines()[2:4]
    assert int(noise_only.split("|")[2].split()[0]) > 20
    assert int(shared.split("|")[2].split()[0]) <= 12
    assert 0.6 <= float(shared.split("|")[-2]) < 1.5
    assert (tmp_path / "table.md").read_text().splitlines()[2:4] == [noise_only, shared]
