"""Estimates in words and cells, results by question, and why there is no figure."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Final, TypeVar, cast

from analysis.report import wording
from analysis.report.content import Cell, Column, Table, cells
from analysis.results.grouping import ByQuestion, ConditionPlace, PairPlace, Place
from analysis.results.strengths import RankInterval
from analysis.stats.clustered_mean import LEVEL, Estimate

CLUSTERED = "CR2, t with Satterthwaite's degrees of freedom"
"""How intervals of means are computed, for captions."""

INTERVAL: Final = f"{LEVEL:.0%} interval"
HOLM: Final = f"p{wording.NO_BREAK}(Holm)"

CONDITION: Final[tuple[Column[ConditionPlace], ...]] = (
    ("question", lambda one: wording.heading(one.question)),
    ("condition", lambda one: wording.name(one.condition)),
)
PAIR: Final[tuple[Column[PairPlace], ...]] = (
    ("question", lambda one: wording.heading(one.question)),
    ("first", lambda one: wording.name(one.a)),
    ("second", lambda one: wording.name(one.b)),
)

Result = TypeVar("Result")

_MOST_BESIDE: Final = 3
"""Questions up to which a table shows them beside each other."""


def place_of(one: Place) -> str:
    """Return what a note calls a result: its question, and its condition or conditions."""
    return f"{wording.heading(one.question)}, {wording.name(' against '.join(one.names))}"


def interval(found: Estimate) -> str:
    """Return the interval of a share, '[.55, .71]'; '' where there is none."""
    if found.reason or math.isnan(found.low):
        return ""
    return between(wording.share(found.low), wording.share(found.high))


def between(low: str, high: str) -> str:
    """Return an interval that no line breaks."""
    return f"[{low},{wording.NO_BREAK}{high}]"


def share_words(found: Estimate, *, why: bool = True) -> str:
    """Return a share with its interval, '.63 [.55, .71]', or with `why` there is none."""
    if math.isnan(found.estimate):
        return "– (no answers)" if why else "–"
    inside = interval(found)
    if inside:
        return f"{wording.share(found.estimate)}{wording.NO_BREAK}{inside}"
    reason = f" (no interval: {found.reason})" if why else ""
    return f"{wording.share(found.estimate)}{reason}"


def number(value: float) -> str:
    """Return a number with two decimals; a dash for NaN."""
    return wording.fixed(value, 2)


def ranks(found: RankInterval | None) -> str:
    """Return the ranks that a condition may have, '1–2'; a dash where they are not known."""
    if found is None:
        return "–"
    return str(found.best) if found.best == found.worst else f"{found.best}–{found.worst}"


def notes(reason: str, remark: str, about: str = "") -> tuple[str, ...]:
    """Return why a number is missing and what limits it, as footnotes."""
    subject = f"{about}: " if about else ""
    return tuple(f"{subject}{text.rstrip('.')}." for text in (reason, remark) if text)


def counted(value: float, text: str, *, best: bool = False, second: bool = False) -> Cell:
    """Return a cell that shows `text` and is sorted and filed by `value`, empty for NaN."""
    return Cell(
        text=text, value=None if math.isnan(value) else float(value), best=best, second=second
    )


def number_cell(value: float) -> Cell:
    """Return a number with two decimals."""
    return counted(value, number(value))


def share_cell(value: float) -> Cell:
    """Return a share with two digits."""
    return counted(value, wording.share(value))


def p_cell(value: float) -> Cell:
    """Return a p value."""
    return counted(value, wording.p_value(value))


def count_cell(value: int) -> Cell:
    """Return a count."""
    return Cell(text=str(value), value=value)


def interval_cell(low: float, high: float, written: Callable[[float], str] = number) -> Cell:
    """Return an interval, sorted by its lower end; a dash where there is none."""
    return counted(low, "–" if math.isnan(low) else between(written(low), written(high)))


def suffix(name: str | None, number: int) -> str:
    """Return what the set of that name and number adds to the names of its files."""
    return "" if name is None else f"-set-{number}"


def in_set(name: str | None, heading: str) -> str:
    """Return a heading that says of which set it is."""
    return heading if name is None else f"Set {name}: {heading[:1].lower()}{heading[1:]}"


def of_set(name: str | None) -> str:
    """Return the beginning of a caption that stands alone: which set it is about."""
    return "" if name is None else f"Set {name}. "


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


def each_question(
    found: ByQuestion[Result], sets: tuple[str, ...]
) -> Iterator[tuple[str, str, Result]]:
    """Give set ('' where there are none), question and result, in their order.

    Parameters
    ----------
    found : ByQuestion
        The results.
    sets : tuple of str
        The report's sets; () where it has none.
    """
    if not sets:
        for question, one in cast(Mapping[str, Result], found).items():
            yield "", question, one
        return
    for name, questions in cast(Mapping[str, Mapping[str, Result]], found).items():
        for question, one in questions.items():
            yield name, question, one


def results_of(found: ByQuestion[Result], name: str | None) -> Mapping[str, Result]:
    """Return the results of the set `name` by question; of all questions where it is None."""
    if name is None:
        return cast(Mapping[str, Result], found)
    return cast(Mapping[str, Mapping[str, Result]], found).get(name, {})


def question_name(of: str, question: str) -> str:
    """Return what a row about a question is called."""
    return wording.name(question) if not of else f"{wording.name(of)}: {wording.name(question)}"


def table_by_question(
    numbers: Mapping[tuple[str, str], Sequence[Cell]],
    heading: str,
    heads: Sequence[str],
    *,
    caption: str,
    name: str,
    data: str,
) -> Table:
    """Return a table with few questions beside each other, and more of them below each other.

    Parameters
    ----------
    numbers : mapping of (str, str) to sequence of Cell
        By what a row is about, as it is read, and question.
    heading : str
        Of the column that says what rows are about.
    heads : sequence of str
        Of the numbers.
    caption, name, data
        See `analysis.report.content.Table`.
    """
    questions = tuple(dict.fromkeys(question for _, question in numbers))
    if len(questions) > _MOST_BESIDE:
        return Table(
            caption=caption,
            header=("question", heading, *heads),
            rows=tuple(
                (*cells(wording.heading(question), about), *found)
                for (about, question), found in numbers.items()
            ),
            text_columns=2,
            name=name,
            data=data,
        )
    none = cells(*["–"] * len(heads))
    return Table(
        caption=caption,
        header=(heading, *(head for _ in questions for head in heads)),
        groups=(("", 1), *((wording.heading(question), len(heads)) for question in questions)),
        rows=tuple(
            (
                Cell(text=about),
                *(cell for question in questions for cell in numbers.get((about, question), none)),
            )
            for about in dict.fromkeys(about for about, _ in numbers)
        ),
        name=name,
        data=data,
    )
