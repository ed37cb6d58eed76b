"""The section that takes the answers apart by emotion."""

from __future__ import annotations

from analysis.preferences.clustered import LEVEL
from analysis.preferences.segments import SegmentShare
from analysis.report import wording
from analysis.report.answer import figure_order
from analysis.report.content import Picture, Section
from analysis.report.emotion_figure import FEW_SEGMENTS, emotion_figure
from analysis.report.findings import Findings
from analysis.report.inputs import ReportInputs


def emotion_section(inputs: ReportInputs, findings: Findings, mark: str) -> Section:
    """Return one forest plot per comparison."""
    pictures = []
    labels = {p.emotion for p in findings.emotions}
    few = any(p.win_share.segments < FEW_SEGMENTS for p in findings.emotions)
    for number, comparison in enumerate(dict.fromkeys(p.comparison for p in findings.preferences)):
        overall = [
            p
            for question in figure_order(inputs)
            for p in findings.preferences
            if p.comparison == comparison and p.question == question
        ]
        single = _shared_emotions(findings, comparison)
        within = [p for p in findings.emotions if p.comparison == comparison]
        reference, other = wording.name(overall[0].reference), wording.name(overall[0].other)
        descriptive = (
            f" Descriptive: hollow marks rest on fewer than {FEW_SEGMENTS} segments, and one "
            "segment alone allows no interval."
            if few
            else ""
        )
        pictures.append(
            Picture(
                svg=emotion_figure(within, overall, single, name=f"emotion{number}", mark=mark),
                caption=f"Win share of {reference} against {other} within each emotion, with "
                f"{LEVEL:.0%} intervals clustered by participant and segment"
                f"{', and a tick below for each segment' if single else ''}; right of the line "
                f"{reference} is preferred.{descriptive}",
                data="emotions.csv",
            )
        )
    reading = (
        "No single emotion is tested: these estimates show where a difference comes from, "
        "not whether there is one."
    )
    if len(labels) == 1:
        reading = (
            f"All segments carry one emotion, {labels.pop()}, so both rows of a panel show the "
            "same answers. No single segment is tested."
        )
    return Section(
        anchor="emotions",
        heading="Emotion by emotion (descriptive)" if few else "Emotion by emotion",
        paragraphs=(reading,),
        pictures=tuple(pictures),
    )


def _shared_emotions(findings: Findings, comparison: str) -> list[SegmentShare]:
    """Return the comparison's segments whose emotion has others beside them."""
    found = [share for share in findings.segments if share.comparison == comparison]
    places = [(share.question, share.emotion) for share in found]
    return [share for share in found if places.count((share.question, share.emotion)) > 1]
