"""Tables as Markdown, readable on a terminal and in documents."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table with aligned columns, the first one to the left."""
    columns = list(zip(headings, *rows, strict=True))
    widths = [max(3, *map(len, column)) for column in columns]

    def line(cells: Sequence[str]) -> str:
        first, *rest = zip(cells, widths, strict=True)
        padded = [first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in rest)]
        return f"| {' | '.join(padded)} |"

    rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
    return "\n".join([line(headings), line(rule), *map(line, rows)])


def mean_sd(values: Sequence[float], digits: int) -> str:
    """Mean ± sample standard deviation; the mean alone of a single value.
    A dash if there is no value, or one that is NaN."""
    if not len(values) or np.isnan(values).any():
        return "-"
    mean = f"{np.mean(values):.{digits}f}"
    if len(values) == 1:
        return mean
    with np.errstate(invalid="ignore"):
        return f"{mean} ± {np.std(values, ddof=1):.{digits}f}"


def minutes(seconds: float) -> str:
    """m:ss, as the paper's Table 3 gives times."""
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"
