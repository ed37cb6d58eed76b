"""How long a study takes and what it pays, what participants are told, and their real pace."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from motion.errors import InputError
from studyapp.preflight.material import Material
from studyapp.preflight.recruiting_checks import (
    code_findings,
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
from studyapp.study.settings.recruitment import Recruitment
from studyapp.study.study_file import new_study
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


def on_prolific(reward: int, currency: str = "", **pay: str) -> dict[str, Any]:
    return {
        "channel": "prolific",
        "prolific": CODES | {"reward": reward},
        "pay": {"currency": currency, **pay},
    }


def test_what_prolific_would_miss_is_an_error() -> None:
    missing = found(minutes=None, channel="prolific")

    assert "completed, screened_out and failed_attention" in missing["codes-missing"]
    assert "recruitment.prolific.reward and page.minutes" in missing["pay-unknown"]
    study = make_study(recruitment={"channel": "prolific"})
    severities = {each.severity for each in recruiting_findings(study)}
    assert severities == {"error"}


def test_pay_by_the_hour_is_said() -> None:
    assert "9.00 GBP for an hour" in found(**on_prolific(150, "GBP"))["hourly-pay"]
    mturk = found(channel="mturk", mturk={"reward": "2.50"})
    assert "15.00 USD for an hour" in mturk["hourly-pay"]
    link = found(pay={"amount": "3.00", "currency": "EUR"}, needed=20)
    assert "18.00 EUR for an hour at the 10 minutes that they are told" in link["hourly-pay"]
    assert "9.00 EUR for an hour at the 20 minutes that they are expected" in link["hourly-pay"]


@pytest.mark.parametrize(
    ("reward", "currency", "name"),
    [
        (99, "GBP", "pay-below-prolific-minimum"),
        (100, "GBP", "pay-below-prolific-advice"),
        (133, "USD", "pay-below-prolific-minimum"),
        (134, "USD", "pay-below-prolific-advice"),
        (150, "", "currency-unknown"),
    ],
)
def test_pay_is_held_against_what_prolific_publishes(reward: int, currency: str, name: str) -> None:
    assert name in found(**on_prolific(reward, currency))


def test_enough_pay_is_only_told() -> None:
    assert list(found(**on_prolific(150, "GBP"))) == ["hourly-pay"]
    assert list(found(**on_prolific(200, "USD"))) == ["hourly-pay"]


def test_pay_is_judged_by_the_longer_of_what_is_told_and_needed() -> None:
    assert "pay-below-prolific-minimum" in found(needed=16, **on_prolific(150, "GBP"))


def test_pay_below_the_studys_own_minimum_is_warned_of() -> None:
    pay = {"amount": "2.00", "currency": "EUR", "hourly_minimum": "12.82"}

    below = found(pay=pay)["pay-below-own-minimum"]

    assert below == "an hour pays 12.00 EUR, less than your minimum of 12.82 EUR"
    assert "pay-below-own-minimum" not in found(pay=pay | {"amount": "2.14"})


@pytest.mark.parametrize(
    ("payment", "differs"),
    [("2.50 EUR", False), ("2,50 Euro", False), ("3 EUR", True), ("a voucher", False)],
)
def test_the_text_and_the_number_say_the_same(payment: str, differs: bool) -> None:
    said = found(payment=payment, pay={"amount": "2.50", "currency": "EUR"})

    assert ("payment-text-differs" in said) == differs


def test_whom_the_payment_rule_does_not_pay_is_said() -> None:
    one, two = (found(attention=n, channel="invitations") for n in (1, 2))

    assert "everybody who finishes is paid" in one["everybody-paid"]
    assert "who fails 2 of 2 attention checks need not be paid" in two["unpaid-rule"]


@pytest.mark.parametrize(("places", "said"), [(60, "find the study full"), (40, "leave places")])
def test_a_recruiter_is_told_as_many_places_as_there_are(places: int, said: str) -> None:
    prolific = CODES | {"reward": 150, "places": places}

    assert said in found(channel="prolific", prolific=prolific)["places-differ"]
    prolific["places"] = 50
    assert "places-differ" not in found(channel="prolific", prolific=prolific)


def test_codes_that_do_not_do_their_work_have_names_of_their_own() -> None:
    alike = Recruitment.model_validate(
        {"prolific": {"completed": "KX7QM2PWTR", "screened_out": "kx7qm2pwtr"}}
    )
    guessable = Recruitment.model_validate({"prolific": {"completed": "ABCDEFGH"}})

    assert [each.name for each in code_findings(alike)] == ["codes-alike"]
    (said,) = code_findings(guessable)
    assert (said.name, said.where) == ("code-guessable", "recruitment.prolific.completed")
