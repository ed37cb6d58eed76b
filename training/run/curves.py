"""A picture of a run: training losses, the learning rate, and held-out measures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from motion.files import replacing
from training.run.records import LogLine

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FloatArray = NDArray[np.float64]

_COLUMNS: Final = 3
_LOSS, _SMALL = 4.0, 2.2
_PALE, _DARK, _HELD_OUT = "#c9d6e4", "#31597f", "#b3541e"


def draw_curves(lines: Sequence[LogLine], path: Path, *, kept_step: int | None = None) -> None:
    """Draw the log of a run to the PNG file `path`.

    The loss is drawn large, with the learning rate and all other measures small below it. A line
    marks the step whose weights are `kept_step`. Equal logs make equal bytes.
    """
    # Drawing takes a second to load, and a run draws only when it saves.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import EngFormatter, MaxNLocator

    learned = _series([line for line in lines if "held_out" not in line])
    held_out = _series([{"step": n["step"], **n["held_out"]} for n in lines if "held_out" in n])
    small = [name for name in {**learned, **held_out} if name != "loss"]
    chosen_by = next(iter(held_out), "")
    rows = -(-len(small) // _COLUMNS)
    height = _LOSS + _SMALL * rows
    figure = Figure(figsize=(9, height), dpi=100)
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(
        rows + 1,
        _COLUMNS,
        height_ratios=[_LOSS, *([_SMALL] * rows)],
        left=0.08,
        right=0.98,
        top=1 - 0.3 / height,
        bottom=0.5 / height,
        hspace=0.9 * (rows + 1) / height,
        wspace=0.3,
    )
    cells = [grid[0, :], *(grid[1 + n // _COLUMNS, n % _COLUMNS] for n in range(len(small)))]
    for name, cell in zip(["loss", *small], cells, strict=True):
        axes = figure.add_subplot(cell)
        _draw(
            axes,
            learned.get(name),
            held_out.get(name),
            kept_step,
            linear=name.startswith("learning_rate"),
        )
        chooses = " (chooses the weights)" if name == chosen_by else ""
        axes.set_title(f"{name.replace('_', ' ')}{chooses}", fontsize=10, loc="left")
        axes.spines[["top", "right"]].set_visible(False)
        axes.tick_params(labelsize=8, which="both")
        axes.margins(x=0.01)
        axes.xaxis.set_major_locator(MaxNLocator(8 if name == "loss" else 4, integer=True))
        axes.xaxis.set_major_formatter(EngFormatter(sep=""))
        if name == "loss":
            axes.set_xlabel("step", fontsize=9)
            axes.legend(frameon=False, fontsize=9)
    with replacing(path) as draft:
        figure.savefig(draft, metadata={"Software": None})


def _series(lines: Sequence[LogLine]) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return steps and values of each name, in the order of their first line."""
    names = {name: None for line in lines for name in line if name != "step"}
    return {name: _points(name, lines) for name in names}


def _points(name: str, lines: Sequence[LogLine]) -> tuple[FloatArray, FloatArray]:
    points = [(line["step"], line[name]) for line in lines if name in line]
    steps, values = np.array(points, dtype=np.float64).T
    return steps, values


def _draw(
    axes: Axes,
    learned: tuple[FloatArray, FloatArray] | None,
    held_out: tuple[FloatArray, FloatArray] | None,
    kept_step: int | None,
    *,
    linear: bool,
) -> None:
    """Draw one measure: of the steps, of held-out examples, or both."""
    if learned is not None and not linear and 0 < 20 * learned[1].min() < learned[1].max():
        axes.set_yscale("log")
    if learned is not None and linear:
        axes.plot(*learned, color=_DARK, linewidth=1.2)
    elif learned is not None:
        _draw_steps(axes, *learned)
    if held_out is not None:
        mark_points = len(held_out[0]) <= 60
        axes.plot(
            *held_out,
            color=_HELD_OUT,
            linewidth=1.2,
            marker="o" if mark_points else "",
            markersize=3,
            label="held out",
        )
    if kept_step is not None:
        axes.axvline(kept_step, color=_HELD_OUT, linewidth=0.8, linestyle=":", label="kept")


def _draw_steps(axes: Axes, steps: FloatArray, values: FloatArray) -> None:
    """Draw what every step gave, and its course."""
    axes.plot(steps, values, color=_PALE, linewidth=0.8, label="each step")
    width = max(1, len(steps) // 20)
    course = np.convolve(values, np.full(width, 1 / width), mode="valid")
    middle = np.convolve(steps, np.full(width, 1 / width), mode="valid")
    axes.plot(middle, course, color=_DARK, linewidth=1.2, label=f"mean of {width} steps")
