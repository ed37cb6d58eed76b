from __future__ import annotations

import pytest

from studyapp.study.settings.reading import PROTOCOLS, parse_text
from studyapp.study.settings.rehearsal import Rehearsal, stated_strength
from studyapp.study.template_language import render_template
from tests.support.studies.made_study import make_study


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_every_template_writes_down_what_would_hold_without_it(protocol: str) -> None:
    text = render_template(f"{protocol}.toml")
    assert parse_text(text, where="study.toml").rehearsal == Rehearsal()
    commented = text[text.index("# [rehearsal.strength]") : text.index("# What participants read")]
    stated = "\n".join(
        line.removeprefix("# ")
        for line in commented.splitlines()
        if "=" in line or line.startswith("# [")
    )
    study = parse_text(text.replace(commented, f"{stated}\n\n"), where="study.toml")
    assert study.rehearsal.strength


def test_a_number_alone_is_that_of_every_question_that_is_not_named() -> None:
    stated = {"rule_based": 1, "mismatched": {"emotion": 0.25, "*": -1}}
    strength = make_study(rehearsal={"strength": stated}).rehearsal.strength
    assert stated_strength(strength, "rule_based", "emotion") == 1
    assert stated_strength(strength, "mismatched", "emotion") == 0.25
    assert stated_strength(strength, "mismatched", "rhythm") == -1
    assert stated_strength(strength, "broken", "emotion") is None
