"""Duration and pay of a study, and their statements to participants."""

from pathlib import Path
from typing import Any, get_args

import pytest

from studyapp.preflight.material import Material
from studyapp.preflight.recruiting_checks import page_findings, pay_findings, recruiting_findings
from studyapp.preflight.time_checks import ExpectedTime, expected_time, time_findings
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.presentation import Language
from studyapp.study.settings.reading import ALIASES
from studyapp.study.study_file import TEMPLATES, new_study
from tests.support.studies.made_study import CODES, make_segments, make_study

PAGE = {
    "consent": "You agree.",
    "organisation": "Lab",
    "contact": "lab@example.org",
    "payment": "2 EUR",
    "ethics": "No. 7",
    "minutes": 10,
}


@pytest.mark.parametrize(
    ("key", "value", "names"),
    [
        *(
            ("contact", contact, set())
            for contact in ("a@b.org", "https://lab.org", "+49 30 123 456", "www.lab.org")
        ),
        ("organisation", "", {"organisation-missing"}),
        ("contact", " ", {"contact-missing"}),
        ("contact", "the front desk", {"contact-unreachable"}),
        ("payment", "", {"payment-missing"}),
        ("minutes", None, {"minutes-missing"}),
        ("consent", "  \n ", {"consent-blank"}),
    ],
)
def test_missing_page_settings_are_found(key: str, value: object, names: set[str]) -> None:
    page = PAGE | {key: value}
    assert {finding.name for finding in page_findings(make_study(page=page))} == names


@pytest.mark.parametrize("template", [name for name in TEMPLATES if name not in ALIASES])
def test_texts_of_a_template_are_recognised_in_every_language(
    tmp_path: Path, template: str
) -> None:
    for language in get_args(Language):
        study = new_study(
            tmp_path / f"{language}.toml", name="s", template=template, language=language
        )
        names = {finding.name for finding in page_findings(study)}
        assert {"consent-from-template", "title-from-template"} <= names


def test_time_covers_videos_questions_and_texts() -> None:
    # Where no spaces part the words, 2.5 characters count as one.
    consent = "a " * 100 + "動画" * 125
    study = make_study(trials=4, practice=0, catch={"trials": 0}, page={"consent": consent})
    segments = make_segments(["neutral"] * 4)
    material = Material(folder=StudyFolder(Path()), study=study, segments=segments, media=None)

    expected = expected_time(material)

    assert expected is not None
    # Four composed pairs of 1 s; 8 s and two answers of 4 s each; instructions; 200 words.
    assert expected.videos == pytest.approx(4.0)
    assert expected.around == pytest.approx(4 * 16 + 60 + 60)
    assert expected.longest_page == pytest.approx(17.0)


@pytest.mark.parametrize(
    ("minutes", "lease", "names"),
    [
        (9, 45, set()),
        (13, 45, set()),
        (14, 45, {"duration-misstated"}),
        (5, 45, {"duration-misstated"}),
        (61, 45, {"duration-misstated", "duration-long"}),
        (10, 5, {"lease-short"}),
    ],
)
def test_wrong_durations_long_studies_and_short_leases_give_warnings(
    minutes: float, lease: int, names: set[str]
) -> None:
    study = make_study(page=PAGE, lease_minutes=lease)
    expected = ExpectedTime(videos=30 * minutes, around=30 * minutes, longest_page=101)

    findings = {finding.name for finding in time_findings(study, expected)}

    assert findings == {"expected-duration"} | names


def check_pay(
    minutes: int | None = 10, needed: int | None = None, **recruitment: Any
) -> dict[str, str]:
    study = make_study(page={"consent": "You agree.", "minutes": minutes}, recruitment=recruitment)
    findings = (*recruiting_findings(study), *pay_findings(study, needed))
    return {finding.name: finding.what for finding in findings}


def on_prolific(reward: int, currency: str = "", **more: Any) -> dict[str, Any]:
    prolific = CODES | {"reward": reward, **more}
    return {"channel": "prolific", "prolific": prolific, "pay": {"currency": currency}}


EURO = {"amount": "2.50", "currency": "EUR"}
OWN_MINIMUM = {"currency": "EUR", "hourly_minimum": "12.82"}


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
        (on_prolific(99, "GBP"), {"pay-below-prolific-minimum": "5.94 GBP"}),
        (on_prolific(100, "GBP"), {"pay-below-prolific-advice": "6.00 GBP"}),
        (on_prolific(133, "USD"), {"pay-below-prolific-minimum": "7.98 USD"}),
        (on_prolific(134, "USD"), {"pay-below-prolific-advice": "8.04 USD"}),
        (on_prolific(150), {"currency-unknown": ""}),
        (on_prolific(99, "EUR"), {"currency-unknown": ""}),
        # The longer of the stated and the needed duration decides.
        ({"needed": 16, **on_prolific(150, "GBP")}, {"pay-below-prolific-minimum": "5.62 GBP"}),
        ({"channel": "mturk", "mturk": {"reward": "2.50"}}, {"hourly-pay": "15.00 USD"}),
        (
            {"pay": EURO, "needed": 20},
            {"hourly-pay": "and 7.50 EUR per hour at the 20 minutes that they are expected"},
        ),
        (
            {"pay": {"amount": "2.00", **OWN_MINIMUM}},
            {"pay-below-own-minimum": "12.00 EUR, less than your minimum of 12.82 EUR"},
        ),
        ({"pay": {"amount": "2.14", **OWN_MINIMUM}}, {}),
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
