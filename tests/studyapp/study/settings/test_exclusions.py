"""The exclusion rules of a study file: reading, defaults, and refusal of contradictions."""

import re
from pathlib import Path
from typing import Any

import pytest

from motion.errors import InputError
from studyapp.cli.report_command import parse_exclusion
from studyapp.study.settings.reading import read_study
from studyapp.study.settings.study import Study
from studyapp.study.study_file import TEMPLATES, new_study
from tests.studyapp.study.protocols.made_protocols import make

COVERAGE = {"rule": "coverage", "below": 0.9}
CATCH: dict[str, Any] = {"rule": "catch"}


def written(study: Study) -> list[str]:
    return [each.shorthand() for each in study.settled_exclusions]


@pytest.mark.parametrize(
    ("keys", "settled"),
    [
        ({}, ["incomplete", "catch>1"]),
        ({"catch": {"trials": 0}}, ["incomplete"]),
        (
            {"catch": {"max_failed": 0}, "attention": {"trials": 3, "max_failed": 2}},
            ["incomplete", "catch>0", "attention>2"],
        ),
        (
            {"exclusions": [COVERAGE, CATCH, {"rule": "time", "below": 8}]},
            ["coverage<0.9", "catch>1", "time<8,share=0.5"],
        ),
        # The number of a catch rule may be in either place, or in both.
        ({"exclusions": [CATCH], "catch": {"max_failed": 0}}, ["catch>0"]),
        ({"exclusions": [CATCH | {"more_than": 0}], "catch": {"max_failed": 0}}, ["catch>0"]),
    ],
)
def test_stated_rules_replace_the_default_ones(keys: dict[str, Any], settled: list[str]) -> None:
    assert written(make("pairwise", **keys)) == settled


@pytest.mark.parametrize(
    ("rules", "said"),
    [
        ([CATCH | {"more_than": 0}], "remove one of them"),
        ([{"rule": "incomplete"}] * 2, "the rule incomplete is stated twice"),
        ([{"rule": "speed"}], "exclusions.0: unknown rule 'speed' (use one of 'incomplete'"),
        ([{"rule": "coverage"}], "exclusions.0.coverage.below: is missing"),
    ],
)
def test_impossible_values_are_refused_with_their_place(rules: list[Any], said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        make("pairwise", exclusions=rules, catch={"max_failed": 1})


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("incomplete", "incomplete"),
        ("catch>0", "catch>0"),
        ("attention>2", "attention>2"),
        (" coverage < 0.9 ", "coverage<0.9"),
        ("straight_lining>=1", "straight_lining>=1,trials=10"),
        ("time<2.5, share=0.25", "time<2.5,share=0.25"),
    ],
)
def test_rules_written_in_shorthand_are_read_back(text: str, meant: str) -> None:
    assert parse_exclusion(text, where="--exclude").shorthand() == meant


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "'' is not an exclusion rule"),
        ("coverage>0.9", "coverage<NUMBER"),
        ("incomplete>1", "Write one of incomplete"),
        ("coverage<90%", "below: must be a valid number"),
        ("coverage<2", "below: must be less than or equal to 1"),
        ("catch>nan", "more_than: must be a valid integer"),
        ("time<3,speed=2", "speed: unknown key"),
        ("time<3,share", "such as time<3,share=0.25"),
    ],
)
def test_a_misspelt_rule_is_refused_with_a_suggestion(text: str, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        parse_exclusion(text, where="--exclude")


@pytest.mark.parametrize("template", TEMPLATES)
def test_rules_in_the_templates_comments_are_valid(tmp_path: Path, template: str) -> None:
    path = tmp_path / "study.toml"
    plain = new_study(path, template=template, name="study")
    text = path.read_text("utf-8")
    start = text.index("# [[exclusions]]")
    end = text.index("\n\n", start)
    stated = re.sub("^# ", "", text[start:end], flags=re.MULTILINE)
    path.write_text(text[:start] + stated + text[end:], "utf-8")
    study = read_study(path)
    assert written(plain) == written(study)[: len(written(plain))]
    assert len(study.settled_exclusions) > len(plain.settled_exclusions)
