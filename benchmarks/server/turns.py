"""Slowdown of requests under a load, in pairs of turns without and with it."""

import argparse
from dataclasses import dataclass, field

import numpy as np

from benchmarks.server.databases import BACKENDS


@dataclass
class Waits:
    """Durations of requests in seconds, turn by turn.

    Attributes
    ----------
    without, beside : list of list of float
        Durations of each turn without the load, and of the following one with it.
    """

    without: list[list[float]] = field(default_factory=list)
    beside: list[list[float]] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    @property
    def ratio(self) -> float:
        """The p99 with the load over that without it: the median over all pairs of turns.

        Other brief load on the machine affects few pairs.
        """
        return float(np.median(self._ratios))

    @property
    def _ratios(self) -> list[float]:
        pairs = zip(self.without, self.beside, strict=True)
        return [_p99_ms(beside) / _p99_ms(without) for without, beside in pairs]

    def print(self, where: str, what: str, *, total: str) -> None:
        """Print the p99 without and with `what`, and under the name `total` their ratio."""
        for name, turns in (("without", self.without), ("beside", self.beside)):
            p99 = np.median([_p99_ms(turn) for turn in turns])
            print(f"{where}_{name}_{what}_p99_ms: {p99:.1f}")
        print(f"{where}_{total}_p99_ratio: {self.ratio:.2f}")
        low, high = np.quantile(self._ratios, (0.25, 0.75))
        print(f"{where}_{total}_p99_ratio_quartiles: {low:.2f} to {high:.2f}")
        print(f"{where}_{total}_errors: {len(self.errors)}", flush=True)


def read_options(description: str, *, seconds: float) -> argparse.Namespace:
    """Read the length of a turn and the databases to measure."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--seconds", type=float, default=seconds, help="of each turn")
    parser.add_argument(
        "--database", choices=BACKENDS, action="append", help="measure only this one"
    )
    options = parser.parse_args()
    options.database = options.database or BACKENDS
    return options


def _p99_ms(seconds: list[float]) -> float:
    return 1000 * float(np.quantile(seconds, 0.99)) if seconds else float("nan")
