"""Numbers, estimates and names in words: sensible digits, no underscores."""

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

INTERVAL: Final = f"{LEVEL:.0%} interval"

HOLM: Final = f"p{NO_BREAK}(Holm)"

CLUSTERED: Final = "CR2, t with Satterthwaite's degrees of freedom"
"""How intervals of means are computed, for captions."""

SIGNIFICANCE: Final = 0.05
"""Corrected p values below this are significant."""

_ZERO: Final = 1e-9
"""Smaller numbers are rounding errors."""

_LABELS: ContextVar[Mapping[str, str]] = ContextVar("_LABELS", default=MappingProxyType({}))
"""Labels of the conditions on the page that is being written."""

_MARK: ContextVar[str] = ContextVar("_MARK", default="")
"""The mark on top of every figure of that page."""


@contextmanager
def labelled(labels: Mapping[str, str], mark: str = "") -> Iterator[None]:
    """Make `condition` return these labels, and figures carry `mark`, inside the context.

    Every table and figure names conditions, and every figure of a rehearsal needs its mark, so a
    context holds both instead of passing them to each.
    """
    labels_before, mark_before = _LABELS.set(labels), _MARK.set(mark)
    try:
        yield
    finally:
        _LABELS.reset(labels_before)
        _MARK.reset(mark_before)


def figure_mark() -> str:
    """Return the mark on top of every figure of the page; empty for none."""
    return _MARK.get()


def condition(key: str) -> str:
    """Return the label of a condition, or its name in plain words."""
    return _LABELS.get().get(key) or name(key)


def against(a: str, b: str) -> str:
    """Return the name of a comparison of two conditions."""
    return f"{condition(a)} against {condition(b)}"


def name(key: str) -> str:
    """Return the name of a question, a set or a segment in plain words."""
    return key.replace("_", " ")


def heading(key: str) -> str:
    """Return a name as a heading, with a capital first letter."""
    text = name(key)
    return text[:1].upper() + text[1:]


def share(value: float) -> str:
    """Return a share with two decimals, '.63'; a dash for NaN."""
    if math.isnan(value):
        return "–"
    text = f"{abs(value):.2f}"
    sign = "−" if value < 0 and float(text) else ""
    return sign + (text[1:] if text.startswith("0") else text)


MEASURES: Final[Mapping[Measure, str]] = {
    "win_share": "win share of the first",
    "own_speech": "share of preferences for its own speech",
    "mean_rating": "mean rating",
    "mean_rank": "mean rank (1 is best)",
}
"""Names of the headline numbers."""


def number_style(measure: Measure) -> Callable[[float], str]:
    """Return the format of numbers of a measure: shares as '.63', means as '3.63'."""
    return share if measure in ("win_share", "own_speech") else number


def difference_style(measure: Measure) -> Callable[[float], str]:
    """Return the format of differences of a measure: as its numbers, with a sign."""
    formatted = number_style(measure)

    def with_sign(value: float) -> str:
        text = formatted(value)
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
    """Return a p value for a sentence, 'p < .001' or 'p = .34'."""
    text = p_value(value)
    return f"p {text}" if text.startswith("<") else f"p = {text}"


def percent(value: float) -> str:
    """Return a percentage without decimals; a dash for NaN."""
    return "–" if math.isnan(value) else f"{value:.0f}"


def quantity(value: float) -> str:
    """Return a number with three significant digits; a dash for NaN."""
    return fixed(value, decimals([value], digits=3))


def decimals(values: Iterable[float], *, digits: int) -> int:
    """Return the decimals needed to show the smallest value with `digits` significant digits.

    Zeros, rounding errors and NaN are ignored.
    """
    sizes = [abs(value) for value in values if abs(value) > _ZERO]
    if not sizes:
        return 0
    return max(0, digits - 1 - math.floor(math.log10(min(sizes))))


def fixed(value: float, decimal_places: int) -> str:
    """Return a number with fixed decimals; a dash for NaN, '0' for rounding errors."""
    if math.isnan(value):
        return "–"
    if abs(value) <= _ZERO:
        return "0"
    text = f"{abs(value):.{decimal_places}f}"
    return f"−{text}" if value < 0 and float(text) else text


def count(number: int, noun: str) -> str:
    """Return a number with its noun, '1 segment', '8 segments'."""
    return f"{number:,} {noun if number == 1 else noun + 's'}"


def place_name(place: ResultKey) -> str:
    """Return the question and the conditions of a result."""
    return f"{heading(place.question)}, {' against '.join(map(condition, place.names))}"


def question_name(set_name: str, question: str) -> str:
    """Return the name of a row on a question, with its set if it has one."""
    return heading(f"{set_name}: {question}" if set_name else question)


def between(low: str, high: str) -> str:
    """Return an interval in which no line breaks."""
    return f"[{low},{NO_BREAK}{high}]"


def interval(estimate: Interval, formatted: Callable[[float], str] = share) -> str:
    """Return an estimate's interval, '[.55, .71]'; '' without one."""
    if not estimate.has_interval:
        return ""
    return between(formatted(estimate.low), formatted(estimate.high))


def interval_or_reason(estimate: Interval, reason: str = "") -> str:
    """Return the interval of a share, or the reason why there is none."""
    if estimate.has_interval:
        return interval(estimate)
    reason = estimate.reason or reason
    return f"none: {reason}" if reason else "none"


def f_test(test: FTest) -> str:
    """Return an F test for a sentence."""
    degrees = f"{test.df:.0f}, {quantity(test.df_rest)}"
    return f"F({degrees}) = {number(test.statistic)}, {p_is(test.p_value)}"


def end_of(text: str) -> str:
    """Return the text with a full stop."""
    return f"{text.rstrip('.')}."


def ordinal(place: int) -> str:
    """Return a place as '1st', '2nd', '3rd', '4th'."""
    ending = "th" if 10 < place % 100 < 14 else {1: "st", 2: "nd", 3: "rd"}.get(place % 10, "th")
    return f"{place}{ending}"


def share_words(estimate: Estimate) -> str:
    """Return a share with its interval, '.63 [.55, .71]', or the reason why there is none."""
    if math.isnan(estimate.estimate):
        return "– (no answers)"
    if estimate.has_interval:
        return f"{share(estimate.estimate)}{NO_BREAK}{interval(estimate)}"
    return f"{share(estimate.estimate)} (no interval: {estimate.reason})"


def number(value: float) -> str:
    """Return a number with two decimals; a dash for NaN."""
    return fixed(value, 2)


def plus_minus(estimate: float, error: float) -> str:
    """Return an estimate with its standard error, '0.47 ± 0.03'; a dash for NaN."""
    return "–" if math.isnan(estimate) else f"{number(estimate)} ± {number(error)}"


def ranks(standing: ConditionStrength | None) -> str:
    """Return the ranks that a condition may have, '1–2'; a dash if they are unknown."""
    if standing is None or standing.best is None:
        return "–"
    if standing.best == standing.worst:
        return str(standing.best)
    return f"{standing.best}–{standing.worst}"


def set_suffix(set_name: str | None, number: int) -> str:
    """Return the suffix of a set's file names; '' without sets."""
    return "" if set_name is None else f"-set-{number}"


def merge_notes(notes: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """Return each note once, after all its subjects; `notes` are pairs of subject and note."""
    subjects_by_note: dict[str, list[str]] = {}
    for subject, note in notes:
        if note:
            subjects_by_note.setdefault(end_of(note), []).append(subject)
    return tuple(f"{'; '.join(subjects)}: {note}" for note, subjects in subjects_by_note.items())


def reason_for_no_figure(*, answers: int, participants: int, tied: str = "") -> str:
    """Return why no figure is drawn, or '' if one can be drawn.

    Parameters
    ----------
    answers, participants : int
        The numbers analysed.
    tied : str, optional
        In what way all answers are the same; '' if they differ.
    """
    if not answers or not participants:
        return "No answer is left to analyse, so no figure is drawn."
    if participants == 1:
        return (
            "Only one participant's answers are analysed. How much people differ is unknown, so "
            "there are no intervals and no figure; the tables hold the answers."
        )
    return tied and f"{tied}, so there is nothing to draw and nothing to test."
