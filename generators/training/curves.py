"""A run's losses as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from generators.training.run_folder import LogLine
from motion.files import replacing


def draw_curves(lines: Sequence[LogLine], path: Path) -> None:
    """Draw the loss of every step, and of held-out examples, to the PNG file `path`.

    Equal logs make equal bytes.
    """
    # Drawing takes a second to load, and a run draws only when it saves.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4), dpi=100)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.13, 0.13, 0.85, 0.84))
    axes.plot(
        [line["step"] for line in lines],
        [line["loss"] for line in lines],
        color="#8aa5c0",
        linewidth=0.8,
        label="training",
    )
    validated = [line for line in lines if "held_out" in line]
    axes.plot(
        [line["step"] for line in validated],
        [line["held_out"]["loss"] for line in validated],
        color="#b3541e",
        marker="o",
        markersize=3,
        label="held out",
    )
    axes.set_xlabel("step")
    axes.set_ylabel("loss")
    if min(line["loss"] for line in lines) > 0:
        axes.set_yscale("log")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    with replacing(path) as draft:
        figure.savefig(draft, metadata={"Software": None})
