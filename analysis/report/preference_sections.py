"""The sections about the answers: counts, win shares, side bias."""

from __future__ import annotations

from collections.abc import Iterator

from analysis.clustered_variance import TWO_WAY
from analysis.preferences.clustered import LEVEL
from analysis.preferences.win_share import Preference
from analysis.report import wording
from analysis.report.answer import figure_order, people
from analysis.report.content import Cell, Section, Table, cells
from analysis.report.findings import Findings
from analysis.report.inputs import ReportInputs

INTERVAL_NOTE = (
    f"Intervals at {LEVEL:.0%}, clustered by participant and by segment (Cameron, Gelbach & "
    "Miller 2011, CR1; never below a one-way variance), t with min(participants, segments) − 1 "
    "degrees of freedom, not corrected for multiplicity."
)


def counts_section(inputs: ReportInputs, findings: Findings) -> Section:
    """Return the five-level counts and the sums that AMUSE's Table A.5 shows."""
    reference = wording.name(inputs.reference)
    counts = Table(
        caption=f"Answers after exclusions, seen from {reference}: number, and % of the row.",
        header=(
            "question",
            "against",
            "answers",
            f"clearly {reference}",
            f"slightly {reference}",
            "no difference",
            "slightly other",
            "clearly other",
        ),
        rows=tuple(
            cells(
                wording.name(p.question),
                wording.name(p.other),
                str(p.counts.total),
                *(
                    f"{number} ({wording.percent(share)})"
                    for number, share in zip(p.counts.levels, p.counts.percentages, strict=True)
                ),
            )
            for question in figure_order(inputs)
            for p in findings.preferences
            if p.question == question
        ),
        text_columns=2,
        data="counts.csv",
    )
    return Section(
        anchor="counts",
        heading="What was answered",
        tables=(_table_a5(inputs, findings), counts),
    )


def _table_a5(inputs: ReportInputs, findings: Findings) -> Table:
    questions = figure_order(inputs)
    by_place = {(p.other, p.question): p.counts for p in findings.preferences}
    rows = []
    for other in dict.fromkeys(p.other for p in findings.preferences):
        row = [Cell(text=wording.name(other))]
        for question in questions:
            counts = by_place[other, question]
            ours, others = wording.percent(counts.ours), wording.percent(counts.others)
            row += [
                Cell(text=ours, best=counts.ours > counts.others),
                Cell(text=others, best=counts.others > counts.ours),
                Cell(text=wording.percent(counts.indifferent)),
            ]
        rows.append(tuple(row))
    return Table(
        caption="Preferences in the layout of AMUSE's Table A.5. Ours: sum of clear and slight "
        f"preferences for {wording.name(inputs.reference)}, others: for the condition of the row, "
        "in % of all answers. That table leaves indifferent answers out; here they stand beside.",
        header=("condition", *(["ours", "others", "indifferent"] * len(questions))),
        rows=tuple(rows),
        groups=(("", 1), *((wording.name(question), 3) for question in questions)),
        notes=(
            "The larger of ours and others is bold, which is no test: see the win shares. "
            "Rounded percentages may not add up to 100.",
        ),
        data="counts.csv",
    )


def win_share_section(inputs: ReportInputs, findings: Findings) -> Section:
    """Return the win shares with and without exclusions, and the side bias."""
    rows = []
    everyone = {(p.comparison, p.question): p for p in findings.everyone}
    for question in figure_order(inputs):
        for p in (p for p in findings.preferences if p.question == question):
            whole = everyone[p.comparison, question]
            rows.append(
                (
                    *cells(wording.name(question), wording.name(p.other)),
                    Cell(text=wording.estimate(p.win_share)),
                    *cells(
                        wording.p_value(p.win_share.p_value),
                        wording.p_value(p.holm_p),
                        _basis(p),
                        wording.estimate(whole.win_share),
                        wording.p_value(whole.holm_p),
                        _basis(whole),
                    ),
                )
            )
    reference = wording.name(inputs.reference)
    basis = f"{people(inputs)} × segments"
    corrected = f"p{wording.NO_BREAK}(Holm)"
    shares = Table(
        caption=f"Win share of {reference}: preferences for it plus half of the answers “no "
        "difference”, as a share of all answers, tested against .5; after exclusions, and with "
        "everybody.",
        groups=(("", 2), ("after exclusions", 4), ("nobody excluded", 3)),
        header=(
            "question",
            "against",
            "win share",
            "p",
            corrected,
            basis,
            "win share",
            corrected,
            basis,
        ),
        rows=tuple(rows),
        text_columns=2,
        notes=(
            INTERVAL_NOTE,
            f"Holm over the declared family of {len(findings.preferences)} tests: every "
            "comparison on every question.",
            *_methods(inputs, findings),
        ),
        data="preferences.csv",
    )
    return Section(
        anchor="win-shares",
        heading="Win shares with their uncertainty",
        tables=(shares, _side_table(inputs, findings)),
    )


def _basis(preference: Preference) -> str:
    return f"{preference.win_share.participants} × {preference.win_share.segments}"


def _methods(inputs: ReportInputs, findings: Findings) -> Iterator[str]:
    """Name every estimate after exclusions whose variance is not the two-way one."""
    for question in figure_order(inputs):
        for p in findings.preferences:
            if p.question == question and p.win_share.method not in {"", TWO_WAY}:
                yield (
                    f"{wording.name(p.question)}, {wording.name(p.other)}, after exclusions: "
                    f"variance {p.win_share.method}."
                )


def _side_table(inputs: ReportInputs, findings: Findings) -> Table:
    by_question = {bias.question: bias for bias in findings.side_bias}
    return Table(
        caption="Side bias: share of analysed answers for the left video, half of “no difference” "
        "included, over all comparisons, tested against .5.",
        header=("question", "left share", "p", "reference shown on the left"),
        rows=tuple(
            cells(
                wording.name(bias.question),
                wording.estimate(bias.left_share),
                wording.p_value(bias.left_share.p_value),
                wording.share(bias.reference_on_left),
            )
            for bias in (by_question[question] for question in figure_order(inputs))
        ),
        notes=(
            "A bias to one side pulls win shares towards .5; it favours a condition only as far "
            "as the reference is not shown on the left half of the time. Intervals as for the "
            "win shares.",
        ),
        data="side_bias.csv",
    )
