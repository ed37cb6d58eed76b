"""A report's decisions in studies other than rehearsals."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import pandas as pd

from analysis.results.grouping import EVERYTHING
from analysis.results.strengths import (
    StrengthDifference,
    StrengthModel,
    fit_strengths,
    fit_worths,
)
from analysis.stats.clustered_mean import clustered_mean
from benchmarks.validity.conclusions.conclusion import Conclusion, Protocol, no_truths
from benchmarks.validity.studies import Codes, Design, judgements, preferences, ranks, votes

SYSTEMS: Final = tuple("abcdef")

WIN_SHARE: Final = "win share of one pair"
STRENGTHS: Final = "any difference of strengths, Holm"
TOGETHER: Final = "all strengths together"
WORTHS: Final = "any difference of worths, Holm"
WORTHS_TOGETHER: Final = "all worths together"


def conclude_verdicts(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return the decisions on one study each of pairs, many conditions and rankings."""
    study = preferences(design, generator)
    share = clustered_mean(study.wins, study.participants, study.items)
    judged = judgements(design, len(SYSTEMS), generator)
    left, right, outcome = votes(judged, generator, popular=design.process == "leaderboard")
    rows = {"participant": judged.participants, "segment": judged.items}
    voted = _table(rows | {"left": left, "right": right, "value": 3 - 2 * outcome})
    given = ranks(judged, generator)[:, :4].argsort(axis=1).argsort(axis=1) + 1
    count = len(given)
    ranked = _table(
        {name: np.repeat(codes, 4) for name, codes in rows.items()}
        | {
            "trial": np.repeat(np.arange(count), 4),
            "condition": np.tile(np.arange(4), count),
            "value": given.ravel(),
        }
    )
    return {
        WIN_SHARE: Conclusion(p_value=share.p_value),
        **_of(fit_strengths(voted, None, "q"), STRENGTHS, TOGETHER),
        **_of(fit_worths(ranked, None, "q"), WORTHS, WORTHS_TOGETHER),
    }


def _of(
    found: tuple[StrengthModel, Sequence[StrengthDifference]], any_one: str, together: str
) -> Mapping[str, Conclusion]:
    fitted, contrasts = found
    held = EVERYTHING.decide(contrasts)
    smallest = np.fmin.reduce([one.p_holm for one in held])
    return {
        any_one: Conclusion(p_value=float(smallest)),
        together: Conclusion(p_value=fitted.omnibus.p_value),
    }


def _table(columns: Mapping[str, Codes]) -> pd.DataFrame:
    """Return answers as the report reads them, with names as categories."""
    names: dict[str, Sequence[str]] = dict.fromkeys(("left", "right", "condition"), SYSTEMS)

    def named(column: str, values: Codes) -> pd.Categorical:
        every = names.get(column) or [str(number) for number in range(int(values.max()) + 1)]
        return pd.Categorical(np.asarray(every)[values], categories=list(every))

    return pd.DataFrame(
        {
            name: values if name == "value" else named(name, values)
            for name, values in columns.items()
        }
    )


VERDICTS: Final = Protocol(conclude=conclude_verdicts, truths=no_truths)
