"""How far participants agree with one another, and with themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import codes, shown_codes, split_by_question
from analysis.results.net_preference import sided
from analysis.results.ranking import concordance, placements_of
from analysis.stats.agreement import Alpha, Retest, krippendorff_alpha, retest_agreement
from analysis.stats.clustered_mean import Interval
from analysis.stats.friedman import Concordance
from analysis.stats.intraclass import Intraclass, intraclass_correlation


@dataclass(frozen=True, kw_only=True)
class Agreement(Alpha):
    """Krippendorff's alpha for ordered answers, and the intraclass correlation.

    Attributes
    ----------
    icc : Intraclass
        The intraclass correlation of the answers as equally spaced numbers.
    """

    icc: Intraclass


@dataclass(frozen=True, kw_only=True)
class AgreedSoFar(Interval):
    """How far participants agree about one question, with one another and with themselves.

    Attributes
    ----------
    set : str or None
        None where the study has no sets.
    question : str
        Its name.
    measure : {'alpha', 'w'}
        Krippendorff's alpha for ordered answers; of rankings, Kendall's W.
    n, participants : int
        Answers (of rankings: orders) and participants that it rests on.
    retest : Retest or None
        Practice trials against their repeats; None of rankings, which repeat none.
    """

    set: str | None
    question: str
    measure: Literal["alpha", "w"]
    n: int
    participants: int
    retest: Retest | None = None


def agreement_of(answers: pd.DataFrame) -> Agreement:
    """Return how far participants agree about segments' conditions or comparisons.

    Of several answers of a participant about an item, the first counts.
    """
    item_codes = [*shown_codes(answers).values(), codes(answers, "segment")]
    items = np.unique(np.stack(item_codes), axis=1, return_inverse=True)[1].ravel()
    participants = codes(answers, "participant")
    # A key of both, so that one pass finds who answered twice.
    key = participants.astype(np.int64) * (int(items.max(initial=0)) + 1) + items
    first = np.sort(np.unique(key, return_index=True)[1])
    ratings = _signed_values(answers)[first], participants[first], items[first]
    return Agreement(**vars(krippendorff_alpha(*ratings)), icc=intraclass_correlation(*ratings))


def retest_of(answers: pd.DataFrame) -> Retest:
    """Compare practice trials with their repeats; sides may be swapped.

    Of several answers in practice the last counts, of repeats the first.

    Parameters
    ----------
    answers : DataFrame
        Of one question, practice trials included, of those whom every rule kept.
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


def _signed_values(answers: pd.DataFrame) -> NDArray[np.int64]:
    """Return ratings, or preferences for the first side instead of for the left."""
    if {"left", "right_speech"} & set(answers):
        return sided(answers).signed
    return answers["value"].to_numpy().astype(np.int64)


def agreed_so_far(table: AnswerTable, left_out: LeftOut) -> tuple[AgreedSoFar, ...]:
    """Return how far the analysed participants agree, question by question.

    It does not reveal what they prefer: if everybody answered the opposite, it would be the same.
    """
    with_practice = {
        (set_name, question): part
        for set_name, question, part in split_by_question(table, left_out.kept)
    }
    agreements = []
    for set_name, question, answers in split_by_question(table, left_out.analysed):
        agreement: Agreement | Concordance
        if table.protocol == "ranking":
            rankings = placements_of(answers)
            agreement, retest = concordance(rankings), None
            n, participants = len(rankings.ranks), len(np.unique(rankings.participants))
        else:
            agreement = agreement_of(answers)
            retest = retest_of(with_practice[set_name, question])
            n, participants = agreement.n, agreement.participants
        agreements.append(
            AgreedSoFar(
                set=set_name,
                question=question,
                measure="alpha" if retest else "w",
                estimate=agreement.estimate,
                low=agreement.low,
                high=agreement.high,
                n=n,
                participants=participants,
                reason="" if agreement.has_interval else agreement.reason,
                retest=retest,
            )
        )
    return tuple(agreements)
