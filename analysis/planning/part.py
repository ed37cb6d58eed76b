"""The simulated parts of a study: trials, opinions, and the answers of many studies.

The latent difference of two conditions is the sum of an effect, a participant's and an item's
deviation, and logistic noise.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Final, Literal

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from scipy.special import expit, logit

from motion.arrays import Floats, Indices

Kind = Literal["pairs", "ratings", "rankings"]

THRESHOLDS: Final = (0.45, 1.6)
"""Latent differences, in logits, from which answers are slight, and clear."""

PREFERENCE_THRESHOLDS: Final = {2: (0.0,), 3: THRESHOLDS[:1], 5: THRESHOLDS}
"""Thresholds of a graded preference, by the number of its levels."""

RATING_THRESHOLDS: Final = (-1.6, -0.45, 0.45, 1.6)
"""Thresholds between five ratings on the latent scale."""


@dataclass(frozen=True, kw_only=True)
class Opinions:
    """How people are assumed to answer.

    Attributes
    ----------
    participant_sd, item_sd : float
        Standard deviation, over participants and over items, of the difference between two
        conditions, in logits.
    """

    participant_sd: float = 0.6
    item_sd: float = 0.45


@dataclass(frozen=True, kw_only=True, eq=False)
class Trials:
    """The analysed trials of all participants who are not excluded.

    Attributes
    ----------
    participants, items : ndarray of int, shape (N,)
        The participant and the item of each trial, numbered from 0.
    conditions : int
        Number of conditions; condition 0 differs from all others.
    left, right : ndarray of int, shape (N,), or None
        The conditions shown, for pairs; None if every trial shows all conditions.
    """

    participants: Indices
    items: Indices
    conditions: int
    left: Indices | None = None
    right: Indices | None = None

    @property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """All pairs of conditions; each pair is tested."""
        return tuple(combinations(range(self.conditions), 2))

    @cached_property
    def analysed(self) -> int:
        """Number of participants."""
        return len(np.unique(self.participants))

    @property
    def sides(self) -> tuple[Indices, Indices]:
        """The conditions shown on the left and on the right, for pairs."""
        if self.left is None or self.right is None:
            raise ValueError("trials of pairs need the conditions that they show")
        return self.left, self.right

    def of_pair(self, a: int, b: int) -> Indices:
        """Return the trials that show the conditions `a` and `b`."""
        if self.left is None:
            return np.arange(len(self.participants))
        low, high = np.sort(self.sides, axis=0)
        return np.flatnonzero((low == a) & (high == b))


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """Similar blocks of tests: the comparisons and questions of one part of a study.

    Attributes
    ----------
    name : str
        Name of the set, block or task; empty if a study has no parts.
    kind : {'pairs', 'ratings', 'rankings'}
        The way in which conditions are judged.
    trials : Trials
        The trials of one block.
    levels : int
        Points of the scale; 2, 3 or 5 for pairs.
    blocks : int
        Number of blocks that the report tests: one for each question of each comparison that has
        separate participants or motions.
    family : str
        Parts of one family are corrected together by Holm's method.
    """

    name: str
    kind: Kind
    trials: Trials
    levels: int
    blocks: int
    family: str

    @property
    def tests(self) -> int:
        """Tests of this part in the whole report."""
        return self.blocks * len(self.trials.pairs)


@dataclass(frozen=True, kw_only=True, eq=False)
class Size:
    """A study of one size.

    Attributes
    ----------
    participants : int
        Places of each comparison if comparisons have separate participants; else of the study.
    items : int
        Segments.
    recruited : int
        Places of the whole study.
    analysed : int
        Expected number of `participants` who are not excluded.
    trials : int
        Analysed trials of each participant.
    parts : tuple of Part
        The simulated parts.
    """

    participants: int
    items: int
    recruited: int
    analysed: int
    trials: int
    parts: tuple[Part, ...]

    @property
    def numbers(self) -> tuple[int, int]:
        """Participants and items, which identify a size within a plan."""
        return self.participants, self.items


POINTS: Final = len(RATING_THRESHOLDS) + 1
"""Points of the scale that `RATING_THRESHOLDS` divides."""

_NODES, _WEIGHTS = hermegauss(61)


def grade_preferences(latent: Floats, thresholds: Sequence[float] = THRESHOLDS) -> Floats:
    """Return the graded answer to a latent difference: below 0 for the second condition."""
    return np.asarray(np.sign(latent) * np.searchsorted(thresholds, np.abs(latent)), np.float64)


def simulate_answers(
    part: Part, opinions: Opinions, effect: float, studies: int, generator: np.random.Generator
) -> Floats:
    """Return the answers in one block of a part, for many simulated studies.

    Parameters
    ----------
    effect : float
        How much better condition 0 is than every other one, in logits.

    Returns
    -------
    ndarray, shape (studies, N) or (studies, N, conditions)
        For pairs, from -2 or -1 (the condition with the higher number is better) to 2 or 1 (the
        lower); for ratings, scores from 1; for rankings, ranks, 1 for the best.
    """
    trials = part.trials
    if part.kind == "pairs":
        latent = _differences(trials, opinions, effect, studies, generator)
        latent += generator.logistic(size=latent.shape)
        return grade_preferences(latent, PREFERENCE_THRESHOLDS[part.levels])
    worth = _worths(trials, opinions, effect, studies, generator)
    if part.kind == "rankings":
        worth += generator.gumbel(size=worth.shape)
        return np.asarray((-worth).argsort(axis=2).argsort(axis=2) + 1, np.float64)
    participants = opinions.participant_sd * _group_draws(
        trials.participants, studies, (), generator
    )
    items = opinions.item_sd * _group_draws(trials.items, studies, (), generator)
    worth += (participants + items)[..., None] + generator.logistic(size=worth.shape)
    return _rated(worth, part.levels)


def _worths(
    trials: Trials, opinions: Opinions, effect: float, studies: int, generator: np.random.Generator
) -> Floats:
    """Return the noiseless worth of each condition in each trial, (studies, N, conditions)."""
    worth = np.zeros((studies, len(trials.items), trials.conditions))
    worth[..., 0] = effect
    # The variance of a difference is twice that of one condition.
    for sd, codes in (
        (opinions.participant_sd, trials.participants),
        (opinions.item_sd, trials.items),
    ):
        worth += sd / math.sqrt(2) * _group_draws(codes, studies, (trials.conditions,), generator)
    return worth


def _group_draws(
    codes: Indices, studies: int, shape: tuple[int, ...], generator: np.random.Generator
) -> Floats:
    """Return a normal draw for each group, repeated for its trials."""
    draws = generator.standard_normal((studies, int(codes.max(initial=-1)) + 1, *shape))
    return np.asarray(draws[:, codes], np.float64)


def _differences(
    trials: Trials, opinions: Opinions, effect: float, studies: int, generator: np.random.Generator
) -> Floats:
    """Return how much better the condition with the lower number is, shape (studies, N)."""
    worth = _worths(trials, opinions, effect, studies, generator)
    rows = np.arange(len(trials.items))
    first, second = np.sort(trials.sides, axis=0)
    return np.asarray(worth[:, rows, first] - worth[:, rows, second], np.float64)


def rating_thresholds(levels: int) -> tuple[float, ...]:
    """Return the thresholds between the points of a rating scale, in logits.

    Those of a slider are stretched so that its outer fifths match the end points of a five-point
    scale.
    """
    if levels == POINTS:
        return RATING_THRESHOLDS
    stretch = RATING_THRESHOLDS[-1] / math.log(POINTS - 1)
    return tuple((stretch * logit((np.arange(1, levels) - 0.5) / (levels - 1))).tolist())


def _rated(latent: Floats, levels: int) -> Floats:
    return np.asarray(1 + np.searchsorted(rating_thresholds(levels), latent), np.float64)


def describe_effect(part: Part, opinions: Opinions, effect: float) -> str:
    """Return in words how people answer if one condition is better by `effect` logits."""
    spread = math.hypot(opinions.participant_sd, opinions.item_sd)
    if part.kind == "pairs":
        tie = PREFERENCE_THRESHOLDS[part.levels][0]
        wins = _mean(expit(effect + spread * _NODES - tie))
        losses = _mean(expit(-effect - spread * _NODES - tie))
        return f"{wins:.0%} wins, {losses:.0%} losses"
    if part.kind == "rankings":
        ahead = _mean(expit(effect + spread * _NODES))
        return f"ahead of another in {ahead:.0%} of rankings"
    # Variance of the participant's and the item's level, plus half that of a difference.
    wide = spread * math.sqrt(1.5)
    borders = np.array(rating_thresholds(part.levels))[:, None]

    def rated(worth: float) -> float:
        return _mean(expit(worth + wide * _NODES - borders).sum(axis=0))

    return f"rated {rated(effect) - rated(0.0):.2g} higher on {part.levels} points"


def _mean(values: Floats) -> float:
    return float(_WEIGHTS @ values / _WEIGHTS.sum())
