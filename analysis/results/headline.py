"""Results without tests: headline numbers, with and without exclusions, and agreement.

Pages show both before the end of a study.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import (
    ConditionKey,
    ResultKey,
    codes,
    shown_codes,
    shown_conditions,
    split_by_key,
    split_by_question,
)
from analysis.results.mixed_models import sided
from analysis.results.preference import win_share
from analysis.stats.agreement import (
    Alpha,
    Concordance,
    Retest,
    kendall_w,
    krippendorff_alpha,
    retest_agreement,
)
from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.intraclass import Intraclass, intraclass_correlation
from analysis.stats.rankings import Placements, placements, rank_summaries
from motion.arrays import Ints

Measure = Literal["win_share", "own_speech", "mean_rating", "mean_rank"]


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """How much one headline number depends on exclusions.

    Attributes
    ----------
    set : str or None
        None if the table has no sets.
    question : str
        The question's name.
    conditions : tuple of str
        The condition, or a and b.
    measure : {'win_share', 'own_speech', 'mean_rating', 'mean_rank'}
        A win share of a, a share of preferences for the own speech, or a mean rating or rank; a
        share counts ties as one half.
    analysed : Estimate
        The estimate as it is reported.
    as_planned : Estimate
        With only the rules that were settled in advance.
    everyone : Estimate
        With nobody excluded.
    """

    set: str | None
    question: str
    conditions: tuple[str, ...]
    measure: Measure
    analysed: Estimate
    as_planned: Estimate
    everyone: Estimate

    @property
    def is_as_planned(self) -> bool:
        """Whether the rules that were settled in advance give the same estimate as all rules."""
        # Compared as text, in which NaN equals NaN.
        return str(self.analysed) == str(self.as_planned)


def headline_numbers(table: AnswerTable, answers: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """Yield the headline numbers of a selection of a table's answers.

    Pages show them before the end of a study.

    Yields
    ------
    dict
        The fields of an `Estimate`; set, question, a, b ('' for a single condition) and measure.
        In the order of sets, questions and conditions.
    """
    for key, estimate in _estimates(table, answers):
        a, b = (*key.names, "")[:2]
        subject = {"set": key.set, "question": key.question, "a": a, "b": b}
        yield vars(estimate) | subject | {"measure": MEASURES[table.protocol]}


def sensitivity(table: AnswerTable, left_out: LeftOut) -> tuple[Sensitivity, ...]:
    """Return every headline number with and without exclusions.

    Parameters
    ----------
    table : AnswerTable
        All answers.
    left_out : LeftOut
        The exclusions.

    Returns
    -------
    tuple of Sensitivity
        In the order of sets, questions and conditions; empty if neither all rules nor the planned
        ones exclude anybody.
    """
    if not left_out.exclusions and left_out.is_as_planned:
        return ()

    everyone, analysed = (
        dict(_estimates(table, answers)) for answers in (left_out.everyone, left_out.analysed)
    )
    planned = analysed if left_out.is_as_planned else dict(_estimates(table, left_out.as_planned))
    return tuple(
        Sensitivity(
            set=key.set,
            question=key.question,
            conditions=key.names,
            measure=MEASURES[table.protocol],
            analysed=analysed.get(key, NOBODY),
            as_planned=planned.get(key, NOBODY),
            everyone=estimate,
        )
        for key, estimate in everyone.items()
    )


NOBODY: Final = Estimate(reason="nobody who answered this is analysed")

MEASURES: Final[Mapping[str, Measure]] = {
    "pairwise": "win_share",
    "mismatch": "own_speech",
    "rating": "mean_rating",
    "ranking": "mean_rank",
}
"""The kind of headline number of each protocol."""


def _estimates(table: AnswerTable, answers: pd.DataFrame) -> Iterator[tuple[ResultKey, Estimate]]:
    if table.protocol == "ranking":
        for set_name, question, part in split_by_question(table, answers):
            for summary in rank_summaries(placements_of(part)):
                yield (
                    ConditionKey(set=set_name, condition=summary.condition, question=question),
                    summary.mean_rank,
                )
        return
    for key, part in split_by_key(table, answers):
        if table.protocol == "rating":
            yield (
                key,
                clustered_mean(
                    part["value"].to_numpy(np.float64),
                    codes(part, "participant"),
                    codes(part, "segment"),
                    null=math.nan,
                    limits=table.limits(key.question),
                ),
            )
        else:
            yield key, win_share(sided(part))


@dataclass(frozen=True, kw_only=True)
class Agreement(Alpha):
    """Krippendorff's alpha for ordered answers, and the intraclass correlation.

    Attributes
    ----------
    icc : Intraclass
        The intraclass correlation of the answers as equally spaced numbers.
    """

    icc: Intraclass


def agreement_of(answers: pd.DataFrame) -> Agreement:
    """Return the agreement of participants on segments' conditions or comparisons.

    If a participant answered about an item several times, the first answer counts.
    """
    item_codes = [*shown_codes(answers).values(), codes(answers, "segment")]
    items = np.unique(np.stack(item_codes), axis=1, return_inverse=True)[1].ravel()
    participants = codes(answers, "participant")
    # One key for both, so that one pass finds repeated answers.
    key = participants.astype(np.int64) * (int(items.max(initial=0)) + 1) + items
    first = np.sort(np.unique(key, return_index=True)[1])
    ratings = _signed_values(answers)[first], participants[first], items[first]
    return Agreement(**vars(krippendorff_alpha(*ratings)), icc=intraclass_correlation(*ratings))


def retest_of(answers: pd.DataFrame) -> Retest:
    """Compare practice trials with their repeats; sides may be swapped.

    Of several practice answers, the last counts; of several repeats, the first.

    Parameters
    ----------
    answers : DataFrame
        Answers of the kept participants to one question, practice trials included.
    """
    shown = shown_codes(answers)
    rows = pd.DataFrame(
        {
            "participant": codes(answers, "participant"),
            "segment": codes(answers, "segment"),
            "kind": answers["kind"].to_numpy(object),
            "value": _signed_values(answers),
            **shown,
        }
    )
    keys = ["participant", "segment", *shown]
    practice = rows[rows["kind"] == "practice"].drop_duplicates(keys, keep="last")
    repeats = rows[rows["kind"] == "repeat"].drop_duplicates(keys, keep="first")
    pairs = practice.merge(repeats, on=keys, suffixes=("_first", "_again"), validate="one_to_one")
    return retest_agreement(
        pairs["value_first"].to_numpy(np.int64),
        pairs["value_again"].to_numpy(np.int64),
        pairs["participant"].to_numpy(),
    )


def _signed_values(answers: pd.DataFrame) -> Ints:
    """Return ratings, or preferences for the first side instead of for the left."""
    if {"left", "right_speech"} & set(answers):
        return sided(answers).signed
    return answers["value"].to_numpy().astype(np.int64)


def agreed_so_far(table: AnswerTable, left_out: LeftOut) -> Iterator[dict[str, Any]]:
    """Yield the agreement of the analysed participants, question by question.

    It does not reveal what they prefer: it would be the same if all answers were reversed.

    Yields
    ------
    dict
        The fields of an `Interval`; set and question; measure, 'alpha' (Krippendorff's, for ordered
        answers) or 'w' (Kendall's, for rankings); n answers (orders) and participants; retest, None
        for rankings, which have no repeats.
    """
    with_practice = {
        (set_name, question): part
        for set_name, question, part in split_by_question(table, left_out.kept)
    }
    for set_name, question, answers in split_by_question(table, left_out.analysed):
        agreement: Agreement | Concordance
        if table.protocol == "ranking":
            rankings = placements_of(answers)
            agreement, measure, retest = concordance(rankings), "w", None
            n, participants = len(rankings.ranks), len(np.unique(rankings.participants))
        else:
            agreement, measure = agreement_of(answers), "alpha"
            retest = retest_of(with_practice[set_name, question])
            n, participants = agreement.n, agreement.participants
        yield {
            **{name: getattr(agreement, name) for name in ("estimate", "low", "high")},
            "reason": "" if agreement.has_interval else agreement.reason,
            "set": set_name,
            "question": question,
            "measure": measure,
            "n": n,
            "participants": participants,
            "retest": retest,
        }


def placements_of(answers: pd.DataFrame) -> Placements:
    """Return the rankings of one question."""
    return placements(answers.rename(columns={"value": "rank"}), shown_conditions(answers))


def concordance(rankings: Placements) -> Concordance:
    """Return participants' concordance; several rankings of a segment count as their mean."""
    return kendall_w(rankings.averaged())
