"""What a rehearsal's raters really prefer: integrated over all that differs, not counted.

``rehearsal.json`` keeps it, with the simulated population.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from pydantic import BaseModel, ConfigDict, ValidationError
from scipy.special import expit

from analysis.results.headline import Measure
from analysis.results.known_values import KnownValue
from motion.errors import InputError
from motion.files import write_text
from motion.segment import Segment
from studyapp.rehearsal.simulation.population import Population, rating_thresholds
from studyapp.rehearsal.simulation.raters import segment_fit, speech_fit
from studyapp.study.protocols.mismatch import FIT, REALISM, MismatchStudy
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.conditions import comparison_name
from studyapp.study.settings.sections import explain_errors
from studyapp.study.settings.study import Study

Fit = Callable[[Population, int, str, str, str], float]
"""`segment_fit` or `speech_fit`."""

Average = Callable[[np.ndarray, float], float]
"""What raters answer on average, given utilities or gaps (k,) and their standard deviation."""


def expectations(
    study: Study, segments: Sequence[Segment], *, population: Population, seed: int
) -> tuple[KnownValue, ...]:
    """Return what a rehearsal of `study` with `segments` should find.

    Nothing is expected of rankings with ties: how many there are depends on all motions at once.
    """
    items = _Items(population, seed, segments)
    match study:
        case PairwiseStudy():
            found = _of_pairs(study, items)
        case RatingStudy():
            found = _of_ratings(study, items)
        case RankingStudy():
            found = _of_rankings(study, items)
        case MismatchStudy():
            found = _of_mismatch(study, items)
        case _:
            raise TypeError(f"a rehearsal knows no {type(study).__name__}")
    return tuple(found)


@dataclass(frozen=True)
class _Items:
    """The segments that a question is asked about, and how each condition does in each."""

    population: Population
    seed: int
    segments: Sequence[Segment]

    def quality(self, condition: str, question: str) -> float:
        """Return a condition's mean utility in logits."""
        return self.population.quality[condition][question]

    def luck(self, condition: str, question: str, fit: Fit = segment_fit) -> np.ndarray:
        """Return what each segment adds to it, or to the cost of another speech (S,)."""
        names = (segment.name for segment in self.segments)
        return np.array([fit(self.population, self.seed, condition, n, question) for n in names])


def _of_pairs(study: PairwiseStudy, items: _Items) -> Iterator[KnownValue]:
    for arm in study.arms:
        for pair in combinations(arm.conditions, 2):
            for question in study.questions:
                yield _pair(items, pair, question.name)


def _of_mismatch(study: MismatchStudy, items: _Items) -> Iterator[KnownValue]:
    for question in study.questions:
        ties = question.levels > 2
        if study.fit and question.belongs_to(FIT):
            for condition in study.conditions:
                yield _own_speech(items, condition, question.name, ties=ties)
        if study.realism and question.belongs_to(REALISM):
            for pair in combinations(study.conditions, 2):
                yield _pair(items, pair, question.name, part=REALISM, ties=ties)


def _of_ratings(study: RatingStudy, items: _Items) -> Iterator[KnownValue]:
    for part in study.sets:
        for question in study.questions:
            for condition in part.conditions if question.belongs_to(part.name) else ():
                yield _rating(items, condition, question.name, question.values, part=part.name)


def _of_rankings(study: RankingStudy, items: _Items) -> Iterator[KnownValue]:
    for block in study.blocks if not study.ties else ():
        shown = replace(items, segments=block.segments(items.segments))
        for question in study.questions:
            for condition in block.conditions if question.belongs_to(block.name) else ():
                others = [other for other in block.conditions if other != condition]
                yield _rank(shown, condition, others, question.name, part=block.name)


def _pair(
    items: _Items, pair: tuple[str, str], question: str, *, part: str = "", ties: bool = True
) -> KnownValue:
    first, second = pair
    gap = items.quality(first, question) - items.quality(second, question)
    luck = items.luck(first, question) - items.luck(second, question)
    shares = _win_shares(items.population, gap, luck, ties=ties)
    return _expected("win_share", comparison_name(*pair), part, question, *shares)


def _own_speech(items: _Items, condition: str, question: str, *, ties: bool) -> KnownValue:
    gap = items.population.belonging[condition][question]
    luck = items.luck(condition, question, speech_fit)
    shares = _win_shares(items.population, gap, luck, ties=ties)
    return _expected("own_speech", condition, FIT, question, *shares)


def _win_shares(
    population: Population, gap: float, luck: np.ndarray, *, ties: bool
) -> tuple[float, float]:
    return _averages(
        lambda gaps, spread: win_share(population, float(gaps[0]), spread, ties=ties),
        gaps=np.array([gap]),
        luck=luck[:, None],
        people_sd=population.participant_sd,
        item_sd=population.item_sd,
    )


def _rating(
    items: _Items, condition: str, question: str, values: Sequence[int], *, part: str
) -> KnownValue:
    population = items.population
    value, on_these = _averages(
        lambda utility, spread: mean_rating(population, float(utility[0]), spread, values),
        gaps=np.array([items.quality(condition, question)]),
        luck=items.luck(condition, question)[:, None],
        people_sd=math.hypot(population.taste_sd, population.leniency_sd),
        item_sd=population.fit_sd,
    )
    return _expected("mean_rating", condition, part, question, value, on_these)


def _rank(
    items: _Items, condition: str, others: Sequence[str], question: str, *, part: str
) -> KnownValue:
    own, own_luck = items.quality(condition, question), items.luck(condition, question)
    value, on_these = _averages(
        lambda gaps, spread: mean_rank(gaps.tolist(), spread),
        gaps=np.array([own - items.quality(other, question) for other in others]),
        luck=np.stack([own_luck - items.luck(other, question) for other in others], axis=1),
        people_sd=items.population.participant_sd,
        item_sd=items.population.item_sd,
    )
    return _expected("mean_rank", condition, part, question, value, on_these)


def _averages(
    average: Average, *, gaps: np.ndarray, luck: np.ndarray, people_sd: float, item_sd: float
) -> tuple[float, float]:
    """Return the average over all segments there could be, and over those of the study.

    Parameters
    ----------
    gaps : ndarray (k,)
        Mean utilities, or differences between them, in logits.
    luck : ndarray (S, k)
        What the study's own segments add to them.
    people_sd, item_sd : float
        Standard deviations over raters and over segments.
    """
    over_all = average(gaps, math.hypot(people_sd, item_sd))
    on_these = [average(gaps + each, people_sd) for each in luck]
    return over_all, float(np.mean(on_these)) if on_these else over_all


def _expected(
    measure: Measure, about: str, part: str, question: str, value: float, on_these: float
) -> KnownValue:
    return KnownValue(
        part=part,
        question=question,
        measure=measure,
        about=about,
        value=value,
        on_these_segments=on_these,
    )


NODES, WEIGHTS = hermegauss(61)


def win_share(population: Population, gap: float, slope_sd: float, *, ties: bool = True) -> float:
    """Return the expected wins plus half the ties of the better side of a pair.

    Each side is taken to be the left one half the time. An answer rests on
    ``s * (gap + slope) + bias + noise`` with ``s = 1`` where the first condition is on the right;
    as slope and bias are normal and independent, their sum is one normal, integrated over by
    Gauss-Hermite quadrature.

    Parameters
    ----------
    population : Population
        Gives thresholds and side bias.
    gap : float
        Mean difference in quality, first condition minus second, in logits.
    slope_sd : float
        Standard deviation of that difference over what the share averages over, in logits.
    ties : bool
        Whether 'no difference' can be answered.

    Returns
    -------
    float
        Share of the first condition in [0, 1]; .5 where `gap` is 0.
    """
    spread = math.hypot(slope_sd, population.side_bias_sd)
    tie = population.weak if ties else 0.0
    total = 0.0
    for side in (1.0, -1.0):
        mean = side * gap + population.side_bias
        share_of_right = averaged(lambda latent: _share_of_right(latent, tie), mean, spread)
        total += share_of_right if side > 0 else 1 - share_of_right
    return total / 2


def mean_rating(
    population: Population, quality: float, spread: float, values: Sequence[int]
) -> float:
    """Return the expected rating of one condition.

    Parameters
    ----------
    population : Population
        Gives the borders between the steps.
    quality : float
        Mean utility in logits.
    spread : float
        Standard deviation of the utility over what the mean averages over, leniency of the
        raters included, in logits.
    values : sequence of int
        The steps of the scale, evenly spaced from the worst to the best.
    """
    borders = np.asarray(rating_thresholds(population, len(values)))[:, None]
    steps = averaged(lambda latent: expit(latent - borders).sum(axis=0), quality, spread)
    return values[0] + steps * (values[1] - values[0])


def mean_rank(gaps: Sequence[float], slope_sd: float) -> float:
    """Return the expected rank, counted from 1, among others, where nothing shares a rank.

    Parameters
    ----------
    gaps : sequence of float
        Mean difference in utility to each of the others, this one minus the other, in logits.
    slope_sd : float
        Standard deviation of each difference over what the mean averages over, in logits.
    """
    return 1 + sum(averaged(lambda lead: expit(-lead), gap, slope_sd) for gap in gaps)


def averaged(function: Callable[[np.ndarray], np.ndarray], mean: float, spread: float) -> float:
    """Return the mean of `function` over a normal variable, by Gauss-Hermite quadrature."""
    return float(WEIGHTS @ function(mean + spread * NODES) / WEIGHTS.sum())


def _share_of_right(latent: np.ndarray, tie: float) -> np.ndarray:
    """Return wins of the right side plus half the ties, with logistic noise around `latent`."""
    above, not_below = expit(latent - tie), expit(latent + tie)
    return np.asarray(above + (not_below - above) / 2)


class Truth(BaseModel):
    """The contents of `rehearsal.json`.

    Attributes
    ----------
    seed : int
        Seed of the rehearsal.
    study : str
        Digest of the study that was rehearsed: its definition, segments and videos.
    population : Population
        The population of the participants.
    expected : tuple of KnownValue
        The true value of everything that is estimated.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[4] = 4
    seed: int
    study: str
    population: Population
    expected: tuple[KnownValue, ...]


def write_truth(path: Path, truth: Truth) -> None:
    """Write `rehearsal.json` in one step."""
    write_text(path, truth.model_dump_json(indent=1) + "\n")


def read_truth(path: Path) -> Truth:
    """Read `rehearsal.json`.

    Raises
    ------
    InputError
        If it is missing or damaged.
    """
    remedy = "Run 'motionjury rehearse' again"
    try:
        return Truth.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        raise InputError("the study has not been rehearsed", where=path, remedy=remedy) from None
    except ValidationError as error:
        raise InputError(explain_errors(error), where=path, remedy=remedy) from None
