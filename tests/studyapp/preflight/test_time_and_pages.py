"""How long a study takes, what participants are told, and how fast they really were."""

from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.preflight.expected_time import ExpectedTime, expected_time, words
from studyapp.preflight.material import Material
from studyapp.preflight.page_checks import page_findings
from studyapp.preflight.time_checks import (
    Pace,
    minutes_needed,
    pace_of_pilot,
    pace_of_study,
    time_findings,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from tests.studyapp.answered_study import answer_study
from tests.studyapp.made_study import make_segments, make_study

PAGE = {
    "consent": "You agree.",
    "organisation": "Lab",
    "contact": "lab@example.org",
    "payment": "2 EUR",
    "ethics": "No. 7",
    "minutes": 10,
}


def told(**page: object) -> set[str]:
    return {found.name for found in page_findings(make_study(page=PAGE | page))}


def timed(study: PairwiseStudy, minutes: float, pace: Pace | None = None) -> set[str]:
    expected = ExpectedTime(videos=30 * minutes, around=30 * minutes, longest_page=60)
    return {found.name for found in time_findings(study, expected, pace)} - {"expected-duration"}


def test_a_page_that_says_all_is_not_found_fault_with() -> None:
    assert told() == set()


@pytest.mark.parametrize(
    ("key", "value", "name"),
    [
        ("organisation", "", "organisation-missing"),
        ("contact", " ", "contact-missing"),
        ("contact", "the front desk", "contact-unreachable"),
        ("payment", "", "payment-missing"),
        ("ethics", "", "ethics-missing"),
        ("minutes", None, "minutes-missing"),
        ("consent", "  \n ", "consent-blank"),
    ],
)
def test_what_participants_are_not_told_has_a_name(key: str, value: object, name: str) -> None:
    assert told(**{key: value}) == {name}


@pytest.mark.parametrize("contact", ["a@b.org", "https://lab.org", "+49 30 123 456", "www.lab.org"])
def test_there_are_many_ways_to_reach_somebody(contact: str) -> None:
    assert told(contact=contact) == set()


def test_texts_of_a_template_are_known_in_every_language(tmp_path: Path) -> None:
    from studyapp.study.creation.study_file import new_study

    for language in ("en", "de", "ja"):
        study = new_study(tmp_path / f"{language}.toml", name="s", language=language)
        found = {each.name for each in page_findings(study)}
        assert {"consent-from-template", "title-from-template"} <= found


def test_time_is_that_of_videos_questions_and_texts() -> None:
    study = make_study(trials=4, practice=0, catch={"trials": 0}, page={"consent": "a " * 200})
    segments = make_segments(["neutral"] * 4)
    material = Material(folder=StudyFolder(Path()), study=study, segments=segments, media=None)

    expected = expected_time(material)

    assert expected is not None
    # Four composed pairs of 1 s; 8 s and two answers of 4 s each; instructions; 200 words.
    assert expected.videos == pytest.approx(4.0)
    assert expected.around == pytest.approx(4 * 16 + 60 + 60)
    assert expected.longest_page == pytest.approx(17.0)


def test_words_are_counted_where_no_spaces_are_written() -> None:
    assert words("three short words") == 3
    assert words("動画を見て下さい。") == pytest.approx(8 / 2.5 + 1)


@pytest.mark.parametrize(("minutes", "wrong"), [(9, False), (13, False), (14, True), (5, True)])
def test_a_duration_that_is_told_wrong_is_warned_of(minutes: float, wrong: bool) -> None:
    assert ("duration-misstated" in timed(make_study(page=PAGE), minutes)) == wrong


def test_long_studies_and_short_leases_are_warned_of() -> None:
    assert "duration-long" in timed(make_study(), 61)
    study = make_study(lease_minutes=5)
    slow = ExpectedTime(videos=120, around=10, longest_page=101)
    assert "lease-short" in {found.name for found in time_findings(study, slow, None)}


def test_who_has_finished_tells_the_pace(tiny_study: Path) -> None:
    folder = StudyFolder(tiny_study)
    material = Material.of(folder, folder.study())
    assert pace_of_study(material) is None
    answer_study(tiny_study, people=4, stop_after=2)

    pace = pace_of_pilot(folder)

    expected = expected_time(material)
    assert expected is not None
    # Six trials of ten seconds each.
    assert (pace.finished, pace.minutes) == (3, 1.0)
    assert pace.times_expected == pytest.approx(60 / expected.seconds)
    assert minutes_needed(expected, pace) == 1


def test_a_pilot_that_too_few_have_finished_is_refused(tiny_study: Path) -> None:
    answer_study(tiny_study, people=2)

    with pytest.raises(InputError, match="fewer than 3 participants"):
        pace_of_pilot(StudyFolder(tiny_study))
