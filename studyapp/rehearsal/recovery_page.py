"""The results of a rehearsal: in sentences, and all of them on a short page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from scipy.stats import binom

from analysis.report import wording
from analysis.report.content import MARKS, Section
from analysis.report.page import Page, render_page
from analysis.report.texts import table
from analysis.results.known_values import NO_RANK_INTERVAL, KnownDifference, Sign
from analysis.stats.clustered_mean import LEVEL
from motion.errors import listed
from motion.files import write_text
from studyapp.rehearsal.bookkeeping import ANSWERED, BACK, LEFT
from studyapp.rehearsal.recovered import KindRecovered, Recovery
from studyapp.rehearsal.simulation.population import DESCRIPTIONS
from studyapp.study.folder import StudyFolder

SIGNS: Final[Mapping[Sign, str]] = {
    "right": "found with the right sign",
    "wrong": "found with the wrong sign",
    "undecided": "undecided",
    "equal": "rightly undecided",
}
"""The outcomes of comparisons, in words that follow their number."""

MOST_LISTED: Final = 4
"""Undecided or wrong comparisons that are described; the page lists all."""


def intervals_in_words(recovery: Recovery) -> str:
    """Say how many intervals contain the true value, and how likely so many misses are."""
    without = len(recovery.values) - recovery.intervals
    none = f" {wording.count(without, 'number')} without an interval." if without else ""
    if not recovery.intervals:
        return f"No interval could be computed: too few answered, or ranks may be tied.{none}"
    inside = recovery.intervals - recovery.missed
    return (
        f"The true value is inside {inside} of {wording.count(recovery.intervals, 'interval')}. "
        f"{chance_in_words(recovery.missed, recovery.intervals)}{none}"
    )


def signs_in_words(recovery: Recovery) -> str:
    """Say how often the better of two conditions was found."""
    signs = [difference.sign for difference in recovery.differences]
    if not signs:
        return "No two conditions could be compared."
    parts = [f"{signs.count(sign)} {SIGNS[sign]}" for sign in SIGNS if signs.count(sign)]
    return f"{wording.count(len(signs), 'comparison')}: {listed(parts)}."


def unanswered_in_words(recovery: Recovery) -> Iterator[str]:
    """Say of a few comparisons why the better condition was not found, and count the rest."""
    unanswered = [each for each in recovery.differences if each.sign in ("undecided", "wrong")]
    # Wrong signs matter most.
    unanswered.sort(key=lambda each: each.sign == "undecided")
    yield from map(difference_in_words, unanswered[:MOST_LISTED])
    if len(unanswered) > MOST_LISTED:
        yield f"… and {len(unanswered) - MOST_LISTED} more in the table on the page"


def difference_in_words(difference: KnownDifference) -> str:
    """Say why the better of two conditions was not found, as far as that is known."""
    what = (
        f"{wording.question_name(difference.part, difference.question)}: "
        f"{wording.condition(difference.first)} and {wording.condition(difference.second)}"
    )
    estimate, half = difference.estimate, difference.half_width
    signed, written = (
        wording.difference_style(difference.measure),
        wording.number_style(difference.measure),
    )
    truth = signed(difference.truth)
    if difference.sign == "wrong":
        return (
            f"{what}: the analysis finds {signed(estimate.estimate)}, but the true difference is "
            f"{truth}. A sound design gets the sign wrong in at most 1 of 40 rehearsals; if the "
            "difference is small, that is due to chance or to the choice of segments."
        )
    if math.isnan(half):
        why = estimate.reason or "there are too few answers"
        if why == NO_RANK_INTERVAL:
            why = "the test of worths is not significant"
        return f"{what}: undecided ({why}). The true difference is {truth}."
    people = wording.count(estimate.participants, "participant")
    if abs(difference.truth) <= half:
        return (
            f"{what}: the design cannot answer this question. With {people}, the interval is "
            f"±{written(half)}, but the true difference is {truth}: see 'motionjury plan'."
        )
    return (
        f"{what}: undecided this time, although with {people} the interval of ±{written(half)} is "
        f"narrower than the true difference of {truth}. That is bad luck; 'motionjury plan' says "
        "how often it happens."
    )


def exclusions_in_words(kinds: tuple[KindRecovered, ...]) -> Iterator[str]:
    """Say whom the exclusion rules caught, missed and wrongly excluded."""
    bad = [kind for kind in kinds if kind.should_be_excluded]
    caught, came = sum(kind.excluded for kind in bad), sum(kind.came for kind in bad)
    silent, missed = sum(kind.silent for kind in bad), sum(kind.missed for kind in bad)
    wrongly = sum(kind.wrongly_excluded for kind in kinds)
    good = sum(kind.came for kind in kinds) - came
    yield (
        f"Exclusion: of {came} who answered badly or left, {caught} {_is(caught)} excluded, "
        f"{silent} gave no answer and {missed} {_is(missed)} analysed anyway; of {good} others, "
        f"{wrongly} {_is(wrongly)} wrongly excluded."
    )
    for kind in kinds:
        if kind.missed or kind.wrongly_excluded:
            excluded = [f"{number} excluded by {rule}" for rule, number in kind.excluded_by.items()]
            yield (
                f"  {wording.name(kind.kind)}: {kind.came} came, {kind.analysed} analysed, "
                f"{listed(excluded) or 'none excluded'}"
            )


def counts_in_words(recovery: Recovery) -> str:
    """Say whether people and answers were counted correctly."""
    if wrong := [check for check in recovery.checks if not check.agrees]:
        counts = "; ".join(
            f"{each.what}: {each.happened}, counted {each.counted}" for each in wrong
        )
        return f"MISCOUNTED: {counts}."
    counted = {check.what: check.happened for check in recovery.checks}
    return (
        "Everything was counted correctly: "
        f"{wording.count(counted.get(ANSWERED, 0), 'acknowledged answer')} stored, each once; "
        f"{counted.get(LEFT, 0)} left for good, {counted.get(BACK, 0)} came back."
    )


def _is(number: int) -> str:
    return "is" if number == 1 else "are"


def values_in_words(recovery: Recovery) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
    """Return heading and rows of the page's table of true values, without its last column."""
    with wording.labelled(recovery.labels):
        values = table("truth", recovery.values)
    return values.header[:-1], [[cell.text for cell in row[:-1]] for row in values.rows]


def recovery_lines(recovery: Recovery) -> list[str]:
    """Return sentences about everything but the single values."""
    with wording.labelled(recovery.labels):
        return [
            intervals_in_words(recovery),
            signs_in_words(recovery),
            *(f"  {line}" for line in unanswered_in_words(recovery)),
            *exclusions_in_words(recovery.kinds),
            counts_in_words(recovery),
        ]


HARDLY_CHANCE: Final = 0.01
"""Below this probability, chance does not explain the misses."""


def chance_in_words(missed: int, intervals: int) -> str:
    """Say how often so many intervals miss the true value with a sound design.

    Each interval then misses with probability 1 minus its level (Binomial). Answers of the same
    people to several questions are correlated, which makes many misses at once more common.
    """
    if not missed:
        return f"With a sound design, none misses it in {_of_100(LEVEL**intervals)}."
    often = _of_100(float(binom.sf(missed - 1, intervals, 1 - LEVEL)))
    return (
        f"With a sound design, at least {wording.count(missed, 'interval')} would miss it in "
        f"{often}, and somewhat more often if the same people answer several questions."
    )


def _of_100(probability: float) -> str:
    times = "fewer than 1" if probability < HARDLY_CHANCE else f"{100 * probability:.0f}"
    return f"{times} of 100 rehearsals"


PAGE: Final = "recovery.html"


def write_recovery(folder: StudyFolder, recovery: Recovery) -> Path:
    """Write the page into the rehearsal's folder and return its path."""
    path = folder.rehearsal_findings / PAGE
    with wording.labelled(recovery.labels):
        write_text(path, render_page(recovery_page(recovery)))
    return path


def recovery_page(recovery: Recovery) -> Page:
    """Return the page of a rehearsal's results."""
    mark, mark_short = MARKS["rehearsal"]
    return Page(
        title=f"What the rehearsal found: {recovery.title}",
        mark=mark,
        mark_short=mark_short,
        answer=(intervals_in_words(recovery), signs_in_words(recovery), counts_in_words(recovery)),
        picture=None,
        flow="",
        sections=_sections(recovery),
    )


def _sections(recovery: Recovery) -> tuple[Section, ...]:
    rules = sorted({rule for kind in recovery.kinds for rule in kind.excluded_by})
    return (
        Section(
            anchor="values",
            heading="True values, and what the analysis finds",
            paragraphs=(
                "The true value is what a very large number of attentive raters would say about "
                "all segments like these. Inattentive raters answer too, as they do in studies, "
                "and blur the estimates as they would there.",
            ),
            tables=(table("truth", recovery.values),),
        ),
        Section(
            anchor="differences",
            heading="Which condition is better",
            paragraphs=(signs_in_words(recovery),),
            bullets=tuple(unanswered_in_words(recovery)),
            tables=(table("truth_of_differences", recovery.differences),),
        ),
        Section(
            anchor="raters",
            heading="Who came, and who was left out",
            paragraphs=tuple(line.strip() for line in exclusions_in_words(recovery.kinds)),
            bullets=tuple(f"Rule: {rule}" for rule in recovery.rules),
            tables=(
                table("rehearsed_kinds", recovery.kinds, rules=rules, descriptions=DESCRIPTIONS),
            ),
        ),
        Section(
            anchor="bookkeeping",
            heading="Whether everything was counted correctly",
            paragraphs=(counts_in_words(recovery),),
            tables=(table("bookkeeping", recovery.checks),),
        ),
    )
