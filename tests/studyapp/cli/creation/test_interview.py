"""Questions for a new study: what is asked, what is refused at once, and what is written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import pytest

from generators.learned_settings import ModelSettings
from studyapp.preflight.check import check
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.settings.reading import read_study
from studyapp.study.settings.recruitment import Channel
from tests.studyapp.command_line import run


def init(folder: Path, *arguments: object, answers: Sequence[str] = (), status: int = 0) -> str:
    typed = "".join(f"{answer}\n" for answer in answers)
    return run("init", folder, *arguments, status=status, typed=typed)


OWN = ["own", "ground_truth", "files", "ours", "files", "shuffled", "mismatched", ""]
TOLD = ["Who moves?", "Lab of Gestures", "lab@example.org", "No. 7/2026"]


def test_answers_end_up_in_the_study_file(tmp_path: Path) -> None:
    answers = ["pairwise", *OWN, "ground_truth", "en", "30", "link", "2,5 eur", "15", *TOLD, ""]

    init(tmp_path / "s", "--ask", answers=answers)

    study = read_study(tmp_path / "s" / "study.toml")
    assert isinstance(study, PairwiseStudy)
    assert list(study.conditions) == ["ground_truth", "ours", "shuffled"]
    assert study.conditions["shuffled"].source == "ground_truth"
    assert (study.reference, study.participants_per_comparison) == ("ground_truth", 30)
    assert (study.recruitment.pay.amount, study.recruitment.pay.currency) == ("2.50", "EUR")
    assert (study.page.minutes, study.page.payment) == (15, "2.50 EUR")
    assert (study.title, study.page.organisation) == ("Who moves?", "Lab of Gestures")
    assert (study.page.contact, study.page.ethics) == ("lab@example.org", "No. 7/2026")


def test_what_will_be_written_is_shown_before_and_nothing_is_if_it_is_not_wanted(
    tmp_path: Path,
) -> None:
    answers = ["rating", *OWN, "de", "12", "link", "", "", "", "", "", "", "leave"]

    result = init(tmp_path / "s", "--ask", answers=answers, status=1)

    assert "the template 'rating' in German" in result
    assert '  conditions = ["ground_truth", "ours", "shuffled"]' in result
    assert "  participants = 12" in result
    assert not (tmp_path / "s").exists()


def test_wrong_answers_are_told_and_asked_again(tmp_path: Path) -> None:
    conditions = ["own", "-", "a/b", "real", "9", "mismatched", "files", "real", "broken", "ours"]
    conditions += ["mismatched:nobody", "videos", ""]
    answers = ["dance", "pairwise", *conditions, "theirs", "real", "xx", "en", "none", "0", "8"]
    answers += ["post", "prolific", "", "1.999", "3", "3 pounds", "3 GBP", "1000", "20"]
    answers += ["T", "", "nobody", "lab@example.org", "", "write"]

    result = init(tmp_path / "s", "--ask", answers=answers)

    for said in (
        "'dance' is none of them",
        "two conditions at least",
        "unknown source '9'",
        "needs another condition to start from",
        "there is a condition 'real' already",
        "'broken' is what catch trials show",
        "there is no condition 'nobody' yet",
        "'theirs' is none of the conditions",
        "'none' is not a number of participants",
        "recruiting sites must be told what participants get",
        "'1.999' is not an amount",
        "an amount needs a currency",
        "'pounds' is not a currency",
        "'1000' is not a number of minutes",
        "'nobody' does not say how to reach anybody",
    ):
        assert said in result
    study = read_study(tmp_path / "s" / "study.toml")
    assert study.recruitment.prolific.reward == 300
    assert study.recruitment.missing_codes == []


def test_answers_can_be_gone_through_again(tmp_path: Path) -> None:
    first = ["ranking", *OWN, "ground_truth", "en", "", "link", "", "", "", "First"]
    first += ["", "", "change"]
    again = ["", "", "", "", "", "", "", "", "-", "", "", "7", "", "", "", "", "-", "", "", ""]

    init(tmp_path / "s", "--ask", answers=[*first, *again])

    study = read_study(tmp_path / "s" / "study.toml")
    assert isinstance(study, RankingStudy)
    assert (study.participants, study.reference) == (7, "ground_truth")
    assert study.blocks[0].conditions == ("ours", "shuffled")
    assert study.page.organisation == ""


@pytest.mark.parametrize("place", ["s/models/ours.safetensors", "elsewhere/ours.safetensors"])
def test_a_network_is_a_condition_by_its_weights(tmp_path: Path, place: str) -> None:
    weights = tmp_path / place
    weights.parent.mkdir(parents=True)
    weights.touch()
    conditions = [
        "own",
        "real",
        "files",
        "ours",
        "6",
        "diffsheg:nowhere",
        f"diffsheg:{weights}",
        "",
    ]
    answers = ["pairwise", *conditions, "real", "en", "", "link", "", "", *TOLD]
    again = ["", "", "", "", "", "", "-", *[""] * 20]

    asked = init(tmp_path / "s", "--ask", answers=[*answers, "change", *again])
    init(tmp_path / "t", "--condition", "real=files", "--condition", f"ours=diffsheg:{weights}")

    assert "'diffsheg' is a network and needs its weights" in asked
    assert "there is no such file of weights" in asked
    named: dict[str, Path] = {}
    for name in ("s", "t"):
        ours = read_study(tmp_path / name / "study.toml").conditions["ours"]
        assert ours.generator == "diffsheg"
        assert isinstance(ours.settings, ModelSettings)
        named[name] = ours.settings.checkpoint
        assert (tmp_path / name / named[name]).resolve() == weights
    assert named["s"] == (Path("models/ours.safetensors") if place.startswith("s/") else weights)


def test_videos_of_a_broken_motion_are_asked_for_where_none_can_be_made(tmp_path: Path) -> None:
    conditions = ["own", "real", "videos", "ours", "videos", ""]
    end = ["en", "", "link", "", "", "", "", "", "", "write"]

    for answer in ("y", "n"):
        result = init(
            tmp_path / answer, "--ask", answers=["pairwise", *conditions, "real", answer, *end]
        )

        assert "videos/CONDITION/SEGMENT.mp4" in result
    with_them, without = (read_study(tmp_path / answer / "study.toml") for answer in ("y", "n"))
    assert (with_them.catch.videos, with_them.catch.trials) == (True, 3)
    assert (without.catch.trials, without.attention.trials) == (0, 2)
    assert isinstance(without, PairwiseStudy)
    assert without.layout == "players"


def test_who_leaves_halfway_leaves_nothing_behind(tmp_path: Path) -> None:
    result = init(tmp_path / "s", "--ask", answers=["rating", "own"], status=130)

    assert "Nothing was written" in result
    assert not (tmp_path / "s").exists()


def test_an_existing_study_is_told_before_anything_is_asked(tmp_path: Path) -> None:
    init(tmp_path / "s")

    result = init(tmp_path / "s", "--ask", status=1)

    assert "exists already" in result
    assert "Protocol" not in result


def test_all_of_it_goes_by_options_too(tmp_path: Path) -> None:
    init(
        tmp_path / "s", "--template", "rating", "--condition", "real=files", "--condition",
        "ours=files", "--condition", "late=mismatched:ours", "--participants", 40, "--recruit",
        "prolific", "--pay", "3 GBP", "--minutes", 20,
        "--organisation", "Lab", "--contact", "lab@example.org", "--ethics", "No. 7", "--language",
        "ja",
    )  # fmt: skip

    study = read_study(tmp_path / "s" / "study.toml")
    assert study.arms[0].places == 40
    assert list(study.conditions) == ["real", "ours", "late"]
    assert study.recruitment.prolific.reward == 300
    assert study.page.ethics == "No. 7"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--condition", "ours"], "does not say where its motion comes from"),
        (["--condition", "ours=magic", "--condition", "b=files"], "unknown source 'magic'"),
        (["--condition", "a=mismatched", "--condition", "b=files"], "needs the condition"),
        (["--condition", "a=files", "--condition", "a=files"], "given twice"),
        (["--condition", "a=files"], "nothing to compare"),
        (["--condition", "a=diffsheg", "--condition", "b=files"], "needs its weights"),
        (["--recruit", "prolific"], "must be told --pay and --minutes"),
        (["--pay", "2.50"], "needs a currency"),
        (["--pay", "much EUR"], "'much' is not an amount"),
    ],
)
def test_options_that_make_no_study_are_refused_and_nothing_is_written(
    tmp_path: Path, options: list[str], said: str
) -> None:
    result = init(tmp_path / "s", *options, status=1)

    assert said in result
    assert not (tmp_path / "s" / "study.toml").exists()


@pytest.mark.parametrize("template", ["pairwise", "rating", "ranking", "mismatch", "three-systems"])
def test_check_asks_a_new_study_for_media_alone(tmp_path: Path, template: str) -> None:
    for channel in get_args(Channel):
        init(
            tmp_path / channel, "--template", template, "--condition", "real=files", "--condition",
            "ours=files", "--condition", "late=mismatched:ours", "--recruit", channel, "--pay",
            "3 USD", "--minutes", 20,
        )  # fmt: skip

    channel = get_args(Channel)[len(template) % 4]
    found = check(StudyFolder(tmp_path / channel))
    assert [each.name for each in found if each.severity == "error"] == ["speech-unreadable"]
