"""The results of one table of answers, from the file to `results.json`."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from threadpoolctl import threadpool_limits

from analysis.answers.exclusion_rules import ExclusionRule, RuleOutcome
from analysis.answers.participants import (
    MAX_CATCH_FAILURES,
    ArmState,
    Flow,
    LeftOut,
    Quality,
    leave_out,
    participant_flow,
    quality,
    table_rules,
)
from analysis.answers.reading import read_answers
from analysis.answers.table import LAYOUTS, AnswerTable
from analysis.results.conditions import (
    RankingResults,
    RatingResults,
    ranking_results,
    rating_results,
)
from analysis.results.grouping import EVERYTHING, ByQuestion, Family, read_family
from analysis.results.headline import Sensitivity, sensitivity
from analysis.results.pairwise import (
    MismatchResults,
    PairwiseResults,
    mismatch_results,
    pairwise_results,
)
from analysis.stats.multiple_testing import NOT_LOGGED, LooksBefore
from analysis.stats.one_sample_tests import require_margin
from motion.errors import InputError
from motion.files import sha256_of

if TYPE_CHECKING:
    from analysis.results.against_people import AgainstPeople

Results = PairwiseResults | RatingResults | RankingResults | MismatchResults

DIGITS: Final = 10
"""Significant digits of every number: more would differ between machines."""

Plain = None | bool | int | float | str | list["Plain"] | dict[str, "Plain"]


@dataclass(frozen=True, kw_only=True)
class Source:
    """The file and the version from which the results were computed."""

    file: str
    sha256: str
    motionjury: str


@dataclass(frozen=True, kw_only=True)
class Settings:
    """The researcher's choices; in a study, exclusion rules replace `max_catch_failures`."""

    max_catch_failures: int | None
    margin: float | None
    family: str = "all"


@dataclass(frozen=True, kw_only=True)
class Participants:
    """Number of participants in the table, and of those whom every rule kept."""

    recruited: int
    attentive: int


@dataclass(frozen=True, kw_only=True)
class TableReport:
    """The content of `results.json`.

    Attributes
    ----------
    protocol : str
        Name of the protocol.
    source : Source
        The source of the results.
    settings : Settings
        The researcher's choices.
    participants : Participants
        Numbers of participants.
    rules : tuple of RuleOutcome
        Outcomes of the exclusion rules, in the order in which they were applied.
    exclusions : dict of str to str
        The reason for each excluded participant.
    screened_out : mapping of str to int
        Number of people screened out before the trials, by stage: ``eligibility``, ``consent``,
        ``comprehension``; empty for a table.
    flow : tuple of Flow
        By arm; a single one for a table.
    conditions_shown, questions, sets : tuple of str
        In the order of appearance; () if the table has no sets.
    notes : tuple of str
        Sentences about rows that are not analysed, or that look like slips.
    remark : str
        Why there is nothing to report; empty otherwise.
    quality : Quality
        Response times and straight-lining.
    sensitivity : tuple of Sensitivity
        Headline numbers with and without exclusions; empty if nobody is excluded.
    looks : LooksBefore
        Looks at results before the answers that are reported.
    metrics_against_people : mapping of question to AgainstPeople
        Added by the report of a study with motion; see `metrics_against_people`.
    segments : int
        Number of segments in the analysed answers; not in `results.json`.
    kinds : frozenset of str
        Kinds of all trials in the table; not in `results.json`.
    results : Results
        The protocol's results.
    """

    protocol: str
    source: Source
    settings: Settings
    participants: Participants
    rules: tuple[RuleOutcome, ...]
    exclusions: dict[str, str]
    screened_out: Mapping[str, int]
    flow: tuple[Flow, ...]
    conditions_shown: tuple[str, ...]
    questions: tuple[str, ...]
    sets: tuple[str, ...]
    notes: tuple[str, ...]
    remark: str
    quality: Quality
    sensitivity: tuple[Sensitivity, ...]
    looks: LooksBefore = NOT_LOGGED
    metrics_against_people: ByQuestion[AgainstPeople] = field(default_factory=ByQuestion)
    segments: int
    kinds: frozenset[str]
    results: Results

    def keys(self) -> dict[str, object]:
        """Return the content of `results.json`, with the protocol's results at the top level."""
        document: dict[str, object] = {**vars(self)}
        del document["results"], document["segments"], document["kinds"]
        return document | vars(self.results)


def analyse_table(
    path: Path,
    protocol: str,
    *,
    max_catch_failures: int = MAX_CATCH_FAILURES,
    margin: float | None = None,
    family: str = "all",
    scale: tuple[int, int] | None = None,
    exclude: Sequence[ExclusionRule] = (),
) -> TableReport:
    """Read a platform's table and analyse it.

    Parameters
    ----------
    path : Path
        CSV or Parquet; see ``docs/report-contract.md`` for its columns.
    protocol : {'pairwise', 'rating', 'ranking', 'mismatch'}
        The protocol of the answers.
    max_catch_failures : int
        Failed catch trials that a participant may have.
    margin : float, optional
        Largest difference that does not matter, stated before the answers were seen: of a win
        share from one half, of two mean ratings in scores.
    family : str
        The tests that decide; see `read_family`.
    scale : (int, int), optional
        For ratings, the lowest and the highest possible rating.
    exclude : sequence of ExclusionRule
        Exploratory rules, applied after those of every table.

    Raises
    ------
    InputError
        If the table cannot be used, or the protocol has no test of equivalence.
    """
    table = read_answers(path, LAYOUTS[protocol], scale)
    return analyse_answers(
        table,
        leave_out(
            table,
            (
                *table_rules(table, max_catch_failures),
                *(rule.as_exploratory() for rule in exclude),
            ),
        ),
        source=Source(
            file=path.name,
            sha256=sha256_of(path),
            motionjury=metadata.version("motionjury"),
        ),
        settings=Settings(max_catch_failures=max_catch_failures, margin=margin, family=family),
    )


def analyse_answers(
    table: AnswerTable,
    left_out: LeftOut,
    *,
    source: Source,
    settings: Settings,
    arms: Sequence[ArmState] = (),
    arm_of: Mapping[str, str] | None = None,
    screened_out: Mapping[str, int] | None = None,
    looks: LooksBefore = NOT_LOGGED,
) -> TableReport:
    """Analyse checked answers, of a platform's table or of a study.

    Parameters
    ----------
    table : AnswerTable
        The answers.
    left_out : LeftOut
        The exclusions.
    source : Source
        The source of the answers.
    settings : Settings
        The researcher's choices.
    arms, arm_of
        The study's arms, and the arm of each participant; see `participant_flow`.
    screened_out : mapping of str to int, optional
        Number of people screened out, by stage; see `TableReport`.
    looks : LooksBefore, optional
        Earlier looks at a study's results; see `looks_before`.

    Raises
    ------
    InputError
        If a margin is given although the protocol has no test of equivalence, if the margin is out
        of range, or if the family names something unknown.
    """
    check_margin(table, settings.margin)
    family = (
        read_family(settings.family, table.conditions, table.questions)
        if table.conditions
        else EVERYTHING
    )
    # The models' matrices are small: more threads cost more than they save.
    with threadpool_limits(limits=1, user_api="blas"):
        results = _results(table, left_out, settings.margin, family)
    return TableReport(
        protocol=table.protocol,
        source=source,
        settings=settings,
        participants=Participants(recruited=left_out.recruited, attentive=left_out.attentive),
        rules=left_out.rules,
        exclusions=left_out.exclusions,
        screened_out=screened_out or {},
        flow=participant_flow(table, left_out, arms, arm_of),
        conditions_shown=table.conditions,
        questions=table.questions,
        sets=table.sets if table.has_sets else (),
        notes=table.notes,
        remark=_remark(table, left_out),
        quality=quality(left_out.everyone),
        sensitivity=sensitivity(table, left_out),
        looks=looks,
        segments=left_out.analysed["segment"].nunique(),
        kinds=frozenset(table.answers["kind"].unique()),
        results=results,
    )


def check_margin(table: AnswerTable, margin: float | None) -> None:
    """Refuse a meaningless margin of equivalence, or one that contains every difference.

    Raises
    ------
    InputError
        If the protocol has no test of equivalence, or the margin is out of range.
    """
    if margin is None:
        return
    if table.protocol not in ("pairwise", "rating"):
        raise InputError(
            f"a {table.protocol} study has no test of equivalence", remedy="Leave the margin out"
        )
    # A win share differs from one half by at most one half, ratings by at most the scale.
    widths = [high - low for low, high in table.scales.values()]
    require_margin(margin, 0.5 if table.protocol == "pairwise" else min(widths, default=math.inf))


def _results(
    table: AnswerTable, left_out: LeftOut, margin: float | None, family: Family
) -> Results:
    match table.protocol:
        case "pairwise":
            return pairwise_results(table, left_out, margin, family)
        case "rating":
            return rating_results(table, left_out, margin, family)
        case "ranking":
            return ranking_results(table, left_out, family)
        case _:
            return mismatch_results(table, left_out, family)


def _remark(table: AnswerTable, left_out: LeftOut) -> str:
    if left_out.everyone.empty:
        return "There are no answers to main or repeated trials: there is nothing to report."
    if left_out.analysed.empty:
        return "Every participant who answered is excluded: there is nothing to report."
    if table.protocol != "mismatch" and len(table.conditions) < 2:
        return "There is one condition: nothing can be compared."
    return ""


def plain(value: object) -> Plain:
    """Return frozen results, mappings, sequences and numbers as JSON values.

    Fields of results keep their order. NaN and infinity become None; another field of the result
    gives the reason.
    """
    if value is None or isinstance(value, bool | np.bool_):
        return None if value is None else bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return rounded(float(value))
    if isinstance(value, str):
        return value
    if isinstance(value, ByQuestion):
        return plain(value.nested())
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(item) for item in value]
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


def rounded(value: float) -> float | None:
    """Return a number with `DIGITS` significant digits, None for NaN and infinity."""
    if not math.isfinite(value):
        return None
    return float(f"{value:.{DIGITS}g}") + 0.0


def as_json(value: object) -> str:
    """Return results as the text of a JSON file."""
    return json.dumps(plain(value), ensure_ascii=False, allow_nan=False, indent=2) + "\n"
