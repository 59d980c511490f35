"""The figures for slides: mean and spread of the logarithms, with labelled lines."""

from __future__ import annotations

import io
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from venus3d.storage.products import write_product
from venus3d.study.figures import FIRST_VIEWS, INDICATORS, Figure, logarithms
from venus3d.study.runner import Row, needed
from venus3d.study.simulated import ARMS

# Okabe and Ito's vermilion and blue: distinguishable by everybody, and in grey.
_COLOURS = ("#D55E00", "#0072B2")
FIGURE = "a study's figure"
"""The kind of product that a figure's files are."""
_INK, _QUIET = "#222222", "#777777"


def pyplot() -> Any:
    """Matplotlib without a screen. Raises `VenusError` where it is not installed."""
    needed("matplotlib", "study").use("Agg")
    return import_module("matplotlib.pyplot")


def draw_figure(rows: Sequence[Row], figure: Figure, directory: Path) -> tuple[Path, Path]:
    """Write both files of a figure (`figure_files`). Raises `StorageError`, and `VenusError`
    without matplotlib."""
    plt = pyplot()
    with plt.rc_context(
        {
            "font.size": 12,
            "font.family": "DejaVu Sans",
            "svg.hashsalt": "venus3d",
            "svg.fonttype": "none",
            "text.color": _INK,
            "axes.labelcolor": _INK,
        }
    ):
        canvas, panels = plt.subplots(2, 2, figsize=(13.33, 7.5), layout="constrained")
        canvas.get_layout_engine().set(rect=(0, 0, 1, 0.865), w_pad=0.12, h_pad=0.1)
        for panel, indicator in zip(panels.flat, figure.indicators, strict=True):
            _panel(panel, rows, figure, indicator)
        canvas.text(0.012, 0.975, figure.title, fontsize=18, fontweight="bold", va="top")
        canvas.text(0.012, 0.918, _subtitle(rows, figure), fontsize=12, color=_QUIET, va="top")
        try:
            png, svg = (_drawn(canvas, kind) for kind in ("png", "svg"))
        finally:
            plt.close(canvas)
    png_file, svg_file = figure_files(figure, directory)
    return write_product(png_file, png, FIGURE), write_product(svg_file, svg, FIGURE)


def figure_files(figure: Figure, directory: Path) -> tuple[Path, Path]:
    """`figureN.png` and `figureN.svg`."""
    stem = f"figure{figure.number}"
    return directory / f"{stem}.png", directory / f"{stem}.svg"


def _subtitle(rows: Sequence[Row], figure: Figure) -> str:
    repeats = len({row["repeat"] for row in rows})
    told = f"The paper: {figure.claim}.   " if figure.claim else ""
    over = f"Mean of {repeats} repeats, ± one standard deviation" if repeats > 1 else "One repeat"
    return f"{told}{over}; smaller is better."


def _panel(panel: Any, rows: Sequence[Row], figure: Figure, indicator: str) -> None:
    ends: list[float] = []
    last = 0
    for arm, colour in zip(figure.arms, _COLOURS, strict=True):
        values = logarithms(rows, arm, indicator)[:, FIRST_VIEWS - 1 :]
        views = np.arange(FIRST_VIEWS, FIRST_VIEWS + values.shape[1])
        mean, spread = np.nanmean(values, axis=0), np.nanstd(values, axis=0)
        panel.fill_between(views, mean - spread, mean + spread, color=colour, alpha=0.16, lw=0)
        panel.plot(views, mean, color=colour, lw=2.4, solid_capstyle="round")
        ends.append(float(mean[-1]))
        last = int(views[-1])
    panel.set_title(INDICATORS[indicator], loc="left", color=_INK)
    unit = "" if indicator == "sum_iod" else " (px)"
    panel.set_ylabel(f"ln {INDICATORS[indicator].split(',')[0]}{unit}")
    panel.set_xlabel("views")
    ticks = [FIRST_VIEWS, *range(5, last + 1, 5)] if last > 8 else range(FIRST_VIEWS, last + 1)
    panel.set_xticks(list(ticks))
    panel.set_xlim(FIRST_VIEWS, last)
    panel.spines[["top", "right"]].set_visible(False)
    panel.spines[["left", "bottom"]].set_color(_QUIET)
    panel.tick_params(colors=_QUIET, labelcolor=_INK)
    panel.grid(axis="y", color="#e6e6e6", lw=0.8)
    panel.set_axisbelow(True)
    _label_lines(panel, figure, ends, last)


def _label_lines(panel: Any, figure: Figure, ends: Sequence[float], last: int) -> None:
    """Labels at the lines' ends, moved apart where they would overlap."""
    low, high = panel.get_ylim()
    least = 0.09 * (high - low)
    upper, lower = (0, 1) if ends[0] >= ends[1] else (1, 0)
    push = max(0.0, least - (ends[upper] - ends[lower])) / 2
    for index, place in ((upper, ends[upper] + push), (lower, ends[lower] - push)):
        panel.annotate(
            ARMS[figure.arms[index]].label,
            (last, place),
            xytext=(8, 0),
            textcoords="offset points",
            va="center",
            color=_COLOURS[index],
            fontweight="bold",
            annotation_clip=False,
        )


def _drawn(canvas: Any, kind: str) -> bytes:
    buffer = io.BytesIO()
    metadata = {"Date": None} if kind == "svg" else {}  # reproducible files
    canvas.savefig(buffer, format=kind, dpi=150, facecolor="white", metadata=metadata)
    return buffer.getvalue()
