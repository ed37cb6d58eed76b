"""Simulated participants and real ones never meet, whoever counts, exports, backs up or pays."""

from __future__ import annotations

import shutil
import tarfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pandas as pd
import pytest
from click.testing import CliRunner
from flask import Flask
from sqlalchemy import func, select

from studyapp.cli.backup_command import command as backup_command
from studyapp.clock import Clock
from studyapp.database.engine import sqlite_url
from studyapp.database.tables import Response, StudySession
from studyapp.monitoring.study_sessions import progress_of_sessions
from studyapp.recruitment import prolific
from studyapp.recruitment.payment import known_participants
from studyapp.recruitment.prolific_client import ProlificClient
from studyapp.recruitment.record import RecruitmentRecord, write_record
from studyapp.rehearsal.record import Truth, write_truth
from studyapp.rehearsal.resumption import prepare
from studyapp.rehearsal.simulation.population import default_population
from studyapp.results.answers import answers_to_report, read_answers
from studyapp.results.export.writing import export
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder
from studyapp.web.app import create_app
from studyapp.web.site import EXTENSION
from tests.studyapp.recruitment.prolific_stand_in import TOKEN, StandIn, served
from tests.studyapp.rehearsal.steps import SPEED, browser, participant_of
from tests.support.studies.answered_study import answer_study
from tests.support.studies.stored import opened, reading

REAL = 2
TRIALS = 6
QUESTIONS = 2


PERSON = "p1"


@pytest.fixture(autouse=True)
def at_home(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)


@pytest.fixture(scope="module")
def rehearsed_once(rendered: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study that two real people have taken part in, rehearsed by one while it is served."""
    folder = StudyFolder(shutil.copytree(rendered, tmp_path_factory.mktemp("apart") / "study"))
    answer_study(folder.root, people=REAL)
    people = default_population(folder.study())
    write_truth(folder.rehearsal_truth, Truth(seed=1, study="", population=people, expected=()))
    before = rows(folder.responses)
    with (
        application(folder, None) as real,
        application(folder, SPEED) as app,
        opened(folder.rehearsal) as database,
        browser(real) as person,
        browser(app) as client,
    ):
        simulated = participant_of(folder, database, PERSON)
        assert person.get("/").status_code == 200
        assert simulated.take_part(client)
        assert person.get("/").status_code == 200
    assert rows(folder.responses) == before == (REAL, REAL * TRIALS * QUESTIONS)
    assert rows(folder.rehearsal) == (1, TRIALS * QUESTIONS)
    return folder.root


@contextmanager
def application(folder: StudyFolder, speed: float | None) -> Iterator[Flask]:
    made = create_app(folder.root, rehearsal_speed=speed)
    with closing(made.extensions[EXTENSION].database):
        yield made


@pytest.fixture
def rehearsed(rehearsed_once: Path, tmp_path: Path) -> StudyFolder:
    """A copy of it of one's own."""
    return StudyFolder(shutil.copytree(rehearsed_once, tmp_path / "study"))


def rows(path: Path) -> tuple[int, int]:
    """Return how many study sessions and answers a database holds."""
    with reading(path) as session:
        people = session.scalar(select(func.count()).select_from(StudySession))
        answers = session.scalar(select(func.count()).select_from(Response))
        return people or 0, answers or 0


def counted_live(folder: StudyFolder) -> int:
    served = ServedStudy.read(folder.root)
    with reading(folder.responses) as session:
        return len(progress_of_sessions(session, served, Clock().now()))


def reported(folder: StudyFolder) -> int:
    answers = answers_to_report(folder)
    assert answers.origin == "participants"
    assert answers.stored is not None
    return len(answers.stored.study_sessions)


def exported(folder: StudyFolder) -> int:
    export(folder, folder.root / "out.csv", rehearsal=False)
    return int(pd.read_csv(folder.root / "out.csv")["study_session"].nunique())


def backed_up(folder: StudyFolder) -> int:
    archive = folder.root.parent / "backup.tar"
    done = CliRunner().invoke(
        backup_command, [str(folder.root), str(archive)], catch_exceptions=False
    )
    assert f"Backed up {REAL} participants" in done.output
    with tarfile.open(archive) as tar:
        assert not [name for name in tar.getnames() if "rehears" in name]
    return REAL


def answered_under_another_address(folder: StudyFolder) -> int:
    """Count what a report finds where the environment names a database."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DATABASE_URL", sqlite_url(folder.responses))
        assert read_answers(folder, "rehearsal").stored is not None
        return reported(folder)


def test_only_real_people_are_counted(rehearsed: StudyFolder) -> None:
    for count in (counted_live, reported, exported, backed_up, answered_under_another_address):
        assert count(rehearsed) == REAL, count.__name__
        assert rows(rehearsed.rehearsal) == (1, TRIALS * QUESTIONS)


def known_to_recruiters(database: Path) -> list[str]:
    """Return as whom payment would know each participant of a database."""
    with opened(database) as there:
        return [each.study_status for each in known_participants(there)]


def test_nobody_is_paid_at_prolific_for_what_was_rehearsed(
    rehearsed: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert known_to_recruiters(rehearsed.rehearsal) == ["completed"]
    write_record(rehearsed.root, RecruitmentRecord(prolific_study="s1"))
    study = {"id": "s1", "status": "ACTIVE"}
    with served(StandIn(studies={"s1": study})) as site:
        monkeypatch.setattr("studyapp.recruitment.prolific_client.API", site.address)
        site.add_submission(PERSON, "AWAITING REVIEW", "KX7QM2PWTR")
        site.add_submission("timed-out", "TIMED-OUT", None)
        with ProlificClient(TOKEN) as client:
            found = prolific.status(rehearsed, client)
            assert prolific.approve(client, found) == 0

        first, _ = found.submissions
        assert (first.study_status, first.decision.verdict) == ("nobody", "look")
        assert found.missing_there == ()
        assert site.submissions[0]["status"] == "AWAITING REVIEW"
        assert all(asked.startswith("GET ") for asked in site.asked)


def test_rehearsing_anew_removes_simulated_answers_alone(rehearsed: StudyFolder) -> None:
    before = rehearsed.responses.read_bytes()
    prepare(rehearsed, seed=7)
    assert not rehearsed.rehearsal.exists()
    assert rehearsed.responses.read_bytes() == before
    assert reported(rehearsed) == REAL


def test_nobody_simulated_is_known_to_the_study_itself(
    rehearsed: StudyFolder,
) -> None:
    with reading(rehearsed.rehearsal) as session:
        token = session.scalars(select(StudySession.token)).one()
    entrance = f"/?PROLIFIC_PID={PERSON}&STUDY_ID=rehearsal&SESSION_ID={PERSON}"
    with application(rehearsed, None) as real, browser(real) as person:
        assert "completion-code" not in person.get(entrance).text
        assert person.get(f"/take/{token}").status_code == 404
