"""Where an effect comes from: emotions, speakers, segments, and single pairs of clips."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeVar, cast

import numpy as np
import pandas as pd

from analysis.answers.table import AnswerTable
from analysis.results.grouping import (
    ConditionKey,
    PairKey,
    ResultKey,
    codes,
    shown_codes,
    split_by_key,
)
from analysis.results.mixed_models import sided
from analysis.stats.clustered_mean import UNTESTED, Estimate, clustered_mean
from analysis.stats.f_tests import FTest, between_groups, between_segments
from analysis.stats.multiple_testing import holm
from motion.arrays import Floats

By = Literal["emotion", "speaker", "segment"]

KINDS: Final[tuple[By, ...]] = ("emotion", "speaker", "segment")


FEW: Final = 3
"""Most segments of a cell that is described and not tested."""


@dataclass(frozen=True, kw_only=True)
class Cell(Estimate):
    """The effect within one emotion, segment or speaker.

    Attributes
    ----------
    level : str
        The emotion, segment or speaker.
    descriptive : bool
        Whether the cell has too few segments to be tested: it does not generalise to other
        segments, and `p_value` is NaN.
    p_holm : float
        `p_value`, corrected over all such tests of a report.
    """

    level: str
    descriptive: bool
    p_holm: float = math.nan


@dataclass(frozen=True, kw_only=True)
class DifferenceTest(FTest):
    """Whether any levels differ; `p_holm` is corrected over all such tests of the report."""

    p_holm: float = math.nan


@dataclass(frozen=True, kw_only=True)
class Heterogeneity:
    """An effect by emotion, by speaker or by segment.

    Attributes
    ----------
    by : {'emotion', 'speaker', 'segment'}
        Factor of the levels.
    measure : {'win_share', 'difference', 'mean_rank'}
        The effect: share of wins, difference of paired ratings in scores, or mean rank.
    null : float
        The measure if there is no effect.
    levels : tuple of Cell
        In the order of their names; those without answers are left out.
    test : DifferenceTest
        Whether they differ.
    """

    by: By
    measure: str
    null: float
    levels: tuple[Cell, ...]
    test: DifferenceTest


@dataclass(frozen=True, kw_only=True)
class PairHeterogeneity(Heterogeneity, PairKey):
    """An effect between two conditions by emotion, speaker or segment."""


@dataclass(frozen=True, kw_only=True)
class ConditionHeterogeneity(Heterogeneity, ConditionKey):
    """An effect of one condition by emotion, speaker or segment."""


AnyHeterogeneity = TypeVar("AnyHeterogeneity", bound=Heterogeneity)


def heterogeneity(
    kind: type[AnyHeterogeneity],
    key: ResultKey,
    answers: pd.DataFrame,
    values: Floats,
    *,
    measure: str,
    null: float,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> Iterator[AnyHeterogeneity]:
    """Estimate an effect by emotion, speaker and segment, if there are several of each.

    Parameters
    ----------
    kind : type
        `PairHeterogeneity` or `ConditionHeterogeneity`.
    key : ResultKey
        The subject of the effect.
    answers : DataFrame
        Main and repeated trials of one question, with one row per value.
    values : ndarray, shape (N,)
        Their mean is the effect.
    measure, null : str, float
        See `Heterogeneity`.
    limits : (float, float)
        The range of possible values.
    """
    for by in KINDS:
        known = codes(answers, by) >= 0
        part, effects = answers[known], values[known]
        levels = codes(part, by)
        rows_of_levels = pd.Series(levels).groupby(levels).indices
        if len(rows_of_levels) < 2:
            continue
        participants, segments = codes(part, "participant"), codes(part, "segment")
        means = {
            str(part[by].cat.categories[cast(int, level)]): clustered_mean(
                effects[rows], participants[rows], segments[rows], null=null, limits=limits
            )
            for level, rows in rows_of_levels.items()
        }
        test = (
            between_segments(effects, participants, segments)
            if by == "segment"
            else between_groups(effects, levels, participants, segments)
        )
        yield kind(
            **vars(key),
            by=by,
            measure=measure,
            null=null,
            levels=tuple(_cell(level, means[level]) for level in sorted(means)),
            test=DifferenceTest(**vars(test)),
        )


def _cell(level: str, mean: Estimate) -> Cell:
    count = mean.segments
    if descriptive := count <= FEW:
        untested = f"{count} segment{'s' * (count > 1)}: {UNTESTED}"
        remark = "; ".join(filter(None, (untested, mean.remark)))
        mean = replace(mean, p_value=math.nan, remark=remark)
    return Cell(**vars(mean), level=level, descriptive=descriptive)


def preference_heterogeneity(
    kind: type[AnyHeterogeneity], table: AnswerTable, analysed: pd.DataFrame
) -> list[AnyHeterogeneity]:
    """Estimate every win share, of a or of the own speech, by emotion, speaker and segment."""
    return [
        result
        for key, answers in split_by_key(table, analysed)
        for result in heterogeneity(
            kind,
            key,
            answers,
            sided(answers).wins,
            measure="win_share",
            null=0.5,
            limits=(0.0, 1.0),
        )
    ]


def correct_tests(results: Sequence[AnyHeterogeneity]) -> tuple[AnyHeterogeneity, ...]:
    """Return the results of a report with Holm's correction of tests and of levels."""
    tests = holm([result.test.p_value for result in results])
    # A level that is only described does not belong to the family.
    of_levels = iter(
        holm([cell.p_value for result in results for cell in result.levels if not cell.descriptive])
    )
    return tuple(
        replace(
            result,
            levels=tuple(
                cell if cell.descriptive else replace(cell, p_holm=next(of_levels))
                for cell in result.levels
            ),
            test=replace(result.test, p_holm=p_holm),
        )
        for result, p_holm in zip(results, tests, strict=True)
    )


MOST_PAIRS: Final = 12
"""Most pairs to show; of more, those at both ends of the order are kept."""

_CLIPS: Final = ["first", "second", "segment"]


@dataclass(frozen=True, kw_only=True)
class PreferredPair:
    """Two clips of one segment, and how often the first was preferred.

    Attributes
    ----------
    segment, first, second : str
        Segment and conditions, in the order of the table.
    win_shares : mapping of str to float
        Win share of the first by question, in [0, 1]; ties count as one half.
    answers : mapping of str to int
        Number of answers behind each share.
    """

    segment: str
    first: str
    second: str
    win_shares: Mapping[str, float]
    answers: Mapping[str, int]


def preferred_pairs(table: AnswerTable, analysed: pd.DataFrame) -> tuple[PreferredPair, ...]:
    """Return, for each pair of conditions, the segments in which the first won most and least.

    They are sorted by the win share on the table's first question, the highest first. In ratings
    and rankings, the clip that a participant placed higher won. A mismatch task has no pairs,
    because nobody compares conditions there.

    Parameters
    ----------
    table : AnswerTable
        The answers.
    analysed : DataFrame
        The analysed answers.
    """
    if table.protocol == "mismatch" or analysed.empty:
        return ()
    wins = (
        _pair_wins(analysed)
        if table.protocol == "pairwise"
        else _placed_wins(table.protocol, analysed)
    )
    shares = wins.groupby([*_CLIPS, "question"], sort=False)["win"].agg(["mean", "size"])
    shares = shares.reset_index()
    first_question = shares[shares["question"] == table.questions[0]]
    ordered = first_question.sort_values(["mean", *_CLIPS], ascending=[False, True, True, True])
    by_pair = ordered.groupby(["first", "second"])
    ends = ordered[ordered.index.isin([*by_pair.head(1).index, *by_pair.tail(1).index])]
    if len(ends) > MOST_PAIRS:
        ends = pd.concat([ends.head(MOST_PAIRS // 2), ends.tail(MOST_PAIRS // 2)])
    return tuple(_pair(table, clips, shares) for clips in ends[_CLIPS].itertuples(index=False))


def _pair(table: AnswerTable, clips: tuple[int, int, str], shares: pd.DataFrame) -> PreferredPair:
    first, second, segment = clips
    rows = shares[(shares[_CLIPS] == list(clips)).all(axis=1)]
    questions = rows["question"].tolist()
    return PreferredPair(
        segment=segment,
        first=table.conditions[first],
        second=table.conditions[second],
        win_shares=dict(zip(questions, rows["mean"].tolist(), strict=True)),
        answers=dict(zip(questions, rows["size"].tolist(), strict=True)),
    )


def _pair_wins(answers: pd.DataFrame) -> pd.DataFrame:
    """Return whether the first of two videos shown together won, a row for each answer."""
    pair = shown_codes(answers)
    return pd.DataFrame(
        {
            "first": pair["a"],
            "second": pair["b"],
            "segment": answers["segment"].astype(str),
            "question": answers["question"].astype(str),
            "win": sided(answers).wins,
        }
    )


def _placed_wins(protocol: str, answers: pd.DataFrame) -> pd.DataFrame:
    """Return whether the first won of every two clips that a participant rated or ranked."""
    together = ["participant", "set", "segment", "question"]
    placed = pd.DataFrame(
        {
            **{name: answers[name].astype(str) for name in together},
            "first": shown_codes(answers)["condition"],
            "value": answers["value"].to_numpy(float) * (-1 if protocol == "ranking" else 1),
        }
    )
    seconds = placed.rename(columns={"first": "second"})
    both = placed.merge(seconds, on=together, suffixes=("", "_of_second"))
    both = both[both["first"] < both["second"]]
    return both.assign(win=(np.sign(both["value"] - both["value_of_second"]) + 1) / 2)
