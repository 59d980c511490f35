"""Options of `venus3d study`, apart from what runs it: every command's `--help` waits for them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from tyro.conf import OmitSubcommandPrefixes, Positional, arg, subcommand

from venus3d.options import BoardOptions, LensName, Switch
from venus3d.sources.sim_cameras import SimCamera
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
