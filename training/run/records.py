"""Records of a run: its folder, log, curves, and facts for files.

The log is only appended to, so that a long run saves as quickly as a short one. It is written
before the state of the run. A crash may therefore leave steps in it that are lost, which are cut
off on resuming.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from motion.arrays import Floats
from motion.errors import InputError
from motion.files import replacing

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
        self._lines: list[LogLine] = []
        self._saved_bytes = 0
        self._unsaved: list[LogLine] = []
        if path.exists():
            self._read(steps)
        logged = self.steps
        if logged != steps:
            raise InputError(
                f"the log holds {logged} of the {steps} steps that were made",
                where=path,
                remedy="Put the log back, or start again in another folder",
            )

    @property
    def lines(self) -> Sequence[LogLine]:
        """All lines, in order of steps."""
        return self._lines

    @property
    def steps(self) -> int:
        """The number of steps in the log."""
        return int(self._lines[-1]["step"]) if self._lines else 0

    @property
    def ends_in_validation(self) -> bool:
        """Whether the last step was followed by a validation."""
        return bool(self._lines) and "held_out" in self._lines[-1]

    @property
    def last_loss(self) -> float:
        """Loss of the last step; there must be one."""
        return next(float(line["loss"]) for line in reversed(self._lines) if "loss" in line)

    def add(self, line: LogLine) -> None:
        """Add a line."""
        self._lines.append(line)
        self._unsaved.append(line)

    def save(self) -> None:
        """Append new lines to the file, and sync it to disk."""
        content = "".join(f"{json.dumps(line)}\n" for line in self._unsaved).encode()
        with self._path.open("r+b" if self._path.exists() else "xb") as file:
            # Cuts off what a crash left after the valid lines.
            file.truncate(self._saved_bytes)
            file.seek(self._saved_bytes)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        self._saved_bytes += len(content)
        self._unsaved.clear()

    def _read(self, steps: int) -> None:
        """Read the lines up to `steps`, or up to a line that a crash cut off."""
        with self._path.open("rb") as file:
            for content in file:
                try:
                    line = json.loads(content)
                except ValueError:
                    return
                if not content.endswith(b"\n") or line["step"] > steps:
                    return
                self._lines.append(line)
                self._saved_bytes += len(content)


_PACKAGES: Final = ("motionjury", "numpy", "safetensors", "scipy", "torch")


def package_versions(*extra: str) -> dict[str, str]:
    """Return the versions of the packages that every training uses, and of `extra` packages."""
    return {name: metadata.version(name) for name in (*_PACKAGES, *extra)}


def run_facts(
    config: TrainingConfig,
    trained: Trained[Any],
    kind: str,
    data_sha256: str,
    packages: Sequence[str] = (),
) -> dict[str, Any]:
    """Return facts about a network's training and data, as JSON values.

    Parameters
    ----------
    config : TrainingConfig
        The settings.
    trained : Trained
        The result.
    kind : str
        The recordings' layout.
    data_sha256 : str
        Hash of the recordings.
    packages : sequence of str
        Further packages whose versions are recorded.
    """
    return {
        "config": config.facts(),
        "best_step": trained.best.step,
        "held_out": dict(trained.best.measured),
        "data": {"kind": kind, "sha256": data_sha256},
        "versions": package_versions(*packages),
    }


_COLUMNS: Final = 3
_LOSS, _SMALL = 4.0, 2.2
_PALE, _DARK, _HELD_OUT = "#c9d6e4", "#31597f", "#b3541e"


def draw_curves(lines: Sequence[LogLine], path: Path, *, kept_step: int | None = None) -> None:
    """Draw the log of a run to the PNG file `path`.

    The loss is large, with the learning rate and all other measures small below it. A line marks
    `kept_step`, whose weights are kept. Equal logs give equal bytes.
    """
    # matplotlib takes a second to load, and a run draws only when it saves.
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


def _series(lines: Sequence[LogLine]) -> dict[str, Floats]:
    """Return steps and values (2, n) of each name, in the order of their first line."""
    names = {name: None for line in lines for name in line if name != "step"}
    return {
        name: np.array([(line["step"], line[name]) for line in lines if name in line], float).T
        for name in names
    }


def _draw(
    axes: Axes,
    learned: Floats | None,
    held_out: Floats | None,
    kept_step: int | None,
    *,
    linear: bool,
) -> None:
    """Draw a measure of the training steps, of held-out examples, or of both."""
    if learned is not None and linear:
        axes.plot(*learned, color=_DARK, linewidth=1.2)
    elif learned is not None:
        if 0 < 20 * learned[1].min() < learned[1].max():
            axes.set_yscale("log")
        axes.plot(*learned, color=_PALE, linewidth=0.8, label="each step")
        width = max(1, learned.shape[1] // 20)
        weights = np.full(width, 1 / width)
        means = (np.convolve(values, weights, mode="valid") for values in learned)
        axes.plot(*means, color=_DARK, linewidth=1.2, label=f"mean of {width} steps")
    if held_out is not None:
        axes.plot(
            *held_out,
            color=_HELD_OUT,
            linewidth=1.2,
            marker="o" if held_out.shape[1] <= 60 else "",
            markersize=3,
            label="held out",
        )
    if kept_step is not None:
        axes.axvline(kept_step, color=_HELD_OUT, linewidth=0.8, linestyle=":", label="kept")
