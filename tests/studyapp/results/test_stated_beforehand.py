"""A rule that was not settled before anybody came is exploratory, however it came in."""

from __future__ import annotations

import pytest

from studyapp.results.stated_beforehand import ByHand, study_exclusions
from studyapp.study.settings.exclusions import FailedCatch, Incomplete

STATED = (Incomplete(), FailedCatch(more_than=1))


@pytest.mark.parametrize(
    ("after_look", "when"),
    [
        (0, "before anybody had looked at results."),
        (1, "1 of them after somebody had looked at results."),
        (2, "after somebody had looked at results."),
    ],
)
def test_what_researchers_decide_comes_after_the_rules_of_the_file_and_is_never_planned(
    after_look: int, when: str
) -> None:
    found = study_exclusions(STATED, STATED, by_hand=ByHand(count=2, after_look=after_look))

    marks = [(rule.name, rule.exploratory) for rule in found.rules]
    assert marks == [("incomplete", False), ("catch", False), ("researcher", True)]
    assert [rule.name for rule in found.planned] == ["incomplete", "catch"]
    assert found.notes == (f"Researchers excluded 2 participants by hand, {when}",)
