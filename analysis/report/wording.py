"""Numbers, estimates and names as a reader wants them: sensible digits, no underscore."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from types import MappingProxyType
from typing import Final

from analysis.results.grouping import ResultKey
from analysis.results.headline import Measure
from analysis.results.strengths import ConditionStrength
from analysis.stats.clustered_mean import LEVEL, Estimate, Interval
from analysis.stats.f_tests import FTest

NO_BREAK: Final = "\u00a0"
"""A space at which no line is broken."""

_ZERO: Final = 1e-9


_LABELS: ContextVar[Mapping[str, str]] = ContextVar("_LABELS", default=MappingProxyType({}))
"""What conditions are called on the page that is being written, where that is not their name."""


@contextmanager
def labelled(labels: Mapping[str, str]) -> Iterator[None]:
    """Have `condition` give `labels`, by name, inside of the context.

    Every table and figure names conditions; handing the labels to each of them would burden all.
    """
    before = _LABELS.set(labels)
    try:
        yield
    finally:
        _LABELS.reset(before)


def condition(name_in_results: str) -> str:
    """Return what a condition is called: its label, or its name for reading."""
    return _LABELS.get().get(name_in_results) or name(name_in_results)


def against(a: str, b: str) -> str:
    """Return what the comparison of two conditions is called."""
    return f"{condition(a)} against {condition(b)}"


def name(plain: str) -> str:
    """Return the name of a question, a set or a segment for reading."""
    return plain.replace("_", " ")


def heading(question: str) -> str:
    """Return a name as a heading: its first letter large, the others as they are."""
    text = name(question)
    return text[:1].upper() + text[1:]


def share(value: float) -> str:
    """Return a share with two digits, '.63'; a dash for NaN."""
    if math.isnan(value):
        return "–"
    text = f"{abs(value):.2f}"
    sign = "−" if value < 0 and float(text) else ""
    return sign + (text[1:] if text.startswith("0") else text)


MEASURES: Final[Mapping[Measure, str]] = MappingProxyType(
    {
        "win_share": "win share of the first",
        "own_speech": "share of preferences for its own speech",
        "mean_rating": "mean rating",
        "mean_rank": "mean rank (1 is best)",
    }
)
"""What a headline number is."""


def number_style(measure: Measure) -> Callable[[float], str]:
    """Return how numbers of `measure` are written: shares as '.63', means as '3.63'."""
    return share if measure in ("win_share", "own_speech") else number


def difference_style(measure: Measure) -> Callable[[float], str]:
    """Return how differences of `measure` are written: as its numbers, with a sign."""
    written = number_style(measure)

    def with_sign(value: float) -> str:
        text = written(value)
        return f"+{text}" if value > 0 and text.strip("0.") else text

    return with_sign


def p_value(value: float) -> str:
    """Return a p value, '< .001', '.012' or '.34'; a dash for NaN."""
    if math.isnan(value):
        return "–"
    if value < 0.001:
        return f"<{NO_BREAK}.001"
    if value > 0.995:
        return "1"
    text = f"{value:.3f}" if value < 0.0995 else f"{value:.2f}"
    return text[1:]


def p_is(value: float) -> str:
    """Return a p value as a sentence has it, 'p < .001' or 'p = .34'."""
    text = p_value(value)
    return f"p {text}" if text.startswith("<") else f"p = {text}"


def percent(value: float) -> str:
    """Return a percentage without decimals; a dash for NaN."""
    return "–" if math.isnan(value) else f"{value:.0f}"


def quantity(value: float) -> str:
    """Return a number with three significant digits; a dash for NaN."""
    return fixed(value, decimals([value], digits=3))


def decimals(values: Iterable[float], *, digits: int) -> int:
    """Return how many decimals show `digits` significant ones of the smallest value.

    Zeros, rounding errors and NaN are passed over.
    """
    sizes = [abs(value) for value in values if abs(value) > _ZERO]
    if not sizes:
        return 0
    return max(0, digits - 1 - math.floor(math.log10(min(sizes))))


def fixed(value: float, decimal_places: int) -> str:
    """Return a number with a fixed count of decimals; a dash for NaN, '0' for rounding errors."""
    if math.isnan(value):
        return "–"
    if abs(value) <= _ZERO:
        return "0"
    text = f"{abs(value):.{decimal_places}f}"
    return f"−{text}" if value < 0 and float(text) else text


def count(number: int, noun: str) -> str:
    """Return a number with its noun, '1 segment', '8 segments'."""
    return f"{number:,} {noun if number == 1 else noun + 's'}"


SIGNIFICANCE: Final = 0.05
"""Corrected p values below this decide."""


CLUSTERED = "CR2, t with Satterthwaite's degrees of freedom"
"""How intervals of means are computed, for captions."""


INTERVAL: Final = f"{LEVEL:.0%} interval"


HOLM: Final = f"p{NO_BREAK}(Holm)"


def place_of(one: ResultKey) -> str:
    """Return what a note calls a result: its question, and its condition or conditions."""
    return f"{heading(one.question)}, {' against '.join(map(condition, one.names))}"


def interval(found: Interval, written: Callable[[float], str] = share) -> str:
    """Return an estimate's interval, '[.55, .71]'; '' where there is none."""
    if not found.has_interval:
        return ""
    return between(written(found.low), written(found.high))


def interval_or_why(found: Interval, reason: str = "") -> str:
    """Return the interval of a share, or that there is none and why."""
    if math.isnan(found.low) or math.isnan(found.high):
        why = found.reason or reason
        return f"none: {why}" if why else "none"
    return between(share(found.low), share(found.high))


def f_test(found: FTest) -> str:
    """Return an F test as a sentence has it."""
    freedom = f"{found.df:.0f}, {quantity(found.df_rest)}"
    return f"F({freedom}) = {number(found.statistic)}, {p_is(found.p_value)}"


def end_of(text: str) -> str:
    """Return words as the end of a sentence."""
    return f"{text.rstrip('.')}."


def ordinal(place: int) -> str:
    """Return a place as '1st', '2nd', '3rd', '4th'."""
    ending = "th" if 10 < place % 100 < 14 else {1: "st", 2: "nd", 3: "rd"}.get(place % 10, "th")
    return f"{place}{ending}"


def between(low: str, high: str) -> str:
    """Return an interval that no line breaks."""
    return f"[{low},{NO_BREAK}{high}]"


def share_words(found: Estimate, *, why: bool = True) -> str:
    """Return a share with its interval, '.63 [.55, .71]', or with `why` there is none."""
    if math.isnan(found.estimate):
        return "– (no answers)" if why else "–"
    inside = interval(found)
    if inside:
        return f"{share(found.estimate)}{NO_BREAK}{inside}"
    reason = f" (no interval: {found.reason})" if why else ""
    return f"{share(found.estimate)}{reason}"


def number(value: float) -> str:
    """Return a number with two decimals; a dash for NaN."""
    return fixed(value, 2)


def ranks(found: ConditionStrength | None) -> str:
    """Return the ranks that a condition may have, '1–2'; a dash where they are not known."""
    if found is None or found.best is None:
        return "–"
    return str(found.best) if found.best == found.worst else f"{found.best}–{found.worst}"


def suffix(name: str | None, number: int) -> str:
    """Return what the set of that name and number adds to the names of its files."""
    return "" if name is None else f"-set-{number}"


def in_set(name: str | None, heading: str) -> str:
    """Return a heading that says of which set it is."""
    return heading if name is None else f"Set {name}: {heading[:1].lower()}{heading[1:]}"


def gathered(found: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """Return each note once, after all that it is about; `found` gives what about and the note."""
    about: dict[str, list[str]] = {}
    for subject, note in found:
        if note:
            about.setdefault(f"{note.rstrip('.')}.", []).append(subject)
    return tuple(f"{'; '.join(subjects)}: {note}" for note, subjects in about.items())


def plus_minus(estimate: float, error: float) -> str:
    """Return an estimate with its error, '0.47 ± 0.03'; a dash for none."""
    return "–" if math.isnan(estimate) else f"{number(estimate)} ± {number(error)}"


NOTHING = "No answer is left to analyse, so no figure is drawn."


ALONE = (
    "The answers of one participant are analysed. Nothing tells how people differ, so there is "
    "neither an interval nor a figure; the tables hold what was answered."
)


def why_no_figure(*, answers: int, participants: int, tied: str = "") -> str:
    """Return why nothing is drawn; '' where there is something to see.

    Parameters
    ----------
    answers, participants : int
        How many are analysed.
    tied : str, optional
        What to say where all answers are alike; '' where they are not.
    """
    if not answers or not participants:
        return NOTHING
    return ALONE if participants == 1 else tied


def question_name(of: str, question: str) -> str:
    """Return what a row about a question is called."""
    return name(question) if not of else f"{name(of)}: {name(question)}"
