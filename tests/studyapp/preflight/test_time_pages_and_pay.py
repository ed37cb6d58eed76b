"""How long a study takes and what it pays, what participants are told, and their real pace."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from motion.errors import InputError
from studyapp.preflight.material import Material
from studyapp.preflight.recruiting_checks import (
    page_findings,
    pay_findings,
    recruiting_findings,
)
from studyapp.preflight.time_checks import (
    ExpectedTime,
    Pace,
    expected_time,
    minutes_needed,
    pace_of_pilot,
    pace_of_study,
    time_findings,
    words,
)
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.study_file import new_study
from tests.support.studies.answered_study import answer_study
from tests.support.studies.made_study import make_segments, make_study

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


@pytest.mark.parametrize("contact", ["a@b.org", "https://lab.org", "+49 30 123 456", "www.lab.org"])
def test_a_page_that_says_all_is_not_found_fault_with(contact: str) -> None:
    assert told(contact=contact) == set()


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


def test_texts_of_a_template_are_known_in_every_language(tmp_path: Path) -> None:
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


CODES = {"completed": "KX7QM2PWTR", "screened_out": "HB4NVJ9ZCD", "failed_attention": "WU3FGRE8KA"}


def found(
    minutes: int | None = 10,
    attention: int = 0,
    needed: int | None = None,
    payment: str = "",
    **recruitment: Any,
) -> dict[str, str]:
    """Return what is said under the name of each finding."""
    study = make_study(
        page={"consent": "You agree.", "minutes": minutes, "payment": payment},
        attention={"trials": attention},
        recruitment=recruitment,
    )
    return {
        each.name: each.what for each in (*recruiting_findings(study), *pay_findings(study, needed))
    }


def on_prolific(reward: int, currency: str = "", **more: Any) -> dict[str, Any]:
    prolific = CODES | {"reward": reward, **more}
    return {"channel": "prolific", "prolific": prolific, "pay": {"currency": currency}}


EURO = {"amount": "2.50", "currency": "EUR"}
OWN_MINIMUM = {"currency": "EUR", "hourly_minimum": "12.82"}
INVITED = {"channel": "invitations"}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (
            {"minutes": None, "channel": "prolific"},
            {
                "codes-missing": "completed, screened_out and failed_attention",
                "pay-unknown": "recruitment.prolific.reward and page.minutes",
            },
        ),
        (on_prolific(150, "GBP"), {"hourly-pay": "9.00 GBP for an hour"}),
        (on_prolific(200, "USD"), {"hourly-pay": "12.00 USD"}),
        (on_prolific(99, "GBP"), {"pay-below-prolific-minimum": "5.94 GBP"}),
        (on_prolific(100, "GBP"), {"pay-below-prolific-advice": "6.00 GBP"}),
        (on_prolific(133, "USD"), {"pay-below-prolific-minimum": "7.98 USD"}),
        (on_prolific(134, "USD"), {"pay-below-prolific-advice": "8.04 USD"}),
        (on_prolific(150), {"currency-unknown": ""}),
        # The longer of what is told and needed decides.
        ({"needed": 16, **on_prolific(150, "GBP")}, {"pay-below-prolific-minimum": "5.62 GBP"}),
        (on_prolific(150, "GBP", places=60), {"places-differ": "find the study full"}),
        (on_prolific(150, "GBP", places=50), {}),
        (on_prolific(150, "GBP", places=40), {"places-differ": "leave places empty"}),
        ({"channel": "mturk", "mturk": {"reward": "2.50"}}, {"hourly-pay": "15.00 USD"}),
        (
            {"pay": EURO},
            {"hourly-pay": "15.00 EUR for an hour at the 10 minutes that they are told"},
        ),
        (
            {"pay": EURO, "needed": 20},
            {"hourly-pay": "and 7.50 EUR for an hour at the 20 minutes that they are expected"},
        ),
        (
            {"pay": {"amount": "2.00", **OWN_MINIMUM}},
            {"pay-below-own-minimum": "12.00 EUR, less than your minimum of 12.82 EUR"},
        ),
        ({"pay": {"amount": "2.14", **OWN_MINIMUM}}, {}),
        ({"pay": EURO, "payment": "2.50 EUR"}, {}),
        ({"pay": EURO, "payment": "2,50 Euro"}, {}),
        ({"pay": EURO, "payment": "a voucher"}, {}),
        ({"pay": EURO, "payment": "3 EUR"}, {"payment-text-differs": "3 EUR"}),
        ({"attention": 1, **INVITED}, {"everybody-paid": "everybody who finishes is paid"}),
        ({"attention": 2, **INVITED}, {"unpaid-rule": "who fails 2 of 2 attention checks need"}),
    ],
)
def test_pay_and_places_are_held_against_what_is_told_and_needed(
    given: dict[str, Any], said: dict[str, str]
) -> None:
    """Beside what is listed, what an hour pays and what else is worth knowing may be told."""
    what = found(**given)

    assert {name: words in what.get(name, "") for name, words in said.items()} == dict.fromkeys(
        said, True
    )
    assert what.keys() - said.keys() <= {"hourly-pay", "pay-not-stated", "codes-missing"}
