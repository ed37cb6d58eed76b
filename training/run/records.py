"""Records of a run: its folder, log, curves, and facts for files.

The log is written before the state of the run. A crash may therefore leave steps in it that are
lost, which are cut off on resuming.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from motion.arrays import Floats
from motion.errors import InputError
from motion.files import replacing, write_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from training.config import TrainingConfig
    from training.run.loop import Trained


class RunFolder:
    """The paths of a run.

    Attributes
    ----------
    root : Path
        The folder.
    checkpoint : Path
        The state from which the run resumes.
    best : Path
        The best weights on held-out examples.
    log : Path
        The log: one JSON object per line, a `LogLine`.
    curves : Path
        The log as a picture.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.checkpoint = root / "checkpoint.safetensors"
        self.best = root / "best.safetensors"
        self.log = root / "log.jsonl"
        self.curves = root / "curves.png"


def run_folder(out: Path) -> Path:
    """Return the folder of the run that writes the network to `out`."""
    return out.with_suffix(".run")


LogLine = Mapping[str, Any]
"""``step`` (steps made), and either ``learning_rate``, ``loss`` and its parts, or ``held_out`` with
the validation after that step."""


class RunLog:
    """The lines of a run, and their file.

    Parameters
    ----------
    path : Path
        The file; need not exist for a new run.
    steps : int
        Number of steps made; later ones in the file are ignored.

    Raises
    ------
    InputError
        If the file lacks some of these steps.
    """

    def __init__(self, path: Path, *, steps: int) -> None:
        self._path = path
        texts = path.read_text("utf-8").splitlines() if path.exists() else []
        lines: list[LogLine] = [json.loads(text) for text in texts]
        self.lines = [line for line in lines if line["step"] <= steps]
        logged = int(self.lines[-1]["step"]) if self.lines else 0
        if logged != steps:
            raise InputError(
                f"the log holds {logged} of the {steps} steps that were made",
                where=path,
                remedy="Put the log back, or start again in another folder",
            )

    @property
    def ends_in_validation(self) -> bool:
        """Whether the last step was followed by a validation."""
        return bool(self.lines) and "held_out" in self.lines[-1]

    @property
    def last_loss(self) -> float:
        """Loss of the last step; there must be one."""
        return next(float(line["loss"]) for line in reversed(self.lines) if "loss" in line)

    def save(self) -> None:
        """Write the file."""
        write_text(self._path, "".join(f"{json.dumps(line)}\n" for line in self.lines))


_PACKAGES: Final = ("motionjury", "numpy", "safetensors", "scipy", "torch", "transformers")


def run_facts(
    config: TrainingConfig, trained: Trained[Any], data: Mapping[str, Any]
) -> dict[str, Any]:
    """Return facts about a network's training and data, as JSON values."""
    return {
        "config": config.facts(),
        "best_step": trained.best.step,
        "held_out": dict(trained.best.measured),
        "data": dict(data),
        "versions": {name: metadata.version(name) for name in _PACKAGES},
    }


_COLUMNS: Final = 3
_PALE, _DARK, _HELD_OUT = "#c9d6e4", "#31597f", "#b3541e"


def draw_curves(lines: Sequence[LogLine], path: Path, *, kept_step: int | None = None) -> None:
    """Draw the measures in the log of a run to the PNG file `path`, the loss first.

    A line marks `kept_step`, whose weights are kept. Equal logs give equal bytes.
    """
    # matplotlib takes a second to load, and a run draws only when it saves.
    from matplotlib.figure import Figure
    from matplotlib.ticker import EngFormatter

    learned = _series([line for line in lines if "held_out" not in line])
    held_out = _series([{"step": n["step"], **n["held_out"]} for n in lines if "held_out" in n])
    names = list({"loss": None, **learned, **held_out})
    rows = -(-len(names) // _COLUMNS)
    figure = Figure(figsize=(12, 3 * rows), dpi=100, layout="constrained")
    for number, name in enumerate(names, start=1):
        axes = figure.add_subplot(rows, _COLUMNS, number)
        if name in learned:
            _draw_learned(axes, learned[name])
        if name in held_out:
            marker = "o" if held_out[name].shape[1] <= 60 else ""
            axes.plot(*held_out[name], color=_HELD_OUT, marker=marker, label="held out")
        if kept_step is not None:
            axes.axvline(kept_step, color=_HELD_OUT, linestyle=":", label="kept")
        chooses = " (chooses the weights)" if name == next(iter(held_out), "") else ""
        axes.set_title(f"{name.replace('_', ' ')}{chooses}", fontsize=10)
        axes.xaxis.set_major_formatter(EngFormatter(sep=""))
        if number == 1:
            axes.set_xlabel("step")
            axes.legend(frameon=False)
    with replacing(path) as draft:
        figure.savefig(draft, metadata={"Software": None})


def _series(lines: Sequence[LogLine]) -> dict[str, Floats]:
    """Return steps and values (2, n) of each name, in the order of their first line."""
    names = {name: None for line in lines for name in line if name != "step"}
    return {
        name: np.array([(line["step"], line[name]) for line in lines if name in line], float).T
        for name in names
    }


def _draw_learned(axes: Axes, values: Floats) -> None:
    """Draw a measure of each step, and its running mean."""
    if 0 < 20 * values[1].min() < values[1].max():
        axes.set_yscale("log")
    axes.plot(*values, color=_PALE, label="each step")
    width = max(1, values.shape[1] // 20)
    means = [np.convolve(each, np.full(width, 1 / width), mode="valid") for each in values]
    axes.plot(*means, color=_DARK, label=f"mean of {width} steps")
