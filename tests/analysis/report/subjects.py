"""What reports of the tests' tables are about."""

from typing import Any

from analysis.report.content import Section, Subject
from analysis.report.page import headline_sections
from analysis.results.report import TableReport
from motion.segment import Segment

SEGMENT = Segment(
    name="s0", wav="s0.wav", start=0.0, end=4.0, speaker="scott", emotion="anger", transcript=""
)


def subject_of(report: TableReport, **changes: Any) -> Subject:
    """Return the subject of a report on a finished study with participants."""
    known: dict[str, Any] = {
        "protocol": report.protocol,
        "conditions": report.conditions_shown,
        "questions": dict.fromkeys(report.questions, "Which fits {emotion} better?"),
        "excerpts": {"s0": SEGMENT},
        "study_sha256": "abc",
        "seed": 7,
    }
    return bare_subject(**(known | changes))


def bare_subject(**known: Any) -> Subject:
    """Return the subject of a report on people's answers."""
    usual = {"title": "Which motion?", "origin": "participants", "questions": {}}
    return Subject(**(usual | known))


def headline(report: TableReport, **changes: object) -> tuple[Section, ...]:
    """Return a report's first screen, for a subject with `changes`."""
    return headline_sections(report, subject_of(report, **changes))
