"""How far participants agree with one another, and with themselves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import codes, parts, set_name, shown
from analysis.results.net_preference import sided
from analysis.results.ranking import concordance, placements_of
from analysis.stats.agreement import Alpha, Retest, krippendorff_alpha, retest_agreement
from analysis.stats.clustered_mean import Interval
from analysis.stats.friedman import Concordance
from analysis.stats.intraclass import Intraclass, intraclass_correlation


@dataclass(frozen=True, kw_only=True)
class Agreement(Alpha):
    """Krippendorff's alpha for ordered answers; not a condition for anything.

    Attributes
    ----------
    icc : Intraclass
        The same question asked of variances, of numbers equally far apart.
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
    things = [*shown(answers).values(), codes(answers, "segment")]
    items = np.unique(np.stack(things), axis=1, return_inverse=True)[1].ravel()
    participants = codes(answers, "participant")
    # A key of both, so that one pass finds who answered twice.
    key = participants.astype(np.int64) * (int(items.max(initial=0)) + 1) + items
    first = np.sort(np.unique(key, return_index=True)[1])
    own = _counted(answers)[first], participants[first], items[first]
    alpha = krippendorff_alpha(*own)
    return Agreement(**vars(alpha), icc=intraclass_correlation(*own))


def retest_of(answers: pd.DataFrame) -> Retest:
    """Compare practice trials with their repeats; sides may be swapped.

    Of several answers in practice the last counts, of repeats the first.

    Parameters
    ----------
    answers : DataFrame
        Of one question, practice trials included, of those whom every rule kept.
    """
    about = shown(answers)
    rows = pd.DataFrame(
        {
            "participant": codes(answers, "participant"),
            "segment": codes(answers, "segment"),
            "kind": answers["kind"].to_numpy(object),
            "value": _counted(answers),
            **about,
        }
    )
    keys = ["participant", "segment", *about]
    first = rows[rows["kind"] == "practice"].drop_duplicates(keys, keep="last")
    again = rows[rows["kind"] == "repeat"].drop_duplicates(keys, keep="first")
    pairs = first.merge(again, on=keys, suffixes=("_first", "_again"), validate="one_to_one")
    return retest_agreement(
        pairs["value_first"].to_numpy(np.int64),
        pairs["value_again"].to_numpy(np.int64),
        pairs["participant"].to_numpy(),
    )


def _counted(answers: pd.DataFrame) -> NDArray[np.int64]:
    """Return ratings, or preferences counted towards a condition and not towards a side."""
    if {"left", "right_speech"} & set(answers):
        return sided(answers).towards
    return answers["value"].to_numpy().astype(np.int64)


def agreed_so_far(table: AnswerTable, left_out: LeftOut) -> tuple[AgreedSoFar, ...]:
    """Return how far the participants agree whom no rule leaves out, question by question.

    It does not tell what they prefer: opposite answers of everybody give the same.
    """
    kept = {(name, question): part for name, question, part in parts(table, left_out.kept)}
    found = []
    for name, question, answers in parts(table, left_out.analysed):
        whole: Agreement | Concordance
        if table.protocol == "ranking":
            given = placements_of(answers)
            whole, retest = concordance(given), None
            n, participants = len(given.ranks), len(np.unique(given.participants))
        else:
            whole, retest = agreement_of(answers), retest_of(kept[name, question])
            n, participants = whole.n, whole.participants
        found.append(
            AgreedSoFar(
                set=set_name(table, name),
                question=question,
                measure="alpha" if retest else "w",
                estimate=whole.estimate,
                low=whole.low,
                high=whole.high,
                n=n,
                participants=participants,
                reason="" if whole.has_interval else whole.reason,
                retest=retest,
            )
        )
    return tuple(found)
