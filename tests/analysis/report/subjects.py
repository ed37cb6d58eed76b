"""What reports of the tests' tables are about."""

from __future__ import annotations

from typing import Any

from analysis.report.subject import Excerpt, Subject
from analysis.results.report import TableReport


def subject_of(report: TableReport, **changes: Any) -> Subject:
    """Return what a report of a finished study with participants would be about."""
    known: dict[str, Any] = {
        "title": "Which motion?",
        "origin": "participants",
        "protocol": report.protocol,
        "conditions": report.conditions_shown,
        "questions": dict.fromkeys(report.questions, "Which fits {emotion} better?"),
        "excerpts": {"s0": Excerpt(emotion="anger", speaker="scott", seconds=4.0)},
        "study_sha256": "abc",
        "seed": 7,
    }
    return Subject(**(known | changes))
