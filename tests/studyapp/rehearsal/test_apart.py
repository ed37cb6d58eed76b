"""Simulated participants and real ones never meet, whoever serves, reports, backs up or pays."""

import shutil
import zipfile
from pathlib import Path

import pytest
from sqlalchemy import func, select

from studyapp.database.engine import sqlite_url
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Response
from studyapp.recruitment import prolific
from studyapp.recruitment.payment import known_participants
from studyapp.recruitment.prolific_client import ProlificClient
from studyapp.recruitment.record import RecruitmentRecord, write_record
from studyapp.rehearsal.resumption import prepare
from studyapp.results.answers import read_answers
from studyapp.study.folder import StudyFolder
from tests.studyapp.recruitment.prolific_stand_in import TOKEN, StandIn, served
from tests.studyapp.rehearsal.steps import SPEED, application, browser, participant_of
from tests.support.command_line import run
from tests.support.studies.answered_study import answer_study
from tests.support.studies.stored import opened, reading

REAL = 2
TRIALS = 6
QUESTIONS = 2
PERSON = "p1"


def rows(path: Path) -> tuple[int, ...]:
    """Return how many study sessions and answers a database holds."""
    with reading(path) as session:
        return tuple(
            session.scalar(select(func.count()).select_from(table)) or 0
            for table in (StudySession, Response)
        )


@pytest.fixture(scope="module")
def rehearsed_once(rendered: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study that two real people have taken part in, rehearsed by one while it is served."""
    folder = StudyFolder(shutil.copytree(rendered, tmp_path_factory.mktemp("apart") / "study"))
    answer_study(folder.root, people=REAL)
    before = rows(folder.responses)
    prepare(folder, seed=1)
    with (
        application(folder, None) as real,
        application(folder, SPEED) as app,
        opened(folder.rehearsal) as database,
        browser(real) as person,
        browser(app) as client,
    ):
        assert person.get("/").status_code == 200
        assert participant_of(folder, database, PERSON).take_part(client)
        assert person.get("/").status_code == 200
    assert rows(folder.responses) == before == (REAL, REAL * TRIALS * QUESTIONS)
    assert rows(folder.rehearsal) == (1, TRIALS * QUESTIONS)
    return folder.root


@pytest.fixture
def rehearsed(rehearsed_once: Path, tmp_path: Path) -> StudyFolder:
    """A copy of it of one's own."""
    return StudyFolder(shutil.copytree(rehearsed_once, tmp_path / "study"))


def test_backups_reports_and_exports_know_only_real_people(
    rehearsed: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    archive = rehearsed.root.parent / "backup.zip"
    assert f"Backed up {REAL} participants" in run("backup", rehearsed.root, archive)
    with zipfile.ZipFile(archive) as members:
        assert not [name for name in members.namelist() if "rehears" in name]
    monkeypatch.setenv("DATABASE_URL", sqlite_url(rehearsed.responses))
    for stored, people in (
        (read_answers(rehearsed, "participants").stored, REAL),
        (read_answers(rehearsed, "rehearsal").stored, 1),
    ):
        assert stored is not None and len(stored.study_sessions) == people


def test_rehearsals_pay_nobody(rehearsed: StudyFolder) -> None:
    with opened(rehearsed.rehearsal) as database:
        assert [each.study_status for each in known_participants(database)] == ["completed"]
    write_record(rehearsed.root, RecruitmentRecord(prolific_study="s1"))
    with served(StandIn(studies={"s1": {"id": "s1", "status": "ACTIVE"}})) as site:
        site.add_submission(PERSON, "AWAITING REVIEW", "KX7QM2PWTR")
        with ProlificClient(TOKEN, address=site.address) as client:
            status = prolific.status(rehearsed, client)
            assert prolific.approve(client, status) == 0

    (submission,) = status.submissions
    assert (submission.study_status, submission.decision.verdict) == ("nobody", "look")
    assert all(asked.startswith("GET ") for asked in site.asked)


def test_simulated_participants_are_unknown_to_the_real_study(rehearsed: StudyFolder) -> None:
    with reading(rehearsed.rehearsal) as session:
        token = session.scalars(select(StudySession.token)).one()
    entrance = f"/?PROLIFIC_PID={PERSON}&STUDY_ID=rehearsal&SESSION_ID={PERSON}"
    with application(rehearsed, None) as real, browser(real) as person:
        assert "completion-code" not in person.get(entrance).text
        assert person.get(f"/take/{token}").status_code == 404
