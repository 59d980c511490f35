"""`venus3d study ...`: the paper's evaluation, one command per table or figure.
Each command writes its rows as they come, so an interrupted run continues when it is called
again."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
from tyro.conf import OmitSubcommandPrefixes, Positional, arg, subcommand

from venus3d import __version__
from venus3d.cli.progress import search_progress
from venus3d.cli.report import print_note
from venus3d.engine.errors import VenusError
from venus3d.options import BoardOptions, LensName, Switch, check_range
from venus3d.sources.sim_cameras import SimCamera
from venus3d.storage.folder import prepare, write_bytes
from venus3d.study.assumptions import Assumptions

_Seed = Annotated[int, arg(help="Seed that makes a run reproducible.")]
_Repeats = Annotated[int, arg(help="Calibrations by each method.")]
_Jobs = Annotated[
    int | None, arg(metavar="N", help="Processes.", help_behavior_hint="(usual: one a core)")
]
_Dask = Annotated[
    str | None,
    arg(
        metavar="ADDRESS",
        help="Run on this Dask cluster instead, such as tcp://host:8786.",
        help_behavior_hint="(optional)",
    ),
]
_TableFolder = Annotated[Path, arg(metavar="DIR", help="Folder for rows.csv and table.md.")]


@dataclass(frozen=True)
class FiguresOptions:
    """Figures 6 to 9 and a tenth: methods compared on simulated corners."""

    views: int = 20
    """Views of each calibration."""
    camera: SimCamera = "webcam"
    """The simulated camera; for another one than the paper's, global is compared with random poses
    and with Pose selection."""
    repeats: _Repeats = 20
    seed: _Seed = 0
    jobs: _Jobs = None
    dask: _Dask = None
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-study/figures")
    """Folder for rows.csv, verdicts.md and the pictures."""


@dataclass(frozen=True)
class BenchOptions:
    """The search's speed and accuracy against their bars."""

    repeats: _Repeats = 20
    seed: int = 0
    """Seed that makes the accuracies reproducible; speeds depend on the machine."""
    jobs: _Jobs = None
    json: Switch = False
    """Print a JSON list of {"name", "value", "bar", "ok"} on the last line."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-study/bench")
    """Folder for rows.csv."""


@dataclass(frozen=True)
class Table1Options:
    """Table 1: methods compared on the views of real recordings."""

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
    seed: _Seed = 0
    jobs: _Jobs = None
    dask: _Dask = None
    output: _TableFolder = Path("venus3d-study/table1")


@dataclass(frozen=True)
class Table2Options:
    """Table 2: what guiding costs for each frame."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")]
    """A video, a folder or a pattern of pictures that show the board; best 1280 x 720."""
    board: BoardOptions = field(default_factory=BoardOptions)
    frames: int = 500
    """Number of measurements; the recording's frames are reused cyclically."""
    threads: int = 1
    """Threads that OpenCV may use."""
    seed: int = 0
    """Chooses the target that is shown."""
    output: _TableFolder = Path("venus3d-study/table2")


@dataclass(frozen=True)
class Table3Options:
    """Table 3 with SIMULATED people: time to ten poses."""

    people: int = 5
    """How many simulated people."""
    seed: int = 0
    """Chooses the poses and the people."""
    quick: Switch = False
    """Leave out the sensitivity analysis."""
    assume: Assumptions = field(default_factory=Assumptions)
    jobs: _Jobs = None
    dask: _Dask = None
    output: _TableFolder = Path("venus3d-study/table3")


@dataclass(frozen=True)
class HalvesOptions:
    """Whether the uncertainty holds: random halves of a recording, calibrated apart."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")]
    """A video, a folder or a pattern of pictures that show the board."""
    board: BoardOptions = field(default_factory=BoardOptions)
    cuts: int = 100
    """How often the views are cut into halves."""
    same_percent: float = 0.25
    """Views nearer to each other than this share of the picture's width count once."""
    lens: LensName = "brown5"
    """The lens model; auto finds out from all views which one both halves get."""
    seed: _Seed = 0
    output: _TableFolder = Path("venus3d-study/halves")


@dataclass(frozen=True)
class FlatnessOptions:
    """What a board that is not flat costs, by simulated bows."""

    repeats: _Repeats = 20
    seed: _Seed = 0
    output: _TableFolder = Path("venus3d-study/flatness")


# The empty name keeps the field's own, "what", out of the headings of --help.
@dataclass(frozen=True)
class StudyOptions:
    """Do the paper's evaluation again: figures, tables, benchmarks."""

    what: OmitSubcommandPrefixes[
        Annotated[
            Annotated[FiguresOptions, subcommand("figures")]
            | Annotated[BenchOptions, subcommand("bench")]
            | Annotated[Table1Options, subcommand("table1")]
            | Annotated[Table2Options, subcommand("table2")]
            | Annotated[Table3Options, subcommand("table3")]
            | Annotated[HalvesOptions, subcommand("halves")]
            | Annotated[FlatnessOptions, subcommand("flatness")],
            arg(name=""),
        ]
    ]


def study(options: StudyOptions) -> None:
    """Run one study. Raises `VenusError` for a user's mistake."""
    what = options.what
    for name, most in (("repeats", 10_000), ("people", 1000), ("threads", 1024), ("jobs", 1024)):
        check_range(f"--{name}", getattr(what, name, None), 1, most)
    check_range("--seed", what.seed, 0, 2**63)
    if isinstance(what, FiguresOptions):
        _figures(what)
    elif isinstance(what, BenchOptions):
        _bench(what)
    elif isinstance(what, Table1Options):
        _table1(what)
    elif isinstance(what, Table2Options):
        _table2(what)
    elif isinstance(what, HalvesOptions):
        _halves(what)
    elif isinstance(what, FlatnessOptions):
        _flatness(what)
    else:
        _table3(what)


def _figures(options: FiguresOptions) -> None:
    from venus3d.study.figures import figures_of, run_figures, verdicts_text
    from venus3d.study.plots import draw_figure, pyplot

    check_range("--views", options.views, 3, 200)
    folder = prepare(options.output)
    pyplot()  # check now, not after an hour of calibrating
    rows = run_figures(
        folder / "rows.csv",
        views=options.views,
        repeats=options.repeats,
        seed=options.seed,
        camera=options.camera,
        jobs=options.jobs,
        dask=options.dask,
    )
    _deliver(verdicts_text(rows, options.camera), folder, "verdicts.md")
    for figure in figures_of(options.camera):
        _tell_written(*draw_figure(rows, figure, folder))


def _bench(options: BenchOptions) -> None:
    from venus3d.study.bench import bench, bench_table

    folder = prepare(options.output)
    bars = bench(folder / "rows.csv", seed=options.seed, repeats=options.repeats, jobs=options.jobs)
    print(bench_table(bars))
    _tell_written(folder / "rows.csv")
    if options.json:
        print(json.dumps([asdict(bar) for bar in bars]))


def _table1(options: Table1Options) -> None:
    from venus3d.study.pool import ViewPool, pool_of, simulated_pool
    from venus3d.study.runner import run_trials
    from venus3d.study.table1 import run_table1, table1_text, table1_trials

    if not options.sources:
        raise VenusError("Name a recording to take the views from: a video or a folder, or sim.")
    check_range("--max-views", options.max_views, 3, 1000)
    check_range("--held-out-percent", options.held_out_percent, 1, 90)
    check_range("--same-percent", options.same_percent, 0, 20)
    board = options.board.board()
    folder = prepare(options.output)
    pools: list[ViewPool] = []
    for spec in dict.fromkeys(options.sources):
        if spec == "sim":
            pools.append(simulated_pool(board, np.random.default_rng(options.seed)))
        else:
            same = options.same_percent / 100
            with search_progress() as on_count:
                pools.append(pool_of(spec, board, same=same, on_count=on_count))
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


def _table2(options: Table2Options) -> None:
    from venus3d.study.clip import load_clip
    from venus3d.study.runner import csv_of
    from venus3d.study.table2 import run_table2, table2_rows, table2_text

    check_range("--frames", options.frames, 1, 1_000_000)
    board = options.board.board()
    folder = prepare(options.output)
    with search_progress() as on_count:
        clip = load_clip(options.source, board, on_count=on_count)
    for note in clip.notes:
        print_note(f"{options.source}: {note}")
    costs = run_table2(clip, options.frames, options.threads, options.seed)
    write_bytes(folder / "rows.csv", csv_of(table2_rows(costs)))
    _deliver(table2_text(costs), folder)


def _table3(options: Table3Options) -> None:
    from venus3d.study.runner import run_trials
    from venus3d.study.table3 import run_table3, table3_text, table3_trials

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


def _halves(options: HalvesOptions) -> None:
    from venus3d.study.halves import halves, halves_text
    from venus3d.study.pool import pool_of
    from venus3d.study.runner import csv_of

    check_range("--cuts", options.cuts, 1, 100_000)
    check_range("--same-percent", options.same_percent, 0, 20)
    board = options.board.board()
    folder = prepare(options.output)
    same = options.same_percent / 100
    with search_progress() as on_count:
        pool = pool_of(options.source, board, same=same, lens=options.lens, on_count=on_count)
    for note in pool.notes:
        print_note(f"{options.source}: {note}")
    rows = halves(pool, options.cuts, options.seed)
    write_bytes(folder / "rows.csv", csv_of(rows))
    _deliver(halves_text(pool, rows), folder)


def _flatness(options: FlatnessOptions) -> None:
    from venus3d.study.flatness import flatness, flatness_text
    from venus3d.study.runner import csv_of

    folder = prepare(options.output)
    rows = flatness(options.repeats, options.seed)
    write_bytes(folder / "rows.csv", csv_of(rows))
    _deliver(flatness_text(rows), folder)


def _deliver(text: str, folder: Path, name: str = "table.md") -> None:
    """Print a table, and write it beside its rows."""
    print(text)
    _tell_written(folder / "rows.csv", write_bytes(folder / name, f"{text}\n".encode()))


def _tell_written(*paths: Path) -> None:
    for path in paths:
        print_note(f"Written: {path}")
