"""What came of a rehearsal, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from scipy.stats import binom

from analysis.report.wording import (
    condition,
    count,
    difference_style,
    labelled,
    name,
    number_style,
    question_name,
)
from analysis.results.known_values import NO_RANK_INTERVAL, KnownDifference, KnownValue, Sign
from analysis.stats.clustered_mean import LEVEL, Estimate
from motion.errors import listed
from studyapp.rehearsal.recovered import KindRecovered, Recovery

SIGNS: Final[Mapping[Sign, str]] = MappingProxyType(
    {
        "right": "found with the right sign",
        "wrong": "found with the wrong sign",
        "undecided": "not told apart",
        "equal": "rightly not told apart",
    }
)
"""What becomes of a comparison, in words that follow a number."""

TOLD: Final = 4
"""Comparisons without an answer that are told in short."""


def intervals_in_words(recovery: Recovery) -> str:
    """Say how many intervals hold the true value, and how much of it is chance."""
    if not recovery.values:
        return "No true value could be estimated: too few answered, or ranks may be shared."
    without = len(recovery.values) - recovery.intervals
    none = f" {count(without, 'number')} {_has(without)} no interval." if without else ""
    return (
        f"{recovery.intervals - recovery.missed} of {count(recovery.intervals, 'interval')} "
        f"{'holds' if recovery.intervals == 1 else 'hold'} the true value."
        f"{none} {chance_in_words(recovery.missed, recovery.intervals)}"
    )


def signs_in_words(recovery: Recovery) -> str:
    """Say how often the better one of two was found."""
    signs = [difference.sign for difference in recovery.differences]
    if not signs:
        return "No two conditions could be compared."
    parts = [f"{signs.count(sign)} {SIGNS[sign]}" for sign in SIGNS if signs.count(sign)]
    return f"{count(len(signs), 'comparison')}: {listed(parts)}."


def unanswered_in_words(recovery: Recovery) -> Iterator[str]:
    """Say of a few comparisons why the better one was not found, and how many more there are."""
    unanswered = [each for each in recovery.differences if each.sign in ("undecided", "wrong")]
    # What is found with the wrong sign is worth more than what is not found.
    unanswered.sort(key=lambda each: each.sign == "undecided")
    yield from map(difference_in_words, unanswered[:TOLD])
    if len(unanswered) > TOLD:
        yield f"… and {len(unanswered) - TOLD} more, which the table on the page lists"


def difference_in_words(difference: KnownDifference) -> str:
    """Say why the better one of two was not found, as far as that can be said."""
    what = (
        f"{question_name(difference.part, difference.question)}: "
        f"{condition(difference.first)} and {condition(difference.second)}"
    )
    found, half = difference.found, difference.half_width
    signed, written = difference_style(difference.measure), number_style(difference.measure)
    truth = signed(difference.truth)
    if difference.sign == "wrong":
        return (
            f"{what}: the analysis finds {signed(found.estimate)} where {truth} is "
            "true. A sound design errs so in at most 1 of 40 rehearsals; where the difference is "
            "small, it is chance or the luck of the segments."
        )
    if math.isnan(half):
        why = found.reason or "there are too few answers"
        if why == NO_RANK_INTERVAL:
            why = "the test of worths is not significant"
        return f"{what} are not told apart: {why}. The true difference is {truth}."
    people = count(found.participants, "participant")
    if abs(difference.truth) <= half:
        return (
            f"{what}: the design cannot answer this question. {people} give an interval of "
            f"±{written(half)}, the true difference is {truth}: see 'motionjury plan'."
        )
    return (
        f"{what} are not told apart this time, though the interval of ±{written(half)} from "
        f"{people} is narrower than the true difference of {truth}: so it goes now and then; "
        "'motionjury plan' says how often."
    )


def exclusions_in_words(kinds: tuple[KindRecovered, ...]) -> Iterator[str]:
    """Say whom the rules of exclusion caught, missed and wrongly left out."""
    bad = [kind for kind in kinds if kind.should_be_excluded]
    caught, came = sum(kind.excluded for kind in bad), sum(kind.came for kind in bad)
    silent, missed = sum(kind.silent for kind in bad), sum(kind.missed for kind in bad)
    wrongly = sum(kind.wrongly_excluded for kind in kinds)
    good = sum(kind.came for kind in kinds) - came
    yield (
        f"Exclusion: of {came} who answered badly or left, {caught} {_is(caught)} left out, "
        f"{silent} gave no answer, {missed} {_is(missed)} analysed all the same; of {good} others, "
        f"{wrongly} {_is(wrongly)} wrongly left out."
    )
    for kind in kinds:
        if kind.missed or kind.wrongly_excluded:
            rules = listed([f"{removed} by {rule}" for rule, removed in kind.excluded_by.items()])
            yield (
                f"  {name(kind.kind)}: {kind.came} came, {kind.analysed} analysed, "
                f"{rules or 'none'}{'' if rules else ' left out'}"
            )


def counts_in_words(recovery: Recovery) -> str:
    """Say whether people and answers were counted right."""
    wrong = recovery.miscounted
    if wrong:
        said = "; ".join(f"{each.what}: {each.happened}, counted {each.counted}" for each in wrong)
        return f"COUNTED WRONG: {said}."
    by_words = {check.what: check.happened for check in recovery.checks}
    answers = next((n for what, n in by_words.items() if what.startswith("acknowledged")), 0)
    return (
        "Everything was counted correctly: "
        f"{count(answers, 'acknowledged answer')} stored, each once; "
        f"{by_words.get('left for good', 0)} left for good, "
        f"{by_words.get('came back after leaving and finished', 0)} came back."
    )


def _is(number: int) -> str:
    return "is" if number == 1 else "are"


def _has(number: int) -> str:
    return "has" if number == 1 else "have"


HEADINGS: Final = ("question", "of", "number", "true value", "found", "interval", "")
FIRST_NUMBER: Final = 3


def recovery_lines(recovery: Recovery) -> list[str]:
    """Return a table of true values and estimates, and sentences about all else."""
    with labelled(recovery.labels):
        rows = [_row(known, found) for known, found in recovery.values]
        table = _in_columns([HEADINGS, *rows]) if rows else ()
        return [
            *table,
            intervals_in_words(recovery),
            signs_in_words(recovery),
            *(f"  {line}" for line in unanswered_in_words(recovery)),
            *exclusions_in_words(recovery.kinds),
            counts_in_words(recovery),
        ]


def _row(known: KnownValue, found: Estimate) -> tuple[str, ...]:
    written = number_style(known.measure)
    return (
        question_name(known.part, known.question),
        condition(known.about),
        name(known.measure),
        written(known.value),
        written(found.estimate),
        f"{written(found.low)} to {written(found.high)}" if found.has_interval else "–",
        _where(found, known.value),
    )


def _where(found: Estimate, value: float) -> str:
    if not found.has_interval:
        return found.reason
    return "" if found.covers(value) else "outside"


def _in_columns(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(
            text.rjust(width) if FIRST_NUMBER <= place < len(row) - 1 else text.ljust(width)
            for place, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()


HARDLY_CHANCE: Final = 0.01
"""Below this, so many misses call for another reason than chance."""


def chance_in_words(missed: int, intervals: int) -> str:
    """Return what so many misses say, as a sentence.

    If all is sound, each interval misses with 1 minus its level (Binomial). Questions that the same
    people answer lean together, so that many misses at once come somewhat more often.
    """
    if not intervals:
        return "There is no interval to be held against a true value."
    often = float(binom.sf(missed - 1, intervals, 1 - LEVEL))
    of_all = count(intervals, "interval")
    if not missed:
        return (
            f"A sound design finds all of {of_all} right in {100 * LEVEL**intervals:.0f} of 100 "
            "rehearsals."
        )
    if often < HARDLY_CHANCE:
        return (
            f"A sound design misses {missed} or more of {of_all} in fewer than 1 of 100 "
            "rehearsals: look at who was not excluded, and at how few people or segments there are."
        )
    return (
        f"A sound design misses {missed} or more of {of_all} in {100 * often:.0f} of 100 "
        "rehearsals, and somewhat more often where several questions go to the same people."
    )
