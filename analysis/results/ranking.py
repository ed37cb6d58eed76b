"""Results of rankings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.rankings.friedman import blocks_of_rankings, friedman
from analysis.rankings.kendall_w import kendall_w
from analysis.rankings.placements import Placements, placements
from analysis.rankings.posthoc import PairwiseRanks, compare_pairs
from analysis.rankings.summary import RankSummary, rank_summaries
from analysis.results.estimate import Estimate, estimate_of
from analysis.results.grouping import ByQuestion, by_question, codes, nested, parts, set_name
from analysis.results.heterogeneity import (
    ConditionHeterogeneity,
    corrected_tests,
    heterogeneity,
)
from analysis.results.left_out import LeftOut
from analysis.results.place import ConditionPlace, PairPlace
from analysis.results.strength_errors import RankInterval, strength_errors
from analysis.results.strengths import named, remark_of
from analysis.strengths.plackett_luce import plackett_luce
from analysis.tables.answers import AnswerTable


@dataclass(frozen=True, kw_only=True)
class RankedCondition(ConditionPlace):
    """Where a condition is placed.

    Attributes
    ----------
    n : int
        Rankings that place it.
    mean_rank, first_share : float
        1 is best; the share of rankings in which it is best, ties sharing one.
    rank_percent : mapping of int to float
        How often it has each place, in percent, ties spread over their places.
    mean_rank_interval, first_share_interval : Estimate
        The same with intervals clustered by participant and segment; p against what chance gives.
    remark : str
        What limits the numbers.
    """

    n: int
    mean_rank: float
    first_share: float
    rank_percent: Mapping[int, float]
    mean_rank_interval: Estimate
    first_share_interval: Estimate
    remark: str


@dataclass(frozen=True, kw_only=True)
class Worths:
    """Plackett-Luce worths, partial and tied rankings included.

    Attributes
    ----------
    worths, errors : mapping of condition to float
        Log worths, which add up to zero, and their errors clustered by participant.
    errors_two_way, low, high : mapping of condition to float
        Errors clustered by participant and segment, and the ends of the 95 % intervals.
    ranks : mapping of condition to RankInterval
        At 95 %, all together.
    ties : mapping of int to float
        For each size of tie that occurs, the logarithm of its parameter.
    loglik : float
        At the estimates.
    n, participants, segments : int
        What it rests on.
    method : str
        Which errors the intervals and ranks rest on.
    remark, reason : str
        What limits the result; why there is none.
    """

    worths: Mapping[str, float]
    errors: Mapping[str, float]
    errors_two_way: Mapping[str, float]
    low: Mapping[str, float]
    high: Mapping[str, float]
    ranks: Mapping[str, RankInterval]
    ties: Mapping[int, float]
    loglik: float
    n: int
    participants: int
    segments: int
    method: str
    remark: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class SegmentConcordance:
    """Kendall's W of the rankings of one segment; `incomplete` ones are left out."""

    segment: str
    w: float
    n: int
    incomplete: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class Concordance:
    """How far participants agree.

    Attributes
    ----------
    mean, low, high : float
        Kendall's W, mean over segments that have one, and its 95 % interval: participants and
        segments drawn again.
    overall : float
        Kendall's W of participants' mean ranks over segments.
    n : int
        Participants behind `overall`.
    segments : tuple of SegmentConcordance
        One per segment.
    method : str
        How the interval was found.
    reason : str
        Why a number is missing.
    """

    mean: float
    low: float
    high: float
    overall: float
    n: int
    segments: tuple[SegmentConcordance, ...]
    method: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Friedman:
    """Friedman's test over participants' mean ranks, with Iman and Davenport's F; secondary.

    It takes the segments as the only ones of interest.
    """

    statistic: float
    p: float
    n: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class RankContrast(PairPlace):
    """Whether two conditions are placed otherwise, after Friedman's test; secondary.

    It rests on participants' mean ranks and takes the segments as the only ones of interest.

    Attributes
    ----------
    difference : float
        Mean rank of a minus that of b over participants, ranked by their means; below zero where
        a is the better one.
    nemenyi_p : float
        Of the Studentised range; corrects for all pairs of the question by itself.
    conover_p, conover_holm : float
        Of Conover and Iman's t; corrected over all pairs of the question.
    wilcoxon_p, wilcoxon_holm : float
        Exact, of participants' mean ranks; corrected likewise.
    n : int
        Participants who ranked all conditions.
    reason : str
        Why a number is missing.
    """

    difference: float
    nemenyi_p: float
    conover_p: float
    conover_holm: float
    wilcoxon_p: float
    wilcoxon_holm: float
    n: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class RankingResults:
    """All of them.

    Attributes
    ----------
    conditions : tuple of RankedCondition
        In the order of sets, questions and conditions.
    plackett_luce, kendall_w, friedman : mapping of question to result
        See `ByQuestion`.
    posthoc : tuple of RankContrast
        Every two conditions, in the order of sets and questions.
    heterogeneity : tuple of ConditionHeterogeneity
        Mean ranks by emotion, speaker and segment.
    """

    conditions: tuple[RankedCondition, ...]
    plackett_luce: ByQuestion[Worths]
    kendall_w: ByQuestion[Concordance]
    friedman: ByQuestion[Friedman]
    posthoc: tuple[RankContrast, ...]
    heterogeneity: tuple[ConditionHeterogeneity, ...]


def ranking_results(table: AnswerTable, left_out: LeftOut) -> RankingResults:
    """Analyse rankings.

    Parameters
    ----------
    table : AnswerTable
        Of the ranking layout.
    left_out : LeftOut
        Who is left out.
    """
    analysed = left_out.analysed
    placed = {
        (name, question): _placements(answers) for name, question, answers in parts(table, analysed)
    }
    return RankingResults(
        conditions=tuple(
            _condition(set_name(table, name), question, one)
            for (name, question), given in placed.items()
            for one in rank_summaries(given)
        ),
        plackett_luce=by_question(table, analysed, _worths),
        kendall_w=nested(table, {place: _concordance(given) for place, given in placed.items()}),
        friedman=nested(table, {place: _friedman(given) for place, given in placed.items()}),
        posthoc=tuple(
            _contrast(set_name(table, name), question, pair)
            for (name, question), given in placed.items()
            for pair in compare_pairs(blocks_of_rankings(given))
        ),
        heterogeneity=corrected_tests(_heterogeneity(table, analysed)),
    )


def _heterogeneity(table: AnswerTable, analysed: pd.DataFrame) -> list[ConditionHeterogeneity]:
    found = []
    for name, question, answers in parts(table, analysed):
        shown = np.unique(codes(answers, "condition")).tolist()
        ranks = answers.groupby(["participant", "segment"], observed=True)["value"].rank()
        for place in shown:
            own = codes(answers, "condition") == place
            found += [
                ConditionHeterogeneity(
                    set=set_name(table, name),
                    condition=table.conditions[place],
                    question=question,
                    **vars(one),
                )
                for one in heterogeneity(
                    answers[own],
                    ranks[own].to_numpy(np.float64),
                    measure="mean_rank",
                    null=(len(shown) + 1) / 2,
                    limits=(1.0, len(shown)),
                )
            ]
    return found


def _shown(answers: pd.DataFrame) -> tuple[str, ...]:
    names = answers["condition"].cat.categories
    return tuple(str(names[place]) for place in np.unique(codes(answers, "condition")))


def _placements(answers: pd.DataFrame) -> Placements:
    return placements(answers.rename(columns={"value": "rank"}), _shown(answers))


def _condition(of: str | None, question: str, found: RankSummary) -> RankedCondition:
    return RankedCondition(
        set=of,
        condition=found.condition,
        question=question,
        n=found.rankings,
        mean_rank=found.mean_rank.estimate,
        first_share=found.first_share.estimate,
        rank_percent=dict(enumerate(found.rank_percent, start=1)),
        mean_rank_interval=estimate_of(found.mean_rank),
        first_share_interval=estimate_of(found.first_share),
        remark=found.remark,
    )


def _worths(answers: pd.DataFrame) -> Worths:
    names = _shown(answers)
    who = codes(answers, "participant")
    ranking = who * len(answers["segment"].cat.categories) + codes(answers, "segment")
    rows = pd.DataFrame(
        {
            "ranking": ranking,
            "condition": answers["condition"].to_numpy(object),
            "rank": answers["value"].to_numpy(),
            "participant": who,
            "segment": codes(answers, "segment"),
        }
    )
    found = plackett_luce(rows, conditions=names)
    known = not found.reason
    segments = len(np.unique(codes(answers, "segment")))
    return Worths(
        worths=named(names, found.worths, hide=not known),
        errors=named(names, found.errors, hide=not known),
        **vars(
            strength_errors(
                names,
                found.worths,
                found.covariance,
                found.two_way,
                participants=found.participants,
                known=known,
            )
        ),
        ties=found.ties if known else {},
        loglik=found.log_likelihood if known else math.nan,
        n=found.rankings,
        participants=found.participants,
        segments=segments,
        remark=remark_of(found.remark, segments=segments),
        reason=found.reason,
    )


def _concordance(given: Placements) -> Concordance:
    found = kendall_w(given)
    return Concordance(
        mean=found.mean,
        low=found.low,
        high=found.high,
        overall=found.overall.estimate,
        n=found.overall.n,
        segments=tuple(
            SegmentConcordance(
                segment=one.segment,
                w=one.estimate,
                n=one.n,
                incomplete=one.incomplete,
                reason=one.reason,
            )
            for one in found.segments
        ),
        method=found.method,
        reason=found.overall.reason or found.reason,
    )


def _contrast(of: str | None, question: str, found: PairwiseRanks) -> RankContrast:
    return RankContrast(
        set=of,
        a=found.a,
        b=found.b,
        question=question,
        # Its ranks rise with how good a condition is; places fall.
        difference=-found.difference,
        nemenyi_p=found.nemenyi_p,
        conover_p=found.conover_p,
        conover_holm=found.conover_holm,
        wilcoxon_p=found.wilcoxon.p_value,
        wilcoxon_holm=found.wilcoxon_holm,
        n=found.n,
        reason=found.reason or found.wilcoxon.reason,
    )


def _friedman(given: Placements) -> Friedman:
    found = friedman(blocks_of_rankings(given))
    return Friedman(statistic=found.statistic, p=found.p_value, n=found.n, reason=found.reason)
