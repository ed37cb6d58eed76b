"""Researchers' own exclusions come after the rules of the study file and are never planned."""

from __future__ import annotations

import pandas as pd
import pytest

from studyapp.results.stated_beforehand import study_exclusions
from studyapp.study.settings.exclusions import FailedCatch, Incomplete


@pytest.mark.parametrize(
    ("after_look", "when"),
    [
        ([False, False], "before anybody had looked at results."),
        ([True, False], "1 of them after somebody had looked at results."),
        ([True, True], "after somebody had looked at results."),
    ],
)
def test_a_report_says_whether_results_had_been_seen(after_look: list[bool], when: str) -> None:
    sessions = pd.DataFrame(
        {"excluded_because": ["asleep", "left", ""], "excluded_after_look": [*after_look, False]}
    )
    found = study_exclusions((Incomplete(), FailedCatch()), study_sessions=sessions)

    marks = [(rule.name, rule.exploratory) for rule in found.rules]
    assert marks == [("incomplete", False), ("catch", False), ("researcher", True)]
    assert [rule.name for rule in found.planned] == ["incomplete", "catch"]
    assert found.notes == (f"Researchers excluded 2 participants by hand, {when}",)
