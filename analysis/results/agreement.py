"""How far participants agree with one another, and with themselves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.grouping import codes
from analysis.stats.intraclass import Intraclass, intraclass_correlation
from analysis.stats.krippendorff import Alpha, krippendorff_alpha
from analysis.stats.retest import Retest, retest_agreement

LEVEL: Final = "ordinal"


@dataclass(frozen=True, kw_only=True)
class Agreement(Alpha):
    """Krippendorff's alpha for ordered answers; not a condition for anything.

    Attributes
    ----------
    icc : Intraclass
        The same question asked of variances, of numbers equally far apart.
    """

    icc: Intraclass


def agreement_of(
    values: NDArray[np.number], participants: NDArray[np.intp], items: NDArray[np.intp]
) -> Agreement:
    """Return ordinal alpha and the ICC; of several answers about an item, a participant's first."""
    # A key of both, so that one pass finds who answered twice.
    key = participants.astype(np.int64) * (int(items.max(initial=0)) + 1) + items
    first = np.sort(np.unique(key, return_index=True)[1])
    own = values[first], participants[first], items[first]
    alpha = krippendorff_alpha(*own, level=LEVEL)
    return Agreement(**vars(alpha), icc=intraclass_correlation(*own))


def retest_of(
    answers: pd.DataFrame,
    values: NDArray[np.integer],
    shown: Mapping[str, NDArray[np.intp]],
) -> Retest:
    """Compare practice trials with their repeats.

    Of several answers in practice the last counts, of repeats the first.

    Parameters
    ----------
    answers : DataFrame
        Of one question, practice trials included, of those whom every rule kept.
    values : ndarray of int, shape (N,)
        The answers, counted towards a condition and not towards a side: sides may be swapped.
    shown : mapping of name to ndarray of int, shape (N,)
        What a trial and its repeat have in common besides the segment.
    """
    rows = pd.DataFrame(
        {
            "participant": codes(answers, "participant"),
            "segment": codes(answers, "segment"),
            "kind": answers["kind"].to_numpy(object),
            "value": values,
            **shown,
        }
    )
    keys = ["participant", "segment", *shown]
    first = rows[rows["kind"] == "practice"].drop_duplicates(keys, keep="last")
    again = rows[rows["kind"] == "repeat"].drop_duplicates(keys, keep="first")
    pairs = first.merge(again, on=keys, suffixes=("_first", "_again"), validate="one_to_one")
    return retest_agreement(
        pairs["value_first"].to_numpy(np.int64),
        pairs["value_again"].to_numpy(np.int64),
        pairs["participant"].to_numpy(),
    )
