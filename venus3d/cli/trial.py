"""`venus3d trial`: time one volunteer, then print the times of all participants."""

from __future__ import annotations

import json
from collections.abc import Sequence
from statistics import median
from typing import Any

from venus3d.scene.pages.exercise import texts
from venus3d.scene.pages.exercise.html import clock
from venus3d.scene.pages.exercise.options import TrialOptions
from venus3d.scene.pages.exercise.run import run_trial
from venus3d.scene.pages.exercise.trial_plan import times_of
from venus3d.scene.pages.exercise.view_model import TRIAL_HELPS, Help
from venus3d.storage.exercise import ExerciseRow
from venus3d.storage.result import to_json


def trial(options: TrialOptions) -> None:
    """Run the trial and print the results.
    Raises `VenusError` for a user's mistake, `KeyboardInterrupt` if Ctrl-C came before any time."""
    result = run_trial(options)
    name = result.plan.participant
    if not result.complete:
        print(f"Not finished: go on with --participant {json.dumps(name, ensure_ascii=False)}.")
    if result.rows:
        print(times_table(result.rows))
    if not any(row.participant == name for row in result.rows):
        raise KeyboardInterrupt  # ended by Ctrl-C, nothing was saved
    print(f"Written: {result.path}")
    if options.json:
        times = {
            entry.help: {
                "median_s": median(entry.reached_s) if entry.reached_s else None,
                "total_s": entry.ends_s[-1] if entry.ends_s else None,
                "given_up": entry.given_up,
            }
            for entry in times_of(result.run)
        }
        summary: dict[str, Any] = {
            "participant": name,
            "order": result.plan.order,
            "complete": result.complete,
            "file": str(result.path),
            "helps": times,
        }
        print(to_json(summary))


def times_table(rows: Sequence[ExerciseRow]) -> str:
    """Table 3 of the paper for the participants: the time for all poses after the first, m:ss.

    A star marks a time with poses given up or moved by the simulated hand; a dash an unfinished
    help.
    """
    people = list(dict.fromkeys(row.participant for row in rows))
    cells = [
        [texts.TRIAL_HELP_NAMES[h], *(_total(rows, person, h) for person in people)]
        for h in TRIAL_HELPS
    ]
    lines = [["time after the first pose", *people], *cells]
    widths = [max(len(line[i]) for line in lines) for i in range(len(people) + 1)]
    text = "\n".join(
        "  ".join(
            cell.ljust(width) if i == 0 else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(line, widths, strict=True))
        )
        for line in lines
    )
    starred = any("*" in cell for line in cells for cell in line[1:])
    return text + ("\n* poses given up, or the simulated hand was at work" if starred else "")


def _total(rows: Sequence[ExerciseRow], person: str, help_: Help) -> str:
    mine = [row for row in rows if row.participant == person and row.help == help_]
    last = max((row.attempt for row in mine), default=0)
    mine = [row for row in mine if row.attempt == last]
    if not mine or mine[-1].pose != mine[-1].poses:
        return "–"
    doubtful = any(row.outcome != "reached" or row.moved_by != "person" for row in mine)
    return clock(round(mine[-1].since_first_s)) + ("*" if doubtful else "")
