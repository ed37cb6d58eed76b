"""The exclusion rules of a study file: read, settled, refused where they contradict themselves."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from motion.errors import InputError
from studyapp.cli.report_command import parse_exclusion
from studyapp.study.settings.exclusions import EXCLUSION_SECTIONS
from studyapp.study.settings.reading import parse_study, read_study
from studyapp.study.settings.study import Study
from studyapp.study.study_file import TEMPLATES, new_study

Read = Callable[..., Study]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Return a function that reads the template with other catch trials, checks and rules."""
    path = tmp_path / "study.toml"
    new_study(path, name="study")
    template = tomllib.loads(path.read_text("utf-8"))

    def changed(
        rules: list[dict[str, Any]] | None = None,
        catch: dict[str, Any] | None = None,
        attention: dict[str, Any] | None = None,
    ) -> Study:
        data = template | {"catch": catch or {}, "attention": attention or {}}
        return parse_study(data if rules is None else data | {"exclusions": rules}, where=path)

    return changed


def written(study: Study) -> list[str]:
    return [each.shorthand() for each in study.settled_exclusions]


def test_without_a_list_the_unfinished_and_the_inattentive_are_left_out(read: Read) -> None:
    assert written(read()) == ["incomplete", "catch>1"]
    assert written(read(catch={"trials": 0})) == ["incomplete"]
    both = read(catch={"max_failed": 0}, attention={"trials": 3, "max_failed": 2})
    assert written(both) == ["incomplete", "catch>0", "attention>2"]


def test_a_list_holds_alone_and_in_its_order(read: Read) -> None:
    rules = [{"rule": "coverage", "below": 0.9}, {"rule": "catch"}, {"rule": "time", "below": 8}]
    assert written(read(rules)) == ["coverage<0.9", "catch>1", "time<8,share=0.5"]


def test_the_number_of_a_catch_rule_may_stand_in_either_place(read: Read) -> None:
    assert written(read([{"rule": "catch"}], catch={"max_failed": 0})) == ["catch>0"]
    assert written(read([{"rule": "catch", "more_than": 0}])) == ["catch>0"]
    same = read([{"rule": "catch", "more_than": 0}], catch={"max_failed": 0})
    assert written(same) == ["catch>0"]


@pytest.mark.parametrize(
    ("rules", "catch", "said"),
    [
        ([{"rule": "catch", "more_than": 0}], {"max_failed": 1}, "remove one of them"),
        ([{"rule": "incomplete"}], {"max_failed": 1}, "catch.max_failed has no effect"),
        ([{"rule": "catch"}], {"trials": 0}, "no effect because catch.trials is 0"),
        ([{"rule": "attention"}], {}, "no effect because attention.trials is 0"),
        (
            [{"rule": "incomplete"}, {"rule": "incomplete"}],
            {},
            "the rule incomplete is stated twice",
        ),
        ([{"rule": "speed"}], {}, "exclusions.0: unknown rule 'speed' (use one of 'incomplete'"),
        ([{"below": 0.9}], {}, "exclusions.0: 'rule' is missing"),
        (["catch"], {}, "exclusions.0: must be a table of keys and values"),
        ([{"rule": "coverage"}], {}, "exclusions.0.coverage.below: is missing"),
        ([{"rule": "coverage", "below": 90}], {}, "exclusions.0.coverage.below: Input should be"),
        ([{"rule": "coverage", "below": "0.9"}], {}, "below: must be a number"),
        ([{"rule": "coverage", "over": 1}], {}, "exclusions.0.coverage.over: unknown key"),
        ([{"rule": "time", "below": 0}], {}, "exclusions.0.time.below"),
        ([{"rule": "straight_lining", "at_least": 0.5}], {}, "at_least: Input should be greater"),
    ],
)
def test_what_cannot_be_is_refused_with_its_place(
    read: Read, rules: list[Any], catch: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        read(rules, catch)


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        *((same, same) for same in ("incomplete", "catch>0", "attention>2", "coverage<0.95")),
        *((same, same) for same in ("time<2.5,share=0.25", "straight_lining>=0.9,trials=12")),
        (" coverage < 0.9 ", "coverage<0.9"),
        ("straight-lining>=1", "straight_lining>=1,trials=10"),
        ("time<3, share=1", "time<3,share=1"),
    ],
)
def test_what_is_written_in_one_word_is_read_back(text: str, meant: str) -> None:
    assert parse_exclusion(text, where="--exclude").shorthand() == meant


def test_every_rule_can_be_written_in_one_word() -> None:
    with pytest.raises(InputError) as caught:
        parse_exclusion("nothing", where="--exclude")
    assert all(
        section.model_fields["rule"].default in str(caught.value) for section in EXCLUSION_SECTIONS
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "'' is not an exclusion rule"),
        ("coverage", "Write coverage<NUMBER"),
        ("coverage>0.9", "Write coverage<NUMBER"),
        ("catch>=1", "Write catch>NUMBER"),
        ("incomplete>1", "Write incomplete"),
        ("coverage<90%", "below: must be a number"),
        ("coverage<2", "below: Input should be less than or equal to 1"),
        ("catch>1.5", "more_than: must be a whole number"),
        ("catch>nan", "more_than: must be a whole number"),
        ("coverage<nan", "below"),
        ("time<3,speed=2", "speed: unknown key"),
        ("time<3,share", "'share' in 'time<3,share' is not KEY=NUMBER"),
    ],
)
def test_a_word_that_is_no_rule_is_refused_with_the_right_one(text: str, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        parse_exclusion(text, where="--exclude")


@pytest.mark.parametrize("template", TEMPLATES)
def test_the_rules_in_each_templates_comments_can_be_stated(tmp_path: Path, template: str) -> None:
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
