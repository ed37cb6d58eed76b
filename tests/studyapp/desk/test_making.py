"""A study made in the browser is the one that `motionjury init` makes."""

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.desk.lab import Lab
from studyapp.researchers import links
from studyapp.researchers.account import list_accounts
from studyapp.study.interview import TEMPLATE_DESCRIPTIONS
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.reading import read_study
from tests.studyapp.desk.conftest import Researcher
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.command_line import run

MAKE = "/research/make/study"


def filled_in(page: PageReader) -> dict[str, str]:
    """Return what a browser would send of the unchanged form, without rows of conditions."""
    form = page.one("form.questions")
    sent = {}
    for field in form.select("input[name]"):
        kind = field.get("type")
        if kind in ("radio", "checkbox") and not field.has_attr("checked"):
            continue
        if field["name"] not in ("condition", "source", "form_code"):
            sent[str(field["name"])] = str(field.get("value", ""))
    for area in form.select("textarea[name]"):
        sent[str(area["name"])] = area.text
    for choice in form.select("select[name]"):
        (chosen,) = choice.select("option[selected]")
        sent[str(choice["name"])] = str(chosen.get("value", chosen.text))
    return sent


@pytest.fixture
def grace(researcher: Researcher) -> ResearchBrowser:
    """Return the browser of an analyst of the desk."""
    researcher("Ada")
    return researcher("Grace", "analyst")


@pytest.mark.parametrize(
    ("template", "language"), [*((each, "en") for each in TEMPLATE_DESCRIPTIONS), ("rating", "ja")]
)
def test_the_default_form_makes_the_same_study_as_init(
    lab: Lab, grace: ResearchBrowser, tmp_path: Path, template: str, language: str
) -> None:
    fields = filled_in(grace.get(f"{MAKE}?template={template}&language={language}"))
    answer = grace.post(MAKE, **fields | {"name": "made"})
    assert answer.status_code == 303, answer.text
    run("init", tmp_path / "made", "--template", template, "--language", language)
    made, expected = (read_study(root / "made" / "study.toml") for root in (lab.folder, tmp_path))
    assert made == expected
    (owner,) = list_accounts(lab.study("made").database)  # type: ignore[union-attr]
    assert (owner.name, owner.role) == ("Grace", "owner")
    assert "made" in grace.get("/research/").text


def test_the_forms_values_are_written_into_the_study_file(lab: Lab, grace: ResearchBrowser) -> None:
    fields = filled_in(grace.get(f"{MAKE}?template=pairwise&language=en")) | {
        "name": "own",
        "reference": "ground_truth",
        "trials": "12",
        "participants": "7",
        "avatar": "maya",
        "framing": "hands",
        "pay": "2.50 GBP",
        "minutes": "15",
        "channel": "prolific",
        "contact": "lab@example.org",
        "question-synchronisation": 'Which gestures "fit" better?',
    }
    conditions = ["ground_truth", "ours", "chance", ""]
    sources = ["files", "files", "mismatched:ground_truth", "files"]
    assert grace.post(MAKE, **fields, condition=conditions, source=sources).status_code == 303
    study = read_study(lab.folder / "own" / "study.toml")
    assert isinstance(study, PairwiseStudy)
    assert list(study.conditions) == ["ground_truth", "ours", "chance"]
    assert (study.reference, study.trials) == ("ground_truth", 12)
    assert (study.video.avatar, study.video.framing) == ("maya", "hands")
    assert study.questions[0].text == 'Which gestures "fit" better?'
    assert (study.recruitment.channel, study.page.contact) == ("prolific", "lab@example.org")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"name": "../elsewhere"}, "cannot be called"),
        ({"name": "research"}, "cannot be called"),
        ({"name": "tiny"}, "already"),
        ({"trials": "many"}, "not a number"),
        ({"participants": "9" * 5000}, "not a number"),
        ({"condition": "ours", "source": "no_such"}, "unknown source"),
        ({"avatar": "nobody"}, "avatar"),
        ({"framing": "feet"}, "framing"),
        ({"title": "T" * 201}, "title"),
        ({"title": "a\x1bb"}, "control character"),
        ({"question-synchronisation": "Q" * 301}, "questions"),
    ],
)
def test_mistakes_are_reported_and_nothing_is_created(
    lab: Lab, grace: ResearchBrowser, wrong: dict[str, str], message: str
) -> None:
    before = {each.name for each in lab.folder.iterdir()}
    fields = filled_in(grace.get(f"{MAKE}?template=pairwise&language=en"))
    answer = grace.post(MAKE, **fields | {"name": "new", "ethics": "Kept words"} | wrong)
    assert answer.status_code == 422
    problem = PageReader(answer.text).words(".problem")
    assert message in problem.lower()
    assert ". ." not in problem
    assert "(line " not in problem, "there is no file yet"
    assert "Kept words" in answer.text
    assert {each.name for each in lab.folder.iterdir()} == before


def test_a_study_whose_database_cannot_be_opened_is_not_made(
    lab: Lab, grace: ResearchBrowser, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise InputError("the database cannot be opened")

    monkeypatch.setattr(links, "first_owner_link", fail)
    answer = grace.post(MAKE, template="pairwise", name="new", ethics="Kept words")
    assert answer.status_code == 422
    assert "Kept words" in answer.text
    assert not (lab.folder / "new").exists(), "its name stays free"
