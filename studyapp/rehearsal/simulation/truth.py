"""What a rehearsal's raters really prefer, computed rather than counted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from analysis.results.headline import Measure
from analysis.results.known_values import KnownValue
from motion.segment import Segment
from studyapp.rehearsal.simulation.integrals import mean_rank, mean_rating, win_share
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import segment_fit, speech_fit
from studyapp.study.protocols.mismatch import FIT, REALISM, MismatchStudy
from studyapp.study.protocols.pairwise import PairwiseStudy, comparison_name
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.study import Study

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

    def luck(self, condition: str, question: str) -> np.ndarray:
        """Return what each segment adds to it (S,)."""
        return np.array(
            [
                segment_fit(self.population, self.seed, condition, segment.name, question)
                for segment in self.segments
            ]
        )

    def speech_luck(self, condition: str, question: str) -> np.ndarray:
        """Return what each segment adds to the cost of another speech (S,)."""
        return np.array(
            [
                speech_fit(self.population, self.seed, condition, segment.name, question)
                for segment in self.segments
            ]
        )


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
    population = items.population
    value, on_these = _averages(
        lambda gap, spread: win_share(population, float(gap[0]), spread, ties=ties),
        gaps=np.array([items.quality(first, question) - items.quality(second, question)]),
        luck=(items.luck(first, question) - items.luck(second, question))[:, None],
        people_sd=population.participant_sd,
        item_sd=population.item_sd,
    )
    return _expected("win_share", comparison_name(*pair), part, question, value, on_these)


def _own_speech(items: _Items, condition: str, question: str, *, ties: bool) -> KnownValue:
    population = items.population
    value, on_these = _averages(
        lambda gap, spread: win_share(population, float(gap[0]), spread, ties=ties),
        gaps=np.array([population.belonging[condition][question]]),
        luck=items.speech_luck(condition, question)[:, None],
        people_sd=population.participant_sd,
        item_sd=population.item_sd,
    )
    return _expected("own_speech", condition, FIT, question, value, on_these)


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
