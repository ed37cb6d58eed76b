"""A study's report leaves out whom its rules name, and tells planned rules from later ones."""

from __future__ import annotations

import json

from studyapp.results.report import report
from studyapp.study.settings.exclusions import FailedCatch, StraightLining
from tests.studyapp.results.conftest import Answered

CHANGED = """
[[exclusions]]
rule = "incomplete"
[[exclusions]]
rule = "attention"
more_than = 2
"""


def test_rules_that_the_study_file_did_not_state_beforehand_are_exploratory(
    answered: Answered,
) -> None:
    folder = answered("rating", people=3, stop_after=2)
    with folder.definition.open("a", encoding="utf-8") as file:
        file.write(CHANGED)

    page = report(
        folder, exclude=[StraightLining(at_least=1, trials=500), FailedCatch(more_than=0)]
    )

    found = json.loads(page.with_name("results.json").read_text("utf-8"))
    assert [(one["rule"], one["exploratory"]) for one in found["rules"]] == [
        ("incomplete", False),
        ("attention", True),
        ("straight_lining", True),
        ("catch", True),
    ]
    assert found["exclusions"]["3"].endswith(" trials answered")
    assert [one["remark"] for one in found["rules"][2:]] == [
        "cannot be applied: no question has 500 answers that could be alike",
        "cannot be applied: there are no catch trials with a side known to be right",
    ]
    text = page.read_text("utf-8")
    assert "Exclusion by attention&gt;2 was not in the study file when the first" in text
    assert "Exclusion by attention&gt;1 was in the study file when the first" in text
