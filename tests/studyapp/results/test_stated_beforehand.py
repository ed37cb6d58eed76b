"""A rule that was not settled before anybody came is exploratory, however it came in."""

from __future__ import annotations

from studyapp.results.stated_beforehand import ByHand, StudyExclusions, study_exclusions
from studyapp.study.settings.exclusions import FailedCatch, Incomplete

STATED = (Incomplete(), FailedCatch(more_than=1))


def marks(found: StudyExclusions) -> list[tuple[str, bool]]:
    return [(rule.name, rule.exploratory) for rule in found.rules]


def test_what_the_file_has_always_said_is_planned() -> None:
    for found in (study_exclusions(STATED), study_exclusions(STATED, STATED)):
        assert marks(found) == [("incomplete", False), ("catch", False)]
        assert [rule.name for rule in found.planned] == ["incomplete", "catch"]
        assert found.notes == ()


def test_a_rule_changed_after_the_first_participant_is_exploratory_and_the_old_one_planned() -> (
    None
):
    found = study_exclusions((Incomplete(), FailedCatch(more_than=0)), STATED)
    assert marks(found) == [("incomplete", False), ("catch", True)]
    assert [rule.description for rule in found.planned] == [
        "did not finish",
        "failed more than 1 catch trial",
    ]
    assert found.notes == (
        "Exclusion by catch>0 was not in the study file when the first participant came: it is "
        "exploratory.",
        "Exclusion by catch>1 was in the study file when the first participant came, and has been "
        "taken out of it since.",
    )


def test_what_researchers_decide_comes_after_the_rules_of_the_file_and_is_never_planned() -> None:
    by_hand = ByHand(count=2, after_look=0)
    found = study_exclusions(STATED, STATED, by_hand=by_hand)
    assert marks(found)[1:] == [("catch", False), ("researcher", True)]
    assert [rule.name for rule in found.planned] == ["incomplete", "catch"]
    said = {
        count: study_exclusions(STATED, by_hand=ByHand(count=2, after_look=count)).notes
        for count in (0, 1, 2)
    }
    assert said == {
        0: ("Researchers excluded 2 participants by hand, before anybody had looked at results.",),
        1: (
            "Researchers excluded 2 participants by hand, 1 of them after somebody had looked at "
            "results.",
        ),
        2: ("Researchers excluded 2 participants by hand, after somebody had looked at results.",),
    }
