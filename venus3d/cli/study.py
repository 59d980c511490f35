"""`venus3d study ...`: the paper's evaluation, one command per table or figure.
Each command writes its rows as they come, so an interrupted run continues when it is called
again."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import OmitSubcommandPrefixes, arg, subcommand

from venus3d.cli.report import print_note
from venus3d.cli.study_tables import (
    Table1Options,
    Table2Options,
    Table3Options,
    table1,
    table2,
    table3,
)
from venus3d.options import Switch, check_range
from venus3d.storage.folder import prepare, write_bytes

_Jobs = Annotated[int | None, arg(metavar="N", help_behavior_hint="(usual: one a core)")]
_Dask = Annotated[str | None, arg(metavar="ADDRESS", help_behavior_hint="(optional)")]


@dataclass(frozen=True)
class FiguresOptions:
    """Figures 6 to 9 on the paper's simulated camera."""

    views: int = 20
    """Views of each calibration."""
    repeats: int = 20
    """Calibrations by each method."""
    seed: int = 0
    """Seed that makes a run reproducible."""
    jobs: _Jobs = None
    """Processes."""
    dask: _Dask = None
    """Run on this Dask cluster instead, such as tcp://host:8786."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-study/figures")
    """Folder for rows.csv, verdicts.md and the pictures."""


@dataclass(frozen=True)
class BenchOptions:
    """What this project claims about its search, measured."""

    repeats: int = 20
    """Calibrations by each method."""
    seed: int = 0
    """Seed that makes the accuracies reproducible; speeds depend on the machine."""
    jobs: _Jobs = None
    """Processes."""
    json: Switch = False
    """Print a JSON list of {"name", "value", "bar", "ok"} on the last line."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-study/bench")
    """Folder for rows.csv."""


# The empty name keeps the field's own, "what", out of the headings of --help.
@dataclass(frozen=True)
class StudyOptions:
    """The paper's evaluation."""

    what: OmitSubcommandPrefixes[
        Annotated[
            Annotated[
                FiguresOptions,
                subcommand(
                    "figures",
                    description="Figures 6 to 9 and a tenth: methods compared on simulated "
                    "corners.",
                ),
            ]
            | Annotated[
                BenchOptions,
                subcommand(
                    "bench", description="The search's speed and accuracy against their bars."
                ),
            ]
            | Annotated[
                Table1Options,
                subcommand(
                    "table1",
                    description="Table 1: methods compared on the views of real recordings.",
                ),
            ]
            | Annotated[
                Table2Options,
                subcommand("table2", description="Table 2: what guiding costs for each frame."),
            ]
            | Annotated[
                Table3Options,
                subcommand(
                    "table3", description="Table 3 with SIMULATED people: time to ten poses."
                ),
            ],
            arg(name=""),
        ]
    ]


def study(options: StudyOptions) -> None:
    """Run one study. Raises `VenusError` for a user's mistake."""
    what = options.what
    if isinstance(what, FiguresOptions):
        _figures(what)
    elif isinstance(what, BenchOptions):
        _bench(what)
    elif isinstance(what, Table1Options):
        table1(what)
    elif isinstance(what, Table2Options):
        table2(what)
    else:
        table3(what)


def _check_common(repeats: int, seed: int, jobs: int | None) -> None:
    check_range("--repeats", repeats, 1, 10_000)
    check_range("--seed", seed, 0, 2**63)
    check_range("--jobs", jobs, 1, 1024)


def _figures(options: FiguresOptions) -> None:
    from venus3d.study.figures import FIGURES, run_figures, verdicts_text
    from venus3d.study.plots import draw_figure, pyplot

    _check_common(options.repeats, options.seed, options.jobs)
    check_range("--views", options.views, 3, 200)
    folder = prepare(options.output)
    pyplot()  # check now, not after an hour of calibrating
    rows = run_figures(
        folder / "rows.csv",
        views=options.views,
        repeats=options.repeats,
        seed=options.seed,
        jobs=options.jobs,
        dask=options.dask,
    )
    text = verdicts_text(rows)
    print(text)
    written = [folder / "rows.csv", write_bytes(folder / "verdicts.md", f"{text}\n".encode())]
    for figure in FIGURES:
        written += draw_figure(rows, figure, folder)
    for path in written:
        print_note(f"Written: {path}")


def _bench(options: BenchOptions) -> None:
    from venus3d.study.bench import bench, bench_table

    _check_common(options.repeats, options.seed, options.jobs)
    folder = prepare(options.output)
    bars = bench(folder / "rows.csv", seed=options.seed, repeats=options.repeats, jobs=options.jobs)
    print(bench_table(bars))
    print_note(f"Written: {folder / 'rows.csv'}")
    if options.json:
        print(json.dumps([asdict(bar) for bar in bars]))
