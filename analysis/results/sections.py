"""The page's tables, one section for each question."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeVar

from analysis.report import wording
from analysis.report.content import Cell, Section, Table, cells
from analysis.results.estimate import Estimate
from analysis.results.mismatch import MismatchResults
from analysis.results.net_preference import NetPreference
from analysis.results.pairwise import PairwiseResults
from analysis.results.preference import Preference
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatedCondition, RatingResults
from analysis.results.strength_errors import RankInterval

Placed = TypeVar("Placed")
Row = tuple[Cell, ...]
Results = PairwiseResults | RatingResults | RankingResults | MismatchResults

SIGNIFICANCE = 0.05


def result_sections(results: Results) -> tuple[Section, ...]:
    """Return a section for each question, of each set where there are sets."""
    match results:
        case PairwiseResults():
            return _pairwise(results)
        case RatingResults():
            return _rating(results)
        case RankingResults():
            return _ranking(results)
        case MismatchResults():
            return _mismatch(results)


def interval(found: Estimate) -> str:
    """Return an interval of a share or why there is none."""
    if found.reason:
        return f"none: {found.reason}"
    return f"[{wording.share(found.low)},{wording.NO_BREAK}{wording.share(found.high)}]"


def _pairwise(results: PairwiseResults) -> tuple[Section, ...]:
    places = [(one.set, one.question) for one in results.comparisons]
    found = []
    for place in dict.fromkeys(places):
        comparisons = [c for c in results.comparisons if (c.set, c.question) == place]
        preferences = _preferences(
            "Preferences after exclusions. Win share: of the first condition, ties counting one "
            "half. Log-odds: net preference for it.",
            ("first", "second"),
            [((c.a, c.b), c, c.p_holm) for c in comparisons],
            "comparisons.csv",
        )
        fitted = _of(results.bradley_terry, place)
        strengths = (
            Table(
                caption="Bradley–Terry strengths over all comparisons (Davidson's ties, left-side "
                "term; errors clustered by participant), adding up to zero, and the ranks that "
                "each condition may have.",
                header=("condition", "strength", "error", "rank"),
                rows=tuple(
                    cells(
                        wording.name(name),
                        _number(strength),
                        _number(fitted.errors[name]),
                        _rank(fitted.ranks.get(name)),
                    )
                    for name, strength in fitted.strengths.items()
                ),
                notes=_notes(fitted.reason, fitted.remark),
                data="bradley_terry.csv",
            )
            if fitted
            else None
        )
        found.append(_section(place, (preferences, *([strengths] if strengths else ()))))
    return tuple(found)


def _mismatch(results: MismatchResults) -> tuple[Section, ...]:
    found = []
    for place in dict.fromkeys((one.set, one.question) for one in results.conditions):
        conditions = [c for c in results.conditions if (c.set, c.question) == place]
        table = _preferences(
            "Preferences for the motion with its own speech over the same motion with another's, "
            "after exclusions. Win share: of the own speech, ties counting one half.",
            ("condition",),
            [((c.condition,), c, c.p_holm) for c in conditions],
            "conditions.csv",
        )
        found.append(_section(place, (table,)))
    return tuple(found)


def _preferences(
    caption: str,
    heads: tuple[str, ...],
    rows: list[tuple[tuple[str, ...], Preference, float]],
    data: str,
) -> Table:
    return Table(
        caption=caption,
        header=(
            *heads,
            "recruited",
            "attentive",
            "answers",
            "for %",
            "equal %",
            "against %",
            "win share",
            "95 % interval",
            "log-odds",
            "p",
            "p (Holm)",
        ),
        rows=tuple(_preference(names, found, p_holm) for names, found, p_holm in rows),
        text_columns=len(heads),
        notes=tuple(
            dict.fromkeys(
                note
                for names, found, _ in rows
                for note in _notes(found.clmm.reason, found.clmm.remark, about=names)
            )
        ),
        data=data,
    )


def _preference(names: tuple[str, ...], found: Preference, p_holm: float) -> Row:
    first, second, equal = found.share.values()
    return cells(
        *map(wording.name, names),
        str(found.recruited),
        str(found.attentive),
        str(found.n),
        wording.percent(first),
        wording.percent(equal),
        wording.percent(second),
        wording.share(found.win_share.estimate),
        interval(found.win_share),
        _log_odds(found.clmm),
        wording.p_value(found.clmm.p),
        wording.p_value(p_holm),
    )


def _rating(results: RatingResults) -> tuple[Section, ...]:
    found = []
    for place in dict.fromkeys((one.set, one.question) for one in results.conditions):
        conditions = [c for c in results.conditions if (c.set, c.question) == place]
        model = _of(results.clmm, place)
        ratings = Table(
            caption="Ratings after exclusions.",
            header=("condition", "ratings", "mean", "95 % interval", "SD", *_scores(conditions)),
            rows=tuple(
                cells(
                    wording.name(c.condition),
                    str(c.n),
                    _number(c.mean),
                    f"none: {c.reason}" if c.reason else f"[{_number(c.low)}, {_number(c.high)}]",
                    _number(c.sd),
                    *map(str, c.counts.values()),
                )
                for c in conditions
            ),
            data="conditions.csv",
        )
        contrasts = Table(
            caption="How much better the first condition is rated: difference in logits in a "
            "cumulative link mixed model with crossed effects of participants and segments.",
            header=(
                *("first", "second", "difference", "error", "odds ratio", "Cliff's δ"),
                *("p", "p (Holm)"),
            ),
            rows=tuple(
                cells(
                    wording.name(c.a),
                    wording.name(c.b),
                    _number(c.estimate),
                    _number(c.se),
                    _number(c.odds_ratio),
                    wording.share(c.cliffs_delta.estimate),
                    wording.p_value(c.p),
                    wording.p_value(c.p_holm),
                )
                for c in results.contrasts
                if (c.set, c.question) == place
            ),
            text_columns=2,
            notes=_notes(model.reason, model.remark) if model else (),
            data="contrasts.csv",
        )
        found.append(_section(place, (ratings, *((contrasts,) if contrasts.rows else ()))))
    return tuple(found)


def _scores(conditions: list[RatedCondition]) -> tuple[str, ...]:
    return tuple(str(score) for score in conditions[0].counts)


def _ranking(results: RankingResults) -> tuple[Section, ...]:
    found = []
    for place in dict.fromkeys((one.set, one.question) for one in results.conditions):
        worths = _of(results.plackett_luce, place)
        agreed = _of(results.kendall_w, place)
        table = Table(
            caption="Rankings after exclusions: mean rank (1 is best), share of first places, and "
            "Plackett–Luce worth (log scale, adding up to zero) with its error clustered by "
            "participant.",
            header=(
                *("condition", "rankings", "mean rank", "first", "95 % interval"),
                *("worth", "error", "rank"),
            ),
            rows=tuple(
                cells(
                    wording.name(c.condition),
                    str(c.n),
                    _number(c.mean_rank),
                    wording.share(c.first_share),
                    interval(c.first_share_interval),
                    _number(worths.worths[c.condition] if worths else math.nan),
                    _number(worths.errors[c.condition] if worths else math.nan),
                    _rank(worths.ranks.get(c.condition) if worths else None),
                )
                for c in results.conditions
                if (c.set, c.question) == place
            ),
            notes=(
                *(_notes(worths.reason, worths.remark) if worths else ()),
                *(
                    (f"Kendall's W, mean over segments: {wording.share(agreed.mean)}.",)
                    if agreed and not math.isnan(agreed.mean)
                    else ()
                ),
            ),
            data="conditions.csv",
        )
        found.append(_section(place, (table,)))
    return tuple(found)


def _of(
    found: Mapping[str, Placed] | Mapping[str, Mapping[str, Placed]], place: tuple[str | None, str]
) -> Placed | None:
    """Return the result of one question of one set."""
    name, question = place
    inside = found if name is None else found.get(name, {})
    return inside.get(question)  # type: ignore[union-attr,return-value]


def _section(place: tuple[str | None, str], tables: tuple[Table, ...]) -> Section:
    name, question = place
    heading = wording.heading(question)
    return Section(
        anchor=_anchor(f"{name}-{question}" if name else question),
        heading=heading if name is None else f"Set {name}: {heading}",
        tables=tables,
    )


def _anchor(text: str) -> str:
    return "q-" + "".join(sign if sign.isalnum() else "-" for sign in text)


def _log_odds(found: NetPreference) -> str:
    if found.reason:
        return "–"
    return f"{_number(found.estimate)} ± {_number(found.se)}"


def _number(value: float) -> str:
    return wording.fixed(value, 2)


def _rank(found: RankInterval | None) -> str:
    if found is None:
        return "–"
    return str(found.best) if found.best == found.worst else f"{found.best}–{found.worst}"


def _notes(reason: str, remark: str, about: tuple[str, ...] = ()) -> tuple[str, ...]:
    subject = f"{' and '.join(map(wording.name, about))}: " if about else ""
    return tuple(f"{subject}{text.rstrip('.')}." for text in (reason, remark) if text)
