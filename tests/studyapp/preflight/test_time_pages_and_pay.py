"""Duration and pay of a study, and what participants are told about them."""

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
    count_words,
    expected_time,
    minutes_needed,
    pace_of_pilot,
    pace_of_study,
    time_findings,
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


def check_page(**page: object) -> set[str]:
    return {finding.name for finding in page_findings(make_study(page=PAGE | page))}


def check_time(study: PairwiseStudy, minutes: float, pace: Pace | None = None) -> set[str]:
    expected = ExpectedTime(videos=30 * minutes, around=30 * minutes, longest_page=60)
    return {finding.name for finding in time_findings(study, expected, pace)} - {
        "expected-duration"
    }


@pytest.mark.parametrize("contact", ["a@b.org", "https://lab.org", "+49 30 123 456", "www.lab.org"])
def test_a_complete_page_has_no_findings(contact: str) -> None:
    assert check_page(contact=contact) == set()


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
def test_gaps_of_the_page_are_found(key: str, value: object, name: str) -> None:
    assert check_page(**{key: value}) == {name}


def test_texts_of_a_template_are_recognised_in_every_language(tmp_path: Path) -> None:
    for language in ("en", "de", "ja"):
        study = new_study(tmp_path / f"{language}.toml", name="s", language=language)
        names = {finding.name for finding in page_findings(study)}
        assert {"consent-from-template", "title-from-template"} <= names


def test_time_covers_videos_questions_and_texts() -> None:
    study = make_study(trials=4, practice=0, catch={"trials": 0}, page={"consent": "a " * 200})
    segments = make_segments(["neutral"] * 4)
    material = Material(folder=StudyFolder(Path()), study=study, segments=segments, media=None)

    expected = expected_time(material)

    assert expected is not None
    # Four composed pairs of 1 s; 8 s and two answers of 4 s each; instructions; 200 words.
    assert expected.videos == pytest.approx(4.0)
    assert expected.around == pytest.approx(4 * 16 + 60 + 60)
    assert expected.longest_page == pytest.approx(17.0)


def test_words_are_counted_in_text_without_spaces() -> None:
    assert count_words("three short words") == 3
    assert count_words("動画を見て下さい。") == pytest.approx(8 / 2.5 + 1)


@pytest.mark.parametrize(("minutes", "wrong"), [(9, False), (13, False), (14, True), (5, True)])
def test_a_misstated_duration_is_warned_of(minutes: float, wrong: bool) -> None:
    assert ("duration-misstated" in check_time(make_study(page=PAGE), minutes)) == wrong


def test_long_studies_and_short_leases_are_warned_of() -> None:
    assert "duration-long" in check_time(make_study(), 61)
    study = make_study(lease_minutes=5)
    slow = ExpectedTime(videos=120, around=10, longest_page=101)
    assert "lease-short" in {finding.name for finding in time_findings(study, slow, None)}


def test_the_pace_is_that_of_participants_who_finished(tiny_study: Path) -> None:
    folder = StudyFolder(tiny_study)
    material = Material.read(folder, folder.study())
    assert pace_of_study(material) is None
    with pytest.raises(InputError, match="fewer than 3 participants"):
        pace_of_pilot(folder)
    answer_study(tiny_study, people=4, stop_after=2)

    pace = pace_of_pilot(folder)

    expected = expected_time(material)
    assert expected is not None
    # Six trials of ten seconds each.
    assert (pace.finished, pace.minutes) == (3, 1.0)
    assert pace.times_expected == pytest.approx(60 / expected.seconds)
    assert minutes_needed(expected, pace) == 1


CODES = {"completed": "KX7QM2PWTR", "screened_out": "HB4NVJ9ZCD", "failed_attention": "WU3FGRE8KA"}


def check_pay(
    minutes: int | None = 10,
    attention: int = 0,
    needed: int | None = None,
    payment: str = "",
    **recruitment: Any,
) -> dict[str, str]:
    study = make_study(
        page={"consent": "You agree.", "minutes": minutes, "payment": payment},
        attention={"trials": attention},
        recruitment=recruitment,
    )
    findings = (*recruiting_findings(study), *pay_findings(study, needed))
    return {finding.name: finding.what for finding in findings}


def on_prolific(reward: int, currency: str = "", **more: Any) -> dict[str, Any]:
    prolific = CODES | {"reward": reward, **more}
    return {"channel": "prolific", "prolific": prolific, "pay": {"currency": currency}}


EURO = {"amount": "2.50", "currency": "EUR"}
OWN_MINIMUM = {"currency": "EUR", "hourly_minimum": "12.82"}
INVITED = {"channel": "invitations"}


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        (
            {"minutes": None, "channel": "prolific"},
            {
                "codes-missing": "completed, screened_out and failed_attention",
                "pay-unknown": "recruitment.prolific.reward and page.minutes",
            },
        ),
        (on_prolific(150, "GBP"), {"hourly-pay": "9.00 GBP per hour"}),
        (on_prolific(200, "USD"), {"hourly-pay": "12.00 USD"}),
        (on_prolific(99, "GBP"), {"pay-below-prolific-minimum": "5.94 GBP"}),
        (on_prolific(100, "GBP"), {"pay-below-prolific-advice": "6.00 GBP"}),
        (on_prolific(133, "USD"), {"pay-below-prolific-minimum": "7.98 USD"}),
        (on_prolific(134, "USD"), {"pay-below-prolific-advice": "8.04 USD"}),
        (on_prolific(150), {"currency-unknown": ""}),
        # The longer of the stated and the needed duration decides.
        ({"needed": 16, **on_prolific(150, "GBP")}, {"pay-below-prolific-minimum": "5.62 GBP"}),
        (on_prolific(150, "GBP", places=60), {"places-differ": "so some find the study full"}),
        (on_prolific(150, "GBP", places=50), {}),
        (on_prolific(150, "GBP", places=40), {"places-differ": "so places remain empty"}),
        ({"channel": "mturk", "mturk": {"reward": "2.50"}}, {"hourly-pay": "15.00 USD"}),
        (
            {"pay": EURO},
            {"hourly-pay": "15.00 EUR per hour at the 10 minutes that they are told"},
        ),
        (
            {"pay": EURO, "needed": 20},
            {"hourly-pay": "and 7.50 EUR per hour at the 20 minutes that they are expected"},
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
        (
            {"attention": 2, **INVITED},
            {"unpaid-rule": "participants who fail 2 of 2 attention checks need not"},
        ),
    ],
)
def test_pay_and_places_are_compared_with_what_is_stated_and_needed(
    settings: dict[str, Any], expected: dict[str, str]
) -> None:
    findings = check_pay(**settings)

    assert expected.keys() <= findings.keys()
    for name, words in expected.items():
        assert words in findings[name]
    assert findings.keys() - expected.keys() <= {"hourly-pay", "pay-not-stated", "codes-missing"}
