"""Table 3 of the paper with simulated people: the time for ten poses with each help.

A simulation, not a measurement: the result follows from `assumptions.Assumptions`, and the
sensitivity lines say how much. The same ten targets for every help; time runs from the first pose
on, as in the paper. `venus3d trial` measures people.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.study.assumptions import Assumptions
from venus3d.study.hand import HELPS, Help, reach
from venus3d.study.runner import Row
from venus3d.study.text import minutes, table

POSES = 10
PEOPLE = 5
SPREAD = 0.25
"""Variation between people, of times and errors: a relative standard deviation."""
PAPER_S: dict[Help, tuple[int, ...]] = {
    "axes": (497, 444, 412, 419, 341),
    "steps": (439, 448, 222, 247, 308),
}
"""Table 3, seconds: Pose selection and Pose decomposition."""
FLIPS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
"""Probabilities of reading a tilt from the axes with the wrong sign, from 0 to 0.5."""
_AS_ASSUMED = "as assumed"
_FLIP = "axes_flip = "


@dataclass(frozen=True)
class Table3Trial:
    """One simulated person with every help."""

    seed: int
    person: int
    assumptions: Assumptions = field(default_factory=Assumptions)
    variant: str = _AS_ASSUMED
    """The changed assumption, for the sensitivity lines."""

    @property
    def key(self) -> str:
        """Unique in a study."""
        return f"{self.variant}/{self.person}/{self.seed}"


def run_table3(trial: Table3Trial) -> list[Row]:
    """A row for each help and each pose after the first."""
    camera, board = PAPER_CAMERA, Board()
    targets = targets_of(trial.seed, camera, board)
    # The same person in all variants, which then differ by the assumption alone.
    person = trial.assumptions.person(SPREAD, np.random.default_rng([trial.seed, 1, trial.person]))
    rows: list[Row] = []
    for number, help_ in enumerate(HELPS):
        rng = np.random.default_rng([trial.seed, 2, trial.person, number])
        pose = targets[0]
        for count, target in enumerate(targets[1:], start=2):
            attempt = reach(pose, target, help_, person, camera, board, rng)
            pose = attempt.end
            rows.append(
                {
                    "kind": "simulated",
                    "variant": trial.variant,
                    "person": trial.person,
                    "help": help_,
                    "pose": count,
                    "seconds": round(attempt.seconds, 3),
                    "looks": attempt.looks,
                    "reached": int(attempt.reached),
                }
            )
    return rows


def targets_of(seed: int, camera: Camera, board: Board, count: int = POSES) -> list[Pose]:
    """Random valid poses, the same for everybody and every help."""
    space = Space(board, camera, Limits.for_board(board, camera))
    rng = np.random.default_rng([seed, 0])
    return [Pose.from_vector(random_pose(space, rng)) for _ in range(count)]


def table3_trials(
    seed: int,
    people: int = PEOPLE,
    assumptions: Assumptions | None = None,
    sensitivity: bool = True,
) -> list[Table3Trial]:
    """Everybody as assumed; then with each assumption halved and doubled."""
    usual = Assumptions() if assumptions is None else assumptions
    variants = {_AS_ASSUMED: usual}
    if sensitivity:
        variants |= {f"{_FLIP}{chance:g}": replace(usual, axes_flip=chance) for chance in FLIPS}
        for name in (f.name for f in fields(usual) if not f.name.startswith("outline")):
            for word, factor in (("halved", 0.5), ("doubled", 2.0)):
                changed = {name: getattr(usual, name) * factor}
                variants[f"{name} {word}"] = replace(usual, **changed)
    return [
        Table3Trial(seed, person, changed, variant)
        for variant, changed in variants.items()
        for person in range(1, people + 1)
    ]


def reduction(rows: Sequence[Row], variant: str = _AS_ASSUMED) -> float:
    """Relative reduction of the total time over all people, "steps" compared with "axes"."""
    steps, axes = (
        sum(float(r["seconds"]) for r in rows if r["help"] == help_ and r["variant"] == variant)
        for help_ in ("steps", "axes")
    )
    return 1 - steps / axes


def table3_text(rows: Sequence[Row]) -> str:
    """Readable tables: the times beside the paper's, and the sensitivity."""
    usual = [row for row in rows if row["variant"] == _AS_ASSUMED]
    people = sorted({int(row["person"]) for row in usual})
    lines = [_times_line(help_, usual, people) for help_ in HELPS]
    for help_, times in PAPER_S.items():
        cells = [minutes(t) for t in times[: len(people)]]
        cells += ["-"] * (len(people) - len(cells))
        lines.append((_PAPER_SAID[help_], *cells, f"{np.mean(times):.0f}", "-", "-"))
    headings = ("help", *(f"person {n}" for n in people), "mean (s)", "looks a pose", "not reached")
    paper = 1 - sum(PAPER_S["steps"]) / sum(PAPER_S["axes"])
    return "\n\n".join(
        [
            "SIMULATED PEOPLE, no measurement: time for ten poses from the first on (m:ss)",
            table(headings, lines),
            f"With these assumptions the steps take {_told(reduction(usual))} than the axes. The "
            f"paper's people: {_told(paper)} by its table, 24.2 % by its text.",
            *_sensitivity(rows),
        ]
    )


_PAPER_SAID: dict[Help, str] = {
    "axes": "paper, Pose selection",
    "steps": "paper, Pose decomposition",
}
_SAID: dict[Help, str] = {
    "steps": "simulated, decomposed steps",
    "axes": "simulated, axes overlay",
    "outline": "simulated, filled outline",
    "perfect": "simulated, perfect knowledge",
}


def _times_line(help_: Help, rows: Sequence[Row], people: Sequence[int]) -> tuple[str, ...]:
    mine = [row for row in rows if row["help"] == help_]
    totals = [sum(float(r["seconds"]) for r in mine if r["person"] == n) for n in people]
    looks = float(np.mean([float(r["looks"]) for r in mine]))
    missed = sum(not r["reached"] for r in mine)
    return (
        _SAID[help_],
        *(minutes(total) for total in totals),
        f"{np.mean(totals):.0f}",
        f"{looks:.1f}",
        str(missed),
    )


def _sensitivity(rows: Sequence[Row]) -> list[str]:
    """Change of the result with each assumption, the most decisive first."""
    variants = {str(row["variant"]) for row in rows}
    names = {v.removesuffix(" halved") for v in variants if v.endswith(" halved")}
    if not names:
        return []
    ends = {n: (reduction(rows, f"{n} halved"), reduction(rows, f"{n} doubled")) for n in names}
    ordered = sorted(ends, key=lambda n: (-abs(ends[n][1] - ends[n][0]), n))
    lines = [(n, _signed(-ends[n][0]), _signed(-ends[n][1])) for n in ordered]
    chances = [f"{_FLIP}{chance:g}" for chance in FLIPS]
    flips = [
        (v.removeprefix(_FLIP), _signed(-reduction(rows, v)), _mean_s(rows, v)) for v in chances
    ]
    return [
        "What that hangs on: time with steps against axes when one assumption changes (simulated)",
        table(("assumption", "halved", "doubled"), lines),
        "The most open question, how often a tilt is read the wrong way round from the axes "
        f"(simulated; the paper's people took {np.mean(PAPER_S['axes']) / (POSES - 1):.0f} s a "
        "pose with the axes)",
        table(("chance", "steps against axes", "seconds a pose with axes"), flips),
    ]


def _mean_s(rows: Sequence[Row], variant: str) -> str:
    axes = [float(r["seconds"]) for r in rows if r["variant"] == variant and r["help"] == "axes"]
    return f"{np.mean(axes):.1f}"


def _told(reduced: float) -> str:
    return f"{100 * abs(reduced):.1f} % {'less' if reduced > 0 else 'more'} time"


def _signed(share: float) -> str:
    return f"{100 * share:+.1f} %"
