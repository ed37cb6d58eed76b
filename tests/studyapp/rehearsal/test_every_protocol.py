"""Whole rehearsals of every protocol, by page and by server."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import httpx
import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import Place, StudySession
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes, read_trial
from studyapp.rehearsal.pages import BrokenPageError
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.run import rehearse
from studyapp.rehearsal.simulation.judgement import judge
from studyapp.rehearsal.simulation.population import default_population
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.visit import InterruptedRehearsal
from studyapp.session.ending import is_excluded
from studyapp.study.design.trial import Answers
from studyapp.study.folder import StudyFolder
from tests.studyapp.rehearsal.protocol_studies import STUDIES, write_study
from tests.studyapp.rehearsal.steps import browser
from tests.support.studies.edited_study import edited
from tests.support.studies.finished_study import write_short_video
from tests.support.studies.stored import reading

Written = Callable[[str], StudyFolder]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    """Return a function that writes each study once."""
    root = tmp_path_factory.mktemp("protocols")
    write_short_video(root / "short.mp4", seconds=1.0)

    @cache
    def write(name: str) -> StudyFolder:
        return write_study(root / name.replace(" ", "-"), name, root / "short.mp4")

    return write


@pytest.fixture
def folder(request: pytest.FixtureRequest, written: Written, tmp_path: Path) -> StudyFolder:
    """A copy of one's own of the study that the test is about."""
    return StudyFolder(Path(shutil.copytree(written(request.param).root, tmp_path / "study")))


each_study = pytest.mark.parametrize("folder", STUDIES, indirect=True)


@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
@pytest.mark.parametrize(
    ("pattern", "spoilt", "problem"),
    [
        (r"/begin", "/begun", r"/begun.*status 404"),
        (r"<video(?!.*<video).*?</video>", "", "shows 1 video"),
        (r'src="/media/', 'src="/media/x', "a video that is not of this rehearsal"),
    ],
)
def test_a_spoilt_page_stops_the_participant(
    app: Flask, participant: Participant, pattern: str, spoilt: str, problem: str
) -> None:
    with (
        browser(app, lambda html: re.sub(pattern, spoilt, html, flags=re.S)) as client,
        pytest.raises(BrokenPageError, match=problem),
    ):
        participant.take_part(client)


@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
def test_a_page_that_only_leads_back_to_itself_is_left(participant: Participant) -> None:
    circle = "<h1>Start</h1><form method='post'><button>Go</button></form>"
    transport = httpx.MockTransport(lambda _: httpx.Response(200, html=circle))
    with (
        httpx.Client(transport=transport, base_url="http://study.test") as client,
        pytest.raises(BrokenPageError, match="'Start' comes back"),
    ):
        participant.take_part(client)


def require_stored_as_said(database: Database, participant: Participant) -> None:
    """Require that all pages were passed, and every trial is answered as its rater answers it."""
    with database.reading() as session:
        for study_session in session.scalars(select(StudySession)):
            assert study_session.sound_checked_at is not None
            assert study_session.rested_at_position is not None
            assert len(study_session.form_answers) == 6
            rater = Rater(
                population=participant.population,
                seed=participant.seed,
                name=f"{study_session.arm} {study_session.number}",
            )
            for trial in study_session.trials:
                said = judge(participant.study, rater, read_trial(trial)).values
                assert {(r.question, r.stimulus): r.value for r in trial.responses} == said


@each_study
def test_a_participant_passes_all_pages_and_what_it_says_is_stored(
    app: Flask, participant: Participant, eyes: Eyes
) -> None:
    with browser(app) as client:
        code = participant.take_part(client)
    with browser(app) as client:
        assert participant.take_part(client) == code
    require_stored_as_said(eyes.database, participant)


@pytest.mark.parametrize("folder", ["ratings", "rankings with ties"], indirect=True)
def test_who_was_stopped_halfway_comes_back_and_goes_on_with_the_same_answers(
    app: Flask, participant: Participant, eyes: Eyes, tmp_path: Path
) -> None:
    class StoppingLedger(Ledger):
        def answered(self, name: str, trial: str, values: Answers) -> None:
            participant.stop.set()

    stopped = replace(participant, ledger=StoppingLedger(tmp_path / "acknowledged.jsonl"))
    with browser(app) as client, pytest.raises(InterruptedRehearsal):
        stopped.take_part(client)
    participant.stop.clear()
    with browser(app) as client:
        assert participant.take_part(client)
    require_stored_as_said(eyes.database, participant)


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
def test_who_is_excluded_is_replaced_by_another_rater_where_the_study_says_so(
    folder: StudyFolder,
) -> None:
    with edited(folder.definition) as keys:
        keys["replace_excluded"] = True
        keys["attention"].update({"max_failed": 0})
    people = replace(default_population(folder.study()), kinds={"careless": 0.5}, overlooked=0.0)
    result = rehearse(folder, seed=2, population=people)
    with reading(folder.rehearsal) as session:
        study_sessions = session.scalars(select(StudySession)).all()
        excluded = sum(
            is_excluded(folder.study(), study_session) for study_session in study_sessions
        )
        assert excluded > 0
        assert result.completed == 3 + excluded
        holders = [place.study_session for place in session.scalars(select(Place))]
        assert len(holders) == 3
        assert not any(holder is None or is_excluded(folder.study(), holder) for holder in holders)
