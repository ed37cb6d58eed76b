"""Simulated studies with a known truth: preferences, ratings, votes and rankings."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray
from scipy.special import expit

from analysis.planning.part import RATING_THRESHOLDS, THRESHOLDS, grade_preferences

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


Process = Literal[
    "normal tastes", "heavy tails", "taste of items", "drift", "unequal exposure", "leaderboard"
]


@dataclass(frozen=True, kw_only=True)
class Design:
    """A study in which every participant answers about every item.

    Attributes
    ----------
    participants, items : int
        Number of each.
    effect : float
        How much better the first condition is than the second, in logits. Others are as good as the
        second.
    participant_sd, item_sd : float
        How much that difference varies between participants and between items, in logits.
    process : str
        How answers arise: with normally distributed tastes, as in a rehearsal; with heavy tails (t
        with 3 degrees of freedom); with an additional taste of each participant for each item; with
        tastes that drift while a participant answers; with very unequal numbers of answers, a third
        of them from one participant; or as on a leaderboard, with three answers per participant
        about conditions of which some are shown much more often than others.
    """

    participants: int
    items: int
    effect: float
    participant_sd: float
    item_sd: float
    process: Process = "normal tastes"

    @property
    def spread(self) -> float:
        """Standard deviation of the difference over participants and items together."""
        return math.hypot(self.participant_sd, self.item_sd)


@dataclass(frozen=True, kw_only=True)
class Preferences:
    """Answers to one comparison.

    Attributes
    ----------
    towards_first : ndarray of int, shape (N,)
        -2 (clearly the second condition) to 2 (clearly the first).
    side : ndarray, shape (N,)
        1 where the first condition was on the right, -1 where on the left.
    participants, items : ndarray of int, shape (N,)
        Participant and item of each answer.
    """

    towards_first: Codes
    side: Floats
    participants: Codes
    items: Codes

    @property
    def responses(self) -> Codes:
        """Answers as given: 1 (strongly left) to 5 (strongly right)."""
        return np.asarray(3 + self.side.astype(np.intp) * self.towards_first)

    @property
    def wins(self) -> Floats:
        """1 for a win of the first condition, one half for a tie, 0 for a loss."""
        return (np.sign(self.towards_first) + 1) / 2


@dataclass(frozen=True, kw_only=True)
class Judgements:
    """Participants' opinions of every condition, before they become answers.

    Attributes
    ----------
    worth : ndarray, shape (N, conditions)
        Worth of each condition for one participant and item, in logits, without noise.
    participants, items : ndarray of int, shape (N,)
        Participant and item of each judgement.
    """

    worth: Floats
    participants: Codes
    items: Codes


def crossed(design: Design) -> tuple[Codes, Codes]:
    """Return the participant and the item of each answer."""
    participants = np.repeat(np.arange(design.participants), design.items)
    return participants, np.tile(np.arange(design.items), design.participants)


def answered(design: Design, generator: np.random.Generator) -> tuple[Codes, Codes]:
    """Return the participant and the item of each answer under the process of `design`."""
    if design.process == "unequal exposure":
        often = np.arange(1, design.participants + 1) ** -1.2
        people = np.sort(
            generator.choice(
                design.participants, design.participants * design.items, p=often / often.sum()
            )
        )
    elif design.process == "leaderboard":
        people = np.repeat(np.arange(design.participants), 3)
    else:
        return crossed(design)
    return people.astype(np.intp), generator.integers(design.items, size=people.size)


def tastes(
    design: Design,
    generator: np.random.Generator,
    people: Codes,
    items: Codes,
    *,
    width: int = 1,
    scale: float = 1.0,
) -> Floats:
    """Return how far participants and items favour something, shape (N, width)."""

    def drawn(count: int, sd: float) -> Floats:
        if design.process == "heavy tails":
            return scale * sd / math.sqrt(3) * generator.standard_t(3, (count, width))
        return scale * sd * generator.standard_normal((count, width))

    utilities = drawn(design.participants, design.participant_sd)[people]
    utilities = utilities + drawn(design.items, design.item_sd)[items]
    if design.process == "taste of items":
        cells = people * design.items + items
        utilities = (
            utilities + drawn(design.participants * design.items, design.participant_sd)[cells]
        )
    if design.process == "drift":
        first = np.searchsorted(people, np.arange(design.participants))
        time = (np.arange(people.size) - first[people]) / design.items - 0.5
        utilities = (
            utilities
            + 2 * time[:, None] * drawn(design.participants, design.participant_sd)[people]
        )
    return utilities


def preferences(
    design: Design, generator: np.random.Generator, *, shifts: Floats | None = None
) -> Preferences:
    """Return the answers of one study that compares two conditions.

    Parameters
    ----------
    shifts : ndarray, shape (items,), optional
        Increase of the effect for each item, in logits.
    """
    people, items = answered(design, generator)
    latent = (
        design.effect
        + (0.0 if shifts is None else shifts[items])
        + tastes(design, generator, people, items)[:, 0]
        + generator.logistic(size=people.size)
    )
    side = generator.choice([-1.0, 1.0], people.size)
    return Preferences(
        towards_first=grade_preferences(latent).astype(np.intp),
        side=side,
        participants=people,
        items=items,
    )


def judgements(
    design: Design, conditions: int, generator: np.random.Generator, *, differ: bool = True
) -> Judgements:
    """Return the opinions of one study's participants about several conditions.

    Parameters
    ----------
    differ : bool
        Whether participants and items differ by condition, so that the difference between any two
        conditions varies as in `design`; else all agree.
    """
    people, items = answered(design, generator)
    worth = np.zeros((people.size, conditions))
    worth[:, 0] = design.effect
    if differ:
        # A difference between two conditions has twice the variance of one of them.
        scale = 1 / math.sqrt(2)
        worth += tastes(design, generator, people, items, width=conditions, scale=scale)
    return Judgements(worth=worth, participants=people, items=items)


def ratings(judged: Judgements, design: Design, generator: np.random.Generator) -> Codes:
    """Return a rating of 1 to 5 for each judgement and condition, shape (N, conditions).

    Participants differ in leniency, and items in popularity, as much as in their tastes.
    """
    level = design.participant_sd * generator.standard_normal(design.participants)
    liked = design.item_sd * generator.standard_normal(design.items)
    latent = judged.worth + (level[judged.participants] + liked[judged.items])[:, None]
    latent = latent + generator.logistic(size=latent.shape)
    return np.asarray(1 + np.searchsorted(RATING_THRESHOLDS, latent), np.intp)


def votes(
    judged: Judgements, generator: np.random.Generator, *, popular: bool = False
) -> tuple[Codes, Codes, Codes]:
    """Return for each judgement the left condition, the right one, and the winner.

    The pair and its sides are drawn; 1 stands for the left one, 0 for a tie. Where some are
    `popular`, the first conditions are shown more often than the last.
    """
    count, conditions = judged.worth.shape
    left = np.asarray(generator.integers(conditions, size=count), np.intp)
    right = np.asarray((left + generator.integers(1, conditions, size=count)) % conditions)
    if popular:
        often = 1 / np.arange(1, conditions + 1)
        order = np.log(often) + generator.gumbel(size=(count, conditions))
        left, right = (-order).argsort(axis=1)[:, :2].T
    rows = np.arange(count)
    latent = judged.worth[rows, left] - judged.worth[rows, right]
    latent = latent + generator.logistic(size=count)
    outcome = np.sign(latent) * (np.abs(latent) > THRESHOLDS[0])
    return left, right.astype(np.intp), outcome.astype(np.intp)


def ranks(judged: Judgements, generator: np.random.Generator) -> Codes:
    """Return each condition's rank in each judgement, 1 for the best, shape (N, conditions)."""
    worth = judged.worth + generator.gumbel(size=judged.worth.shape)
    return np.asarray((-worth).argsort(axis=1).argsort(axis=1) + 1, np.intp)


def true_win_share(design: Design) -> float:
    """Return the win share over all participants and items that `design` draws from."""
    wins, losses = _chances(design)
    return (1 + wins - losses) / 2


def true_outcomes(design: Design) -> tuple[float, float, float]:
    """Return how often the first condition wins, ties with and loses to the second."""
    wins, losses = _chances(design)
    return wins, 1 - wins - losses, losses


def true_rating_difference(design: Design, *, tastes: bool = True) -> float:
    """Return the mean rating of the first condition minus that of the second.

    It is over all participants and items that `design` draws from, as `judgements` and `ratings`
    make them.
    """
    return true_mean_rating(design, tastes=tastes) - true_mean_rating(
        replace(design, effect=0.0), tastes=tastes
    )


def true_mean_rating(design: Design, *, tastes: bool = True) -> float:
    """Return the mean rating of the first condition over all participants and items."""
    # The variance of a level, and half that of a difference between two conditions.
    spread = design.spread * math.sqrt(1.5 if tastes else 1.0)
    nodes, weights = hermegauss(61)
    above = expit((design.effect + spread * nodes)[:, None] - np.array(RATING_THRESHOLDS))
    return float(1 + weights @ above.sum(axis=1) / weights.sum())


def _chances(design: Design) -> tuple[float, float]:
    nodes, weights = hermegauss(61)
    weights = weights / weights.sum()
    latent = design.effect + design.spread * nodes
    return (
        float(weights @ expit(latent - THRESHOLDS[0])),
        float(weights @ expit(-latent - THRESHOLDS[0])),
    )
