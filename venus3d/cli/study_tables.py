"""`venus3d study table1`, `table2`, `table3`: the paper's tables, on recordings and simulations."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
from tyro.conf import Positional, arg

from venus3d import __version__
from venus3d.cli.report import print_note
from venus3d.engine.errors import VenusError
from venus3d.options import BoardOptions, Switch, check_range
from venus3d.storage.folder import prepare, write_bytes
from venus3d.study.assumptions import Assumptions

_Jobs = Annotated[int | None, arg(metavar="N", help_behavior_hint="(usual: one a core)")]
_Dask = Annotated[str | None, arg(metavar="ADDRESS", help_behavior_hint="(optional)")]


@dataclass(frozen=True)
class Table1Options:
    """Real recordings as a pool: how many views each method needs, and how good they are."""

    sources: Annotated[Positional[tuple[str, ...]], arg(metavar="SOURCE...")]
    """Videos, folders or patterns of pictures that show one kind of board, each a pool of its own;
    sim for pictures of the simulated camera."""
    board: BoardOptions = field(default_factory=BoardOptions)
    repeats: int = 5
    """Calibrations by each method; each holds out other views."""
    held_out_percent: float = 30.0
    """How much of a recording is kept for the test; at least 4 views."""
    same_percent: float = 0.25
    """Views nearer to each other than this share of the picture's width count once."""
    max_views: int = 40
    """Never take more views than this."""
    seed: int = 0
    """Seed that makes a run reproducible."""
    jobs: _Jobs = None
    """Processes."""
    dask: _Dask = None
    """Run on this Dask cluster instead, such as tcp://host:8786."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-study/table1")
    """Folder for rows.csv and table.md."""


@dataclass(frozen=True)
class Table2Options:
    """What guiding costs for each frame, with live detection and with prepared steps."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")]
    """A video, a folder or a pattern of pictures that show the board; best 1280 x 720."""
    board: BoardOptions = field(default_factory=BoardOptions)
    frames: int = 500
    """Number of measurements; the recording's frames are reused cyclically."""
    threads: int = 1
    """Threads that OpenCV may use."""
    seed: int = 0
    """Chooses the target that is shown."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-study/table2")
    """Folder for rows.csv and table.md."""


@dataclass(frozen=True)
class Table3Options:
    """SIMULATED people reach ten poses with each help; for real ones use venus3d trial."""

    people: int = 5
    """How many simulated people."""
    seed: int = 0
    """Chooses the poses and the people."""
    quick: Switch = False
    """Leave out the sensitivity analysis."""
    assume: Assumptions = field(default_factory=Assumptions)
    jobs: _Jobs = None
    """Processes."""
    dask: _Dask = None
    """Run on this Dask cluster instead, such as tcp://host:8786."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-study/table3")
    """Folder for rows.csv and table.md."""


def table1(options: Table1Options) -> None:
    """Search the recordings, run all methods, print and write."""
    from venus3d.study.pool import ViewPool, pool_of, simulated_pool
    from venus3d.study.runner import run_trials
    from venus3d.study.table1 import run_table1, table1_text, table1_trials

    if not options.sources:
        raise VenusError("Name a recording to take the views from: a video or a folder, or sim.")
    check_range("--repeats", options.repeats, 1, 10_000)
    check_range("--max-views", options.max_views, 3, 1000)
    check_range("--held-out-percent", options.held_out_percent, 1, 90)
    check_range("--same-percent", options.same_percent, 0, 20)
    check_range("--seed", options.seed, 0, 2**63)
    check_range("--jobs", options.jobs, 1, 1024)
    board = options.board.board()
    folder = prepare(options.output)
    pools: list[ViewPool] = []
    for spec in dict.fromkeys(options.sources):
        if spec == "sim":
            pools.append(simulated_pool(board, np.random.default_rng(options.seed)))
        else:
            same = options.same_percent / 100
            pools.append(pool_of(spec, board, same=same, on_count=_tell_count))
        for note in pools[-1].notes:
            print_note(f"{spec}: {note}")
    setup = {
        "table": 1,
        "version": __version__,
        "board": asdict(options.board),
        "held_out": options.held_out_percent,
        "max_views": options.max_views,
        "pools": {pool.name: [pool.frames, len(pool.observations)] for pool in pools},
    }
    held_out = options.held_out_percent / 100
    rows = run_trials(
        run_table1,
        table1_trials(pools, options.repeats, options.seed, held_out, options.max_views),
        folder / "rows.csv",
        setup=json.dumps(setup),
        jobs=options.jobs,
        dask=options.dask,
        label="table 1",
    )
    _deliver(table1_text(rows, pools), folder)


def table2(options: Table2Options) -> None:
    """Load the frames, measure, print and write."""
    from venus3d.study.clip import load_clip
    from venus3d.study.table2 import run_table2, table2_rows, table2_text

    check_range("--frames", options.frames, 1, 1_000_000)
    check_range("--threads", options.threads, 1, 1024)
    check_range("--seed", options.seed, 0, 2**63)
    board = options.board.board()
    folder = prepare(options.output)
    clip = load_clip(options.source, board, on_count=_tell_count)
    for note in clip.notes:
        print_note(f"{options.source}: {note}")
    costs = run_table2(clip, options.frames, options.threads, options.seed)
    write_bytes(folder / "rows.csv", _csv(table2_rows(costs)))
    _deliver(table2_text(costs), folder)


def table3(options: Table3Options) -> None:
    """Run the simulated people, print and write."""
    from venus3d.study.runner import run_trials
    from venus3d.study.table3 import run_table3, table3_text, table3_trials

    check_range("--people", options.people, 1, 1000)
    check_range("--seed", options.seed, 0, 2**63)
    check_range("--jobs", options.jobs, 1, 1024)
    options.assume.check()
    folder = prepare(options.output)
    setup = {"table": 3, "version": __version__, "assumptions": asdict(options.assume)}
    rows = run_trials(
        run_table3,
        table3_trials(options.seed, options.people, options.assume, sensitivity=not options.quick),
        folder / "rows.csv",
        setup=json.dumps(setup),
        jobs=options.jobs,
        dask=options.dask,
        label="table 3 (simulated people)",
    )
    _deliver(table3_text(rows), folder)


def _tell_count(count: int) -> None:
    print_note(f"{count} frames looked at ...")


def _deliver(text: str, folder: Path) -> None:
    print(text)
    for path in (folder / "rows.csv", write_bytes(folder / "table.md", f"{text}\n".encode())):
        print_note(f"Written: {path}")


def _csv(rows: Sequence[Mapping[str, str | int | float]]) -> bytes:
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()
