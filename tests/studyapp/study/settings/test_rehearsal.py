from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.study.settings.reading import PROTOCOLS, parse_text
from studyapp.study.settings.rehearsal import Rehearsal, stated_strength
from studyapp.study.settings.study import Study
from studyapp.study.template_language import render_template


def template(protocol: str) -> str:
    return render_template(f"{protocol}.toml")


def read(keys: str) -> Study:
    text = template("pairwise")
    head, tail = (
        text[: text.index("[rehearsal]")],
        text[text.index("# What the attentive really") :],
    )
    return parse_text(f"{head}[rehearsal]\n{keys}\n{tail}", where="study.toml")


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_every_template_writes_down_what_would_hold_without_it(protocol: str) -> None:
    text = template(protocol)
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
    stated = read(
        'strength = { rule_based = 1, mismatched = { emotion = 0.25, "*" = -1 } }'
    ).rehearsal
    assert stated_strength(stated.strength, "rule_based", "emotion") == 1
    assert stated_strength(stated.strength, "mismatched", "emotion") == 0.25
    assert stated_strength(stated.strength, "mismatched", "synchronisation") == -1
    assert stated_strength(stated.strength, "broken", "emotion") is None


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ("careless = 1.5", "rehearsal.careless"),
        ("careless = 0.9\nhasty = 0.5", "add up to .* more than 1"),
        ("sleeping = 0.1", "rehearsal.sleeping: unknown key"),
        ("strength = { elsewhere = 1 }", "rehearsal.strength: unknown condition 'elsewhere'"),
        ("strength = { rule_based = { taste = 1 } }", "unknown question 'taste'"),
        ("strength = { rule_based = 'high' }", "strength.rule_based: must be a number, or a table"),
        ("strength = { rule_based = nan }", "finite number"),
        ("own_speech = { rule_based = 99 }", "rehearsal.own_speech.rule_based"),
    ],
)
def test_what_cannot_be_simulated_is_named(keys: str, named: str) -> None:
    with pytest.raises(InputError, match=named):
        read(keys)
