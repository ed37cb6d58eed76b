"""The results as a page: the answer, the tables, who was left out, and the method."""

from __future__ import annotations

import math
from typing import Final

from analysis.report import wording
from analysis.report.content import Page, Section, Table, cells
from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.rating import RatingResults
from analysis.results.report import TableReport
from analysis.results.sections import SIGNIFICANCE, result_sections
from motion.listing import listed

METHODS: Final = {
    "pairwise": (
        "Win shares count ties one half; their intervals are clustered by participant and segment "
        "(CR1, t with min(participants, segments) − 1 degrees of freedom). p is the likelihood "
        "ratio of a cumulative link mixed model of the answer as given, left to right, with the "
        "side as covariate and its effect differing between participants and segments.",
        "Bradley–Terry errors and ranks take the segments as the only ones of interest.",
    ),
    "mismatch": (
        "Win shares of the own speech count ties one half; their intervals are clustered by "
        "participant and segment. p is the likelihood ratio of a cumulative link mixed model of "
        "the answer as given, left to right, with the own speech's side as covariate and its "
        "effect differing between participants and segments.",
    ),
    "rating": (
        "Intervals of means are clustered by participant and segment. Conditions are contrasted "
        "in a cumulative link mixed model with crossed effects of participants and segments.",
    ),
    "ranking": (
        "Worths are those of a Plackett–Luce model with ties, errors clustered by participant; "
        "ranks hold together at 95 % (Bonferroni). They take the segments as the only ones of "
        "interest; shares of first places have intervals clustered by participant and segment, "
        "which speak about further segments too.",
    ),
}

_HOLM: Final = (
    f"p (Holm) is corrected over all tests of the report; below {SIGNIFICANCE:g} it decides. That "
    "a test does not decide is not evidence that two conditions are equally good."
)


def table_page(report: TableReport) -> Page:
    """Return the page of a table's results."""
    participants = report.participants
    return Page(
        title=f"Answers in {report.source.file}",
        mark="",
        mark_short="",
        answer=_answer(report),
        picture=None,
        flow=f"{wording.count(participants.recruited, 'participant')} in the table, "
        f"{participants.attentive} analysed.",
        sections=(*result_sections(report.results), _flow(report), _methods(report)),
    )


def _answer(report: TableReport) -> tuple[str, ...]:
    if report.remark:
        return (report.remark,)
    results = report.results
    match results:
        case PairwiseResults():
            tests = [
                (c.p_holm, f"{_better(c.a, c.b, c.win_share.estimate > 0.5)} ({c.question})")
                for c in results.comparisons
            ]
        case RatingResults():
            tests = [
                (c.p_holm, f"{_better(c.a, c.b, c.estimate > 0)} ({c.question})")
                for c in results.contrasts
            ]
        case MismatchResults():
            tests = [
                (
                    c.p_holm,
                    f"{wording.name(c.condition)} with "
                    f"{'its own' if c.win_share.estimate > 0.5 else 'another'} speech "
                    f"({c.question})",
                )
                for c in results.conditions
            ]
        case _:
            return (
                f"{wording.count(len(report.conditions_shown), 'condition')} ranked on "
                f"{wording.count(len(report.questions), 'question')}; the tables tell which ranks "
                "each may have.",
            )
    decided = [text for p, text in tests if p < SIGNIFICANCE]
    missing = sum(math.isnan(p) for p, _ in tests)
    sentence = (
        f"Of {wording.count(len(tests), 'test')}, {len(decided)} decide at {SIGNIFICANCE:g} after "
        f"Holm's correction{f': {listed(decided)}' if decided else ''}."
    )
    if not missing:
        return (sentence,)
    return (sentence, f"{missing} could not be made; the notes under the tables say why.")


def _better(a: str, b: str, first: bool) -> str:
    one, other = (a, b) if first else (b, a)
    return f"{wording.name(one)} over {wording.name(other)}"


def _flow(report: TableReport) -> Section:
    rules = Table(
        caption="Rules in the order in which they apply; a participant counts under the first "
        "that removes them.",
        header=("rule", "reached", "removed"),
        rows=tuple(
            cells(rule.description, str(rule.reached), str(rule.removed)) for rule in report.rules
        ),
        data="rules.csv",
    )
    people = Table(
        caption="Every excluded participant with the reason.",
        header=("participant", "reason"),
        rows=tuple(cells(who, why) for who, why in report.exclusions.items()),
        text_columns=2,
        data="exclusions.csv",
    )
    return Section(
        anchor="flow",
        heading="Who is analysed, who is left out",
        paragraphs=() if report.rules else ("No rule of exclusion applies to this table.",),
        tables=tuple(table for table in (rules, people) if table.rows),
    )


def _methods(report: TableReport) -> Section:
    bullets = [*METHODS[report.protocol]]
    if report.protocol != "ranking":
        bullets.append(_HOLM)
    if report.settings.margin is not None:
        bullets.append(
            f"Equivalence: two one-sided tests with a margin of {report.settings.margin:g}, in "
            "tables/equivalence.csv."
        )
    bullets.append("Practice trials are dropped; trials shown again at the end are analysed.")
    bullets += report.notes
    bullets.append(
        f"Made with Motion Jury {report.source.motionjury} from a file with the SHA-256 "
        f"{report.source.sha256}."
    )
    return Section(anchor="methods", heading="Method and limits", bullets=tuple(bullets))
