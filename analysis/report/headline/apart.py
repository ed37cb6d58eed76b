"""Effects taken apart by emotion, speaker or segment, seen from the side that is asked about."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from analysis.report import wording
from analysis.report.headline.preference_rows import reference_of
from analysis.results.heterogeneity import (
    By,
    ConditionHeterogeneity,
    DifferenceTest,
    PairHeterogeneity,
)
from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.stats.clustered_mean import Estimate
from analysis.stats.heterogeneity import Cell

Results = PairwiseResults | RatingResults | RankingResults | MismatchResults


@dataclass(frozen=True, kw_only=True)
class Apart:
    """One effect by emotion, speaker or segment.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    about, question : str
        What it is the effect of, for reading, and the question's name.
    by : {'emotion', 'speaker', 'segment'}
        What tells the levels apart.
    measure : str
        'win_share', 'difference' or 'mean_rank'.
    null : float
        The effect of none.
    levels : tuple of Cell
        The effect within each.
    whole : Estimate or None
        The effect over all of them.
    test : DifferenceTest
        Whether they differ.
    """

    set: str | None
    about: str
    question: str
    by: By
    measure: str
    null: float
    levels: tuple[Cell, ...]
    whole: Estimate | None
    test: DifferenceTest

    @property
    def heading(self) -> str:
        """What heads its panel."""
        of = "" if self.set is None else f"Set {self.set}, "
        return f"{of}{wording.name(self.question)}: {self.about}"


def taken_apart(results: Results, reference: str | None) -> tuple[Apart, ...]:
    """Return all of a report's effects by emotion, speaker and segment.

    Parameters
    ----------
    results : PairwiseResults, RatingResults, RankingResults or MismatchResults
        What was found.
    reference : str or None
        The condition from whose side pairwise win shares are seen, where there is one.
    """
    match results:
        case PairwiseResults():
            return tuple(_pairwise(results, reference))
        case RatingResults():
            wholes = {(c.set, c.a, c.b, c.question): c.difference for c in results.contrasts}
            return tuple(
                _apart(
                    one, _against(one.a, one.b), wholes.get((one.set, one.a, one.b, one.question))
                )
                for one in results.heterogeneity
            )
        case RankingResults():
            means = {(c.set, c.condition, c.question): c.mean_rank for c in results.conditions}
        case MismatchResults():
            means = {(c.set, c.condition, c.question): c.win_share for c in results.conditions}
    return tuple(
        _apart(one, wording.name(one.condition), means.get((one.set, one.condition, one.question)))
        for one in results.heterogeneity
    )


def _pairwise(results: PairwiseResults, reference: str | None) -> Iterable[Apart]:
    wholes = {(c.set, c.a, c.b, c.question): c.win_share for c in results.comparisons}
    from_side = {
        name: reference_of([c for c in results.comparisons if c.set == name], reference)
        for name in dict.fromkeys(c.set for c in results.comparisons)
    }
    for one in results.heterogeneity:
        found = _apart(
            one, _against(one.a, one.b), wholes.get((one.set, one.a, one.b, one.question))
        )
        yield _turned(found, one) if one.b == from_side[one.set] else found


def _turned(found: Apart, of: PairHeterogeneity) -> Apart:
    return replace(
        found,
        about=_against(of.b, of.a),
        levels=tuple(level.turned() for level in found.levels),
        whole=None if found.whole is None else found.whole.turned(),
    )


def _apart(
    of: PairHeterogeneity | ConditionHeterogeneity, about: str, whole: Estimate | None
) -> Apart:
    return Apart(
        set=of.set,
        about=about,
        question=of.question,
        by=of.by,
        measure=of.measure,
        null=of.null,
        levels=of.levels,
        whole=whole,
        test=of.test,
    )


def _against(one: str, other: str) -> str:
    return f"{wording.name(one)} against {wording.name(other)}"
