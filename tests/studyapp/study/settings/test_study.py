import re
from pathlib import Path
from typing import Any, get_args

import pytest

from motion.clip import CHANNELS
from motion.errors import InputError
from renderer.look import AVATARS, FRAMINGS, VIEWS
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.presentation import FrozenChannel, Video
from studyapp.study.settings.reading import parse_text, read_study
from studyapp.study.study_file import new_study, render_template
from tests.support.studies.redefining import set_keys


@pytest.fixture
def study_file(tmp_path: Path) -> Path:
    path = tmp_path / "study.toml"
    new_study(path, name="study")
    return path


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"video.colour": "red"}, "video.colour: unknown key"),
        ({"family": "against=nobody"}, "names nobody"),
        ({"family": "the main ones"}, "not a family"),
        ({"reference": "amuse"}, "reference 'amuse' is not a condition"),
        ({"margin": float("inf")}, "margin: must be a finite number"),
        # No win share is further from one half: any two conditions would be equivalent.
        ({"margin": 0.5}, "margin: must be less than 0.5"),
        ({"practice": 20, "trials": 10}, "practice (20) is more than trials (10)"),
        ({"freeze": ["nose"]}, "freeze.0: must be 'face'"),
        ({"conditions.rule_based.generator": "magic"}, "unknown generator 'magic'"),
        ({"conditions.mismatched.source": "nobody"}, "source 'nobody' is not another condition"),
        ({"conditions.rule_based.source": "mismatched"}, "source has no effect here"),
        ({"conditions.broken.generator": "static"}, "must not be one of the conditions"),
        ({"conditions.rule_based.generator": "diffsheg"}, "rule_based.checkpoint: is missing"),
        ({"conditions.mismatched.speaker": 2}, "mismatched.speaker: unknown key"),
        ({"catch.generator": "diffsheg"}, "a network such as 'diffsheg' cannot"),
        ({"catch.against": "nobody"}, "catch.against 'nobody' is not a condition"),
        ({"conditions.rule_based.videos": True}, "cannot have a generator or source"),
        ({"rehearsal.strength": {"nobody": 1}}, "unknown condition 'nobody'"),
        ({"rehearsal.careless": 0.9, "rehearsal.hasty": 0.5}, "add up to 1.62"),
        ({"rehearsal.strength": {"rule_based": {"taste": 1}}}, "unknown question 'taste'"),
        ({"rehearsal.strength": {"rule_based": "high"}}, "must be a number, or a table"),
        ({"freeze": "face"}, "freeze: must be a list in square brackets"),
        ({"video.background": "red"}, "video.background: must be a colour such as"),
        ({"conditions.other": 3}, "conditions.other: must be a table"),
        (
            {
                "conditions.other.generator": "mismatched",
                "conditions.other.source": "mismatched",
                "conditions.mismatched.source": "other",
            },
            "circle",
        ),
        (
            {"questions.0.name": "two words", "questions.1.name": "two words"},
            "questions.1.name: may contain only letters, digits",
        ),
        ({"questions.0.name": "trial"}, "no question can be named 'trial'"),
        ({"questions.0.text": "How {condition}?"}, "may contain {emotion}"),
    ],
)
def test_a_wrong_key_is_named_with_its_file(
    study_file: Path, changes: dict[str, Any], said: str
) -> None:
    set_keys(study_file, changes)
    with pytest.raises(InputError) as caught:
        read_study(study_file)
    assert said in str(caught.value)
    assert str(study_file) in str(caught.value)
    # Wrong questions are not reported as too few.
    assert "at least 1" not in str(caught.value)


STUDY = render_template("pairwise", name="lines")
EXTRA = '\n[[questions]]\nname = "extra"\n'


@pytest.mark.parametrize(
    ("before", "after", "line", "said"),
    [
        ("\ntrials = 24", "\ntrials = -24", "trials = -24", "(line {})"),
        ('protocol = "pairwise"', 'protocol = "pair"', "protocol = ", "protocol 'pair' (line {})"),
        ('devices = ["computer", "tablet"]', 'devices = ["watch"]', "devices = ", "(line {})"),
        ('title = "Expression of the emotion"', "title = 3", "title = 3", "(line {})"),
        (
            "sound_check = true",
            'thanks = """\nbreak_every = 3\n[video]\n"""\nsound_check = 7',
            "sound_check = 7",
            "(line {})",
        ),
        ('reference = "rule_based"', 'reference = "none"', 'reference = "none"', "(line {})"),
        # What is missing is named with the table that lacks it.
        ("", EXTRA, "[[questions]]", "(line {})"),
        (
            "[catch]",
            '[catch]\nagianst = "x"',
            "agianst",
            "agianst: unknown key in line {} (did you mean 'against'?)",
        ),
    ],
)
def test_mistakes_are_reported_with_their_line(
    before: str, after: str, line: str, said: str
) -> None:
    text = STUDY.replace(before, after, 1) if before else STUDY + after
    assert text != STUDY
    number = max(number for number, words in enumerate(text.split("\n"), 1) if line in words)
    with pytest.raises(InputError, match=re.escape(said.format(number))):
        parse_text(text, where="study.toml")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b'name = "a"\ntitle = \n', "line 2"),
        (b"\xff\xfe\x00", "UTF-8"),
        (b"a = " + 9999 * b"[", "not valid TOML"),
        (None, "motionjury init"),
    ],
)
def test_an_unreadable_file_is_named_with_a_remedy(
    study_file: Path, content: bytes | None, said: str
) -> None:
    if content is None:
        study_file.unlink()
    else:
        study_file.write_bytes(content)
    with pytest.raises(InputError, match=said):
        read_study(study_file)


def test_catch_trials_show_the_ground_truth_and_all_pairs_both_orders(study_file: Path) -> None:
    assert read_study(study_file).catch_against == "rule_based"
    set_keys(study_file, {"conditions.ground_truth": {}})
    study = read_study(study_file)
    assert isinstance(study, PairwiseStudy)
    assert study.catch_against == "ground_truth"
    assert set(study.others) == {"mismatched", "ground_truth"}
    assert ("ground_truth", "broken") in study.pairs
    assert all((right, left) in study.pairs for left, right in study.pairs)
    assert len(study.pairs) == 6


def test_sources_are_generated_before_their_dependents(study_file: Path) -> None:
    set_keys(study_file, {"reference": "mismatched"})
    assert list(read_study(study_file).generated()) == ["rule_based", "mismatched", "broken"]


def test_offered_looks_match_the_renderers() -> None:
    for key, known in (("avatar", AVATARS), ("framing", FRAMINGS), ("view", VIEWS)):
        assert get_args(Video.model_fields[key].annotation) == tuple(known)
    assert get_args(FrozenChannel) == tuple(CHANNELS)


def test_one_published_evaluator_is_named_as_a_table_and_several_as_a_list(
    study_file: Path,
) -> None:
    one = {"preset": "emage", "file": "AESKConv_240_100.bin"}
    two = {"preset": "beat", "file": "ae_300.bin", "statistics": "beat"}
    for stated, presets in ((one, ["emage"]), ([one, two], ["emage", "beat"])):
        set_keys(study_file, {"evaluator": stated})
        assert [each.preset for each in read_study(study_file).evaluator] == presets
