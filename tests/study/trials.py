"""Trials of known outcome that other processes can import."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.waiting import wait_until


@dataclass(frozen=True)
class Draw:
    """Some random numbers of a seed."""

    seed: int
    stop_at: str = ""
    """A file that, where it exists, makes the process die instead."""

    @property
    def key(self) -> str:
        return f"draw-{self.seed}"


def drawn(trial: Draw) -> list[dict[str, str | int | float]]:
    """Three rows; one number of them is a BLAS product, whose last digits may depend on threads."""
    if trial.stop_at and trial.seed == 5 and (bomb := Path(trial.stop_at)).exists():
        journal = bomb.with_name("rows.journal.jsonl")
        wait_until(lambda: "draw-3" in journal.read_text(), "the first trial is kept")
        os._exit(1)
    rng = np.random.default_rng(trial.seed)
    matrix = rng.standard_normal((64, 64))
    return [
        {"n": n, "value": float(rng.random()), "trace": float(np.trace(matrix @ matrix.T))}
        for n in range(3)
    ]
