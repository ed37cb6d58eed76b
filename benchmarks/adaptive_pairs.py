"""Adaptive pairs compared with even and random ones: a figure, and its numbers.

``python -m benchmarks.adaptive_pairs FIGURE.png`` simulates tournaments of conditions with known
strengths, plots how well their order and strengths are known after each number of answers, and
prints the same numbers. The last lines are ``name: value``.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from types import MappingProxyType
from typing import Final, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.stats import kendalltau

from motion.files import replacing
from studyapp.study.design.adaptive import Pair, most_informative_pairs, posterior
from studyapp.study.design.allocation import shuffled

Choice = Literal["adaptive", "even", "random"]
"""How pairs are chosen: by the value of an answer; in turn along a ring in random order, as
``comparisons = "all_pairs"`` does; or independently and uniformly at random."""

CHOICES: Final[tuple[Choice, ...]] = ("adaptive", "even", "random")

TRIALS: Final = 12
"""Pairs per participant."""

CONDITIONS: Final = 10
STRENGTH_SDS: Final = (1.0, 2.0)
"""Spreads of the strengths, in logits: similar systems, or from a still figure to a recording."""
PARTICIPANTS: Final = 60
REPETITIONS: Final = 60
SHOWN_AT: Final = (5, 10, 20, 40, 60)
KNOWN: Final = 0.85
"""Kendall's τ at which an order counts as known."""

_COLOURS: Final[Mapping[Choice, str]] = MappingProxyType(
    {"adaptive": "#0b6e99", "even": "#b5651d", "random": "#777777"}
)

_TITLES: Final = ("How well the order is known (Kendall's τ)", "Error of the strengths (logits)")

Curves = Mapping[Choice, NDArray[np.float64]]
"""Tournaments × participants × (τ, error), by choice."""


def tournament(
    strengths: NDArray[np.float64], *, choice: Choice, participants: int, seed: int
) -> Iterator[tuple[float, float]]:
    """Yield the accuracy after each of `participants`, who answer `TRIALS` pairs each.

    Their answers follow a Bradley–Terry model. All ways of choosing pairs get the same conditions
    and as many answers, and are judged by the same posterior.

    Parameters
    ----------
    strengths : ndarray, shape (C,)
        The true strengths, in logits.
    choice : {'adaptive', 'even', 'random'}
        How pairs are chosen.
    participants : int
        Number of participants.
    seed : int
        Seed of the pairs and the answers.

    Yields
    ------
    tuple of (float, float)
        Kendall's rank correlation of the estimated with the true strengths, and the root mean
        square error of the strengths around their mean, in logits.
    """
    chance = np.random.default_rng(seed)
    names = [str(index) for index in range(len(strengths))]
    ring = shuffled(list(combinations(names, 2)), chance)
    votes: dict[Pair, float] = {}
    for number in range(participants):
        for a, b in _pairs(names, ring, number, votes, chance, choice):
            gap = strengths[int(a)] - strengths[int(b)]
            winner = (a, b) if chance.random() < 1 / (1 + np.exp(-gap)) else (b, a)
            votes[winner] = votes.get(winner, 0.0) + 1
        estimate, _ = posterior(names, votes)
        difference = (estimate - estimate.mean()) - (strengths - strengths.mean())
        tau = float(kendalltau(estimate, strengths).statistic)
        yield tau, float(np.sqrt(np.mean(difference**2)))


def _pairs(
    names: Sequence[str],
    ring: Sequence[Pair],
    number: int,
    votes: dict[Pair, float],
    chance: np.random.Generator,
    choice: Choice,
) -> list[Pair]:
    """Return the pairs that participant `number` answers."""
    if choice == "adaptive":
        return most_informative_pairs(names, votes, TRIALS, chance)
    if choice == "even":
        return [ring[(number * TRIALS + step) % len(ring)] for step in range(TRIALS)]
    return [ring[index] for index in chance.integers(len(ring), size=TRIALS)]


def simulate(
    *,
    strength_sd: float,
    repetitions: int = REPETITIONS,
    participants: int = PARTICIPANTS,
    conditions: int = CONDITIONS,
) -> Curves:
    """Return the accuracy after each participant of many tournaments, by choice.

    Returns
    -------
    mapping of choice to ndarray, shape (repetitions, participants, 2)
        Kendall's τ with the true order, and the root mean square error in logits.
    """
    curves: dict[Choice, list[list[tuple[float, float]]]] = {choice: [] for choice in CHOICES}
    for seed in range(repetitions):
        strengths = np.random.default_rng([seed, 1]).normal(0, strength_sd, conditions)
        for choice, runs in curves.items():
            known = tournament(strengths, choice=choice, participants=participants, seed=seed)
            runs.append(list(known))
    return {choice: np.array(runs) for choice, runs in curves.items()}


def answers_needed(curve: NDArray[np.float64]) -> int | None:
    """Return the number of answers at which a choice's mean τ reaches `KNOWN`; None if never."""
    reached = np.flatnonzero(curve[..., 0].mean(axis=0) >= KNOWN)
    return int(reached[0] + 1) * TRIALS if reached.size else None


def draw(curves: Mapping[float, Curves], path: Path) -> None:
    """Draw means with bands of two standard errors, one row per spread of strengths."""
    with mpl.rc_context({"font.size": 9}):
        figure = Figure(figsize=(9, 3.2 * len(curves)), layout="constrained")
        axes = figure.subplots(len(curves), 2, squeeze=False)
        for row, (strength_sd, of_spread) in zip(axes, curves.items(), strict=True):
            for what, (each, title) in enumerate(zip(row, _TITLES, strict=True)):
                _draw_curves(each, of_spread, what)
                each.set_title(f"{title}, strengths of SD {strength_sd:g}")
            row[0].axhline(KNOWN, color="black", lw=0.6, ls=":")
        axes[0][0].legend(title="pairs chosen", loc="lower right")
        with replacing(path) as draft:
            figure.savefig(draft, format=path.suffix.removeprefix("."), dpi=110)


def _draw_curves(axes: Axes, curves: Curves, what: int) -> None:
    for choice, curve in curves.items():
        values = curve[..., what]
        mean = values.mean(axis=0)
        around = 2 * values.std(axis=0, ddof=1) / np.sqrt(len(values))
        answers = TRIALS * np.arange(1, len(mean) + 1)
        axes.plot(answers, mean, color=_COLOURS[choice], label=choice)
        axes.fill_between(
            answers, mean - around, mean + around, color=_COLOURS[choice], alpha=0.15, lw=0
        )
    axes.set_xlabel("answers")
    axes.grid(alpha=0.3)


def report(curves: Mapping[float, Curves]) -> str:
    """Return the numbers of the figure as text."""
    lines = []
    for strength_sd, of_spread in curves.items():
        lines.append(f"strengths of SD {strength_sd:g}")
        lines.append("answers" + "".join(f"{f'τ {c}':>12}{f'error {c}':>16}" for c in of_spread))
        participants = next(iter(of_spread.values())).shape[1]
        for number in (n for n in SHOWN_AT if n <= participants):
            means = [curve[:, number - 1].mean(axis=0) for curve in of_spread.values()]
            cells = "".join(f"{tau:12.3f}{error:16.3f}" for tau, error in means)
            lines.append(f"{number * TRIALS:7}{cells}")
    for strength_sd, of_spread in curves.items():
        for choice, curve in of_spread.items():
            needed = answers_needed(curve)
            name = f"answers_until_known_{choice}_sd_{strength_sd:g}"
            lines.append(f"{name}: {'never' if needed is None else needed}")
    return "\n".join(lines)


def main() -> None:
    """Simulate, draw and print."""
    curves = {strength_sd: simulate(strength_sd=strength_sd) for strength_sd in STRENGTH_SDS}
    draw(curves, Path(sys.argv[1]))
    print(report(curves))


if __name__ == "__main__":
    main()
