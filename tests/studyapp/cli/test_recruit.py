"""`motionjury recruit`, with a server that stands in for Prolific."""

import csv
import shutil
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from studyapp.preflight.recruiting_checks import prolific_code_findings
from studyapp.session.enrolment import Arrival
from studyapp.study.folder import StudyFolder
from tests.studyapp.recruitment.prolific_stand_in import TOKEN, StandIn, served
from tests.support.command_line import run
from tests.support.studies.redefining import redefine
from tests.support.studies.taking_part_steps import taking_part

ADDRESS = "https://study.example.org/"


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> Iterator[StandIn]:
    monkeypatch.setenv("PROLIFIC_TOKEN", TOKEN)
    with served(StandIn()) as running:
        monkeypatch.setattr("studyapp.recruitment.prolific_client.API", running.address)
        yield running


@pytest.fixture
def folder(tiny_study: Path) -> Path:
    """Return a study on Prolific that has drawn its codes."""
    more = '\n[recruitment]\nchannel = "prolific"\n[recruitment.prolific]\nreward = 150\n'
    redefine(tiny_study, added=more)
    _, *codes = recruit(tiny_study, "codes").splitlines()
    redefine(tiny_study, added="\n".join(codes))
    return tiny_study


def recruit(folder: Path, *arguments: str, status: int = 0) -> str:
    output = run("recruit", folder, *arguments, status=status)
    assert TOKEN not in output
    return output


def test_a_study_is_made_once_after_yes_and_published_paused_and_stopped(
    folder: Path, stand_in: StandIn
) -> None:
    shown = recruit(folder, "create", "--address", ADDRESS)
    assert "9.00 per hour" in shown
    assert "Warning: the currency of the Prolific account is not given" in shown
    assert "Nothing was sent" in shown
    assert stand_in.asked == []
    create = ("create", "--address", ADDRESS, "--yes")
    assert "Created the draft" in recruit(folder, *create)
    assert "already exists on Prolific" in recruit(folder, *create)
    # Prolific only knows the codes that the study was made with.
    assert "on Prolific already" in recruit(folder, "codes", status=1)
    (folder / "recruitment.json").unlink()
    assert "already exists on Prolific" in recruit(folder, *create)
    assert len(stand_in.studies) == 1
    assert "Nothing was published" in recruit(folder, "publish")
    assert "active" in recruit(folder, "publish", "--yes")
    assert "paused" in recruit(folder, "pause")
    assert "active" in recruit(folder, "resume")
    assert "awaiting review" in recruit(folder, "stop")
    other = recruit(folder, "invite", "--list", __file__, "--address", ADDRESS, status=1)
    assert "'prolific', but this command is for 'invitations'" in other


def test_decisions_about_pay_are_shown_before_anybody_is_paid(
    folder: Path, stand_in: StandIn
) -> None:
    recruit(folder, "create", "--address", ADDRESS, "--yes")
    database = StudyFolder(folder).responses
    assert not database.exists()
    assert "Prolific: unpublished, 0 of" in recruit(folder, "status")
    assert "0 to pay" in recruit(folder, "approve", "--yes")
    code = StudyFolder(folder).study().recruitment.prolific.completed
    with taking_part(folder) as ann:
        ann.another().arrive(Arrival(recruiter_participant="bob"))
        ann.arrive(Arrival(recruiter_participant="ann")).begin().take_all()
    elsewhere = database.rename(folder / "elsewhere.db")
    stand_in.add_submission("ann", "AWAITING REVIEW", code)
    for command in ("status", "approve"):
        # Otherwise nobody would seem to have taken part.
        assert "set it here as well" in recruit(folder, command, status=1)
    elsewhere.rename(database)
    stand_in.add_submission("bob", "AWAITING REVIEW", code)
    stand_in.add_submission("eve", "TIMED-OUT", None)

    shown = recruit(folder, "approve")

    assert "1 to pay, 1 for you to decide, 0 under way, 1 settled" in shown
    assert "did not finish here, but entered the code for finishing" in shown
    assert "Nothing was paid" in shown
    assert not any("bulk-approve" in each for each in stand_in.asked)
    assert "Approved 1 " in recruit(folder, "approve", "--yes")
    assert [each["status"] for each in stand_in.submissions] == [
        "APPROVED",
        "AWAITING REVIEW",
        "TIMED-OUT",
    ]
    counts = recruit(folder, "status")
    assert "awaiting review  unfinished    1" in counts
    asked = recruit(folder, "return", "submission-bob", "other", "--reason", "You did not finish.")
    assert "submission-bob: return requested" in asked
    assert "other: not a submission of this study" in asked
    assert stand_in.returns == {"submission-bob": ["You did not finish."]}


def test_each_person_on_a_list_is_invited_once_and_only_its_owner_reads_the_table(
    tiny_study: Path,
) -> None:
    redefine(tiny_study, added='[recruitment]\nchannel = "invitations"\n')
    assert not StudyFolder(tiny_study).responses.exists()
    assert "0 invitations: 0 begun" in recruit(tiny_study, "status")
    people = tiny_study / "people.csv"
    people.write_text("who,note\nann@x.org,a\nbob@x.org,b\n\nann@x.org,again\n", "utf-8")
    address = ("--address", ADDRESS)

    assert "Added 2 links" in recruit(tiny_study, "invite", "--list", str(people), *address)
    assert "Added 0 links" in recruit(tiny_study, "invite", "--list", str(people), *address)

    table = tiny_study / "invitations.csv"
    assert table.stat().st_mode & 0o777 == 0o600
    rows = list(csv.DictReader(table.read_text("utf-8").splitlines()))
    assert [row["for"] for row in rows] == ["ann@x.org", "bob@x.org"]
    assert len({row["link"] for row in rows}) == 2
    assert all(row["link"].startswith(f"{ADDRESS}?invitation=") for row in rows)
    assert "2 invitations: 0 begun" in recruit(tiny_study, "status")
    links = table.rename(tiny_study / "links.csv")
    shutil.copyfile(people, table)
    other = ("--list", str(people), *address)
    assert "not a table of invitations" in recruit(tiny_study, "invite", *other, status=1)
    assert table.read_bytes() == people.read_bytes()
    links.replace(table)
    nowhere = ("--list", str(people), "--address", "")
    assert "not the address of a study" in recruit(tiny_study, "invite", *nowhere, status=1)


def test_a_code_that_differs_from_prolifics_is_found(folder: Path, stand_in: StandIn) -> None:
    def problems() -> dict[str, str]:
        study = StudyFolder(folder).study()
        findings = prolific_code_findings(study, folder)
        return {finding.name: finding.what for finding in findings}

    path = folder / "study.toml"
    as_told = path.read_text("utf-8")
    assert problems() == {}
    recruit(folder, "create", "--address", ADDRESS, "--yes")
    assert problems() == {}

    code = tomllib.loads(as_told)["recruitment"]["prolific"]["screened_out"]
    path.write_text(as_told.replace(code, "HB4NVJ9ZCDQW"), "utf-8")
    assert problems()["codes-differ"].endswith(" has for screened_out")
    recruit(folder, "create", "--address", ADDRESS, "--yes")
    assert list(problems()) == ["codes-differ"]

    path.write_text(as_told, "utf-8")
    (folder / "recruitment.json").write_text("{", "utf-8")
    assert list(problems()) == ["made-there-unreadable"]
