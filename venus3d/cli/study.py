"""`venus3d study ...`: the paper's evaluation, one command per table or figure.
Each command writes its rows as they come, so an interrupted run continues when it is called
again."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from venus3d import __version__
from venus3d.cli.progress import search_progress
from venus3d.cli.report import print_note
from venus3d.cli.study_options import (
    BenchOptions,
    FiguresOptions,
    FlatnessOptions,
    HalvesOptions,
    StudyOptions,
    Table1Options,
    Table2Options,
    Table3Options,
)
from venus3d.engine.errors import VenusError
from venus3d.options import check_range
from venus3d.storage.folder import prepare, write_bytes
from venus3d.storage.places import free_place
from venus3d.storage.products import is_made, product_place, write_product

_TABLE, _VERDICTS, _ROWS = "table.md", "verdicts.md", "rows.csv"
_MADE = "a study's table"


def study(options: StudyOptions) -> None:
    """Run one study. Raises `VenusError` for a user's mistake."""
    what = options.what
    for name, most in (("repeats", 10_000), ("people", 1000), ("threads", 1024), ("jobs", 1024)):
        check_range(f"--{name}", getattr(what, name, None), 1, most)
    check_range("--seed", what.seed, 0, 2**63)
    studies: dict[type, Callable[[Any], None]] = {
        FiguresOptions: _figures,
        BenchOptions: _bench,
        Table1Options: _table1,
        Table2Options: _table2,
        Table3Options: _table3,
        HalvesOptions: _halves,
        FlatnessOptions: _flatness,
    }
    studies[type(what)](what)


def _figures(options: FiguresOptions) -> None:
    from venus3d.study.figures import figures_of, run_figures, verdicts_text
    from venus3d.study.plots import FIGURE, draw_figure, figure_files, pyplot

    check_range("--views", options.views, 3, 200)
    folder = _prepared(options.output, _VERDICTS)
    for figure in figures_of(options.camera):
        for path in figure_files(figure, folder):
            product_place(path, FIGURE)
    pyplot()  # check now, not after an hour of calibrating
    rows = run_figures(
        folder / _ROWS,
        views=options.views,
        repeats=options.repeats,
        seed=options.seed,
        camera=options.camera,
        jobs=options.jobs,
        dask=options.dask,
    )
    _deliver(verdicts_text(rows, options.camera), folder, _VERDICTS)
    for figure in figures_of(options.camera):
        _tell_written(*draw_figure(rows, figure, folder))


def _bench(options: BenchOptions) -> None:
    from venus3d.study.bench import bench, bench_table

    folder = _prepared(options.output)
    bars = bench(folder / _ROWS, seed=options.seed, repeats=options.repeats, jobs=options.jobs)
    print(bench_table(bars))
    _tell_written(folder / _ROWS)
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
    folder = _prepared(options.output)
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
        folder / _ROWS,
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
    folder = _prepared(options.output)
    with search_progress() as on_count:
        clip = load_clip(options.source, board, on_count=on_count)
    for note in clip.notes:
        print_note(f"{options.source}: {note}")
    costs = run_table2(clip, options.frames, options.threads, options.seed)
    write_bytes(folder / _ROWS, csv_of(table2_rows(costs)))
    _deliver(table2_text(costs), folder)


def _table3(options: Table3Options) -> None:
    from venus3d.study.runner import run_trials
    from venus3d.study.table3 import run_table3, table3_text, table3_trials

    options.assume.check()
    folder = _prepared(options.output)
    setup = {"table": 3, "version": __version__, "assumptions": asdict(options.assume)}
    rows = run_trials(
        run_table3,
        table3_trials(options.seed, options.people, options.assume, sensitivity=not options.quick),
        folder / _ROWS,
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
    folder = _prepared(options.output)
    same = options.same_percent / 100
    with search_progress() as on_count:
        pool = pool_of(options.source, board, same=same, lens=options.lens, on_count=on_count)
    for note in pool.notes:
        print_note(f"{options.source}: {note}")
    rows = halves(pool, options.cuts, options.seed)
    write_bytes(folder / _ROWS, csv_of(rows))
    _deliver(halves_text(pool, rows), folder)


def _flatness(options: FlatnessOptions) -> None:
    from venus3d.study.flatness import flatness, flatness_text
    from venus3d.study.runner import csv_of

    folder = _prepared(options.output)
    rows = flatness(options.repeats, options.seed)
    write_bytes(folder / _ROWS, csv_of(rows))
    _deliver(flatness_text(rows), folder)


def _prepared(folder: Path, table: str = _TABLE) -> Path:
    """The folder, where a study may write: its rows are an earlier run's if its table or journal is
    beside them. Raises `StorageError`."""
    from venus3d.study.runner import is_journal, journal_of

    rows = prepare(folder) / _ROWS
    product_place(folder / table, _MADE)
    free_place(rows, replaces=is_made(folder / table, _MADE) or is_journal(journal_of(rows)))
    return folder


def _deliver(text: str, folder: Path, name: str = _TABLE) -> None:
    """Print a table, and write it beside its rows."""
    print(text)
    _tell_written(folder / _ROWS, write_product(folder / name, f"{text}\n".encode(), _MADE))


def _tell_written(*paths: Path) -> None:
    for path in paths:
        print_note(f"Written: {path}")
