"""Whole rehearsals of every protocol, by page and by server."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables import Place, StudySession
from studyapp.rehearsal.examiner import Examiner
from studyapp.rehearsal.eyes import Eyes, seen
from studyapp.rehearsal.late_probes import probe_finished
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.participant import Participant, answer_trial
from studyapp.rehearsal.probes import probe_trial
from studyapp.rehearsal.run import rehearse
from studyapp.rehearsal.simulation.judgement import Judgement, judge
from studyapp.rehearsal.simulation.population import default_population
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.visit import InterruptedRehearsal, Visit
from studyapp.session.exclusion import is_excluded
from studyapp.study.folder import StudyFolder
from tests.finished_study import write_short_video
from tests.studyapp.rehearsal.protocol_studies import STUDIES, write_study
from tests.studyapp.rehearsal.steps import at_first_trial, browser

Written = Callable[[str], StudyFolder]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    """Return a function that writes each study once."""
    root = tmp_path_factory.mktemp("protocols")
    write_short_video(root / "short.mp4", seconds=1.0)
    known: dict[str, StudyFolder] = {}

    def get(name: str) -> StudyFolder:
        if name not in known:
            known[name] = write_study(root / name.replace(" ", "-"), name, root / "short.mp4")
        return known[name]

    return get


@pytest.fixture
def folder(request: pytest.FixtureRequest, written: Written, tmp_path: Path) -> StudyFolder:
    """A copy of one's own of the study that the test is about."""
    return StudyFolder(Path(shutil.copytree(written(request.param).root, tmp_path / "study")))


each_study = pytest.mark.parametrize("folder", STUDIES, indirect=True)


@each_study
def test_bad_submissions_are_refused_and_the_good_answers_are_stored(
    app: Flask, folder: StudyFolder, participant: Participant, eyes: Eyes
) -> None:
    with browser(app) as client:
        visit, page = at_first_trial(client, participant)
        judgement = participant.judge(page)
        following, probes = probe_trial(visit, page, judgement, study=folder.study(), eyes=eyes)
    tried = {probe.name: probe.status for probe in probes}
    assert tried["the same answers twice"] == 200
    assert tried["other answers to an answered trial"] == 409
    assert tried["somebody else's trial"] == 403
    assert tried["trouble with somebody else's trial"] == 403
    assert tried["the trial that comes later"] in {409, 422}
    assert tried["playing reported of nobody's video"] == 403
    assert tried["playing reported backwards"] == 422
    assert tried["trouble with somebody else's video"] == 422
    assert {status for name, status in tried.items() if name.startswith(("a ", "ques"))} == {422}
    assert {(question, number): value for _, question, number, value, _ in eyes.stored(page)} == (
        judgement.values
    )
    assert following.heading != page.heading


@pytest.mark.parametrize("folder", ["ratings", "rankings"], indirect=True)
def test_a_server_that_takes_bad_answers_is_found_out(
    app: Flask, folder: StudyFolder, participant: Participant, eyes: Eyes
) -> None:
    """Played as having been watched already, a trial is answered by what should be refused."""
    with browser(app) as client:
        visit, page = at_first_trial(client, participant)
        visit.watch(page)
        with pytest.raises(BrokenPageError, match="before the videos were watched, and stored it"):
            probe_trial(visit, page, participant.judge(page), study=folder.study(), eyes=eyes)


@pytest.mark.parametrize("folder", ["rankings"], indirect=True)
def test_a_page_that_does_not_let_a_video_be_said_not_to_play_is_found_out(
    app: Flask, folder: StudyFolder, participant: Participant, eyes: Eyes
) -> None:
    with browser(app, lambda html: html.replace('name="video"', "")) as client:
        visit, page = at_first_trial(client, participant)
        with pytest.raises(BrokenPageError, match="does not let each of its videos"):
            probe_trial(visit, page, participant.judge(page), study=folder.study(), eyes=eyes)


@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
def test_bad_submissions_of_every_kind_of_page_are_refused(
    app: Flask, folder: StudyFolder, participant: Participant, eyes: Eyes
) -> None:
    examiner = Examiner(name=participant.name, study=folder.study(), eyes=eyes)
    with browser(app) as client:
        assert replace(participant, answer=examiner.answer, fill=examiner.fill).take_part(client)
    tried = {probe.name: probe.status for probe in examiner.probes}
    assert examiner.examined == {"fit", "realism"}
    for name, status in {
        "no answer to the question 'adult'": 422,
        "an answer that excludes to the question 'adult'": 403,
        "an answer that excludes to the question 'watched'": 403,
        "too high a number to the question 'age'": 422,
        "too long an answer to the question 'work'": 422,
        "an answer that is not offered to the question 'ease'": 422,
        "digits that were not spoken": 422,
        "no digits": 422,
    }.items():
        assert tried[name] == status
    assert "no answer to the question 'work'" not in tried
    assert eyes.told(participant.name) == (1, 5)


@pytest.mark.parametrize("folder", ["ratings", "rankings"], indirect=True)
def test_after_the_end_and_in_anothers_name_nothing_is_taken(
    app: Flask, folder: StudyFolder, participant: Participant, eyes: Eyes
) -> None:
    with browser(app) as client:
        assert probe_finished(client, folder.study(), eyes) == ()
        participant.take_part(client)
        alone = probe_finished(client, folder.study(), eyes)
        replace(participant, name="p2").take_part(client)
        together = probe_finished(client, folder.study(), eyes)
    assert {probe.name: probe.status for probe in alone} == {
        "the last answers again after the end": 200,
        "other answers after the end": 409,
        "trouble after the end": 409,
        "playing reported after the end": 409,
        "beginning after the end": 200,
        "withdrawing after the end": 409,
        "answers of nobody": 404,
    }
    of_others = {probe.name: probe.status for probe in together[len(alone) :]}
    assert of_others == {
        "answers at another's address": 403,
        "answers to another's trial": 403,
        "trouble with another's video": 409,
        "playing reported of another's video": 403,
    }


@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
def test_a_page_with_a_video_too_few_stops_the_participant(
    app: Flask, participant: Participant
) -> None:
    def shortened(html: str) -> str:
        first, found, last = html.rpartition("<video")
        return first + last.partition("</video>")[2] if found else html

    with (
        browser(app, shortened) as client,
        pytest.raises(BrokenPageError, match="shows 1 video"),
    ):
        participant.take_part(client)


def require_stored_as_said(database: Database, participant: Participant) -> None:
    """Require that all pages were passed, and every trial is answered as its rater answers it."""
    with database.reading() as session:
        for sitting in session.scalars(select(StudySession)):
            assert sitting.sound_checked_at is not None
            assert sitting.rested_at_position is not None
            assert len(sitting.form_answers) == 5
            rater = Rater(
                population=participant.population,
                seed=participant.seed,
                name=f"{sitting.arm} {sitting.number}",
            )
            for trial in sitting.trials:
                said = judge(participant.study, rater, seen(trial)).values
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
    app: Flask, participant: Participant, eyes: Eyes
) -> None:
    def stopping(visit: Visit, page: Page, judgement: Judgement) -> Page:
        following = answer_trial(visit, page, judgement)
        participant.stop.set()
        return following

    with browser(app) as client, pytest.raises(InterruptedRehearsal):
        replace(participant, answer=stopping).take_part(client)
    participant.stop.clear()
    with browser(app) as client:
        assert participant.take_part(client)
    require_stored_as_said(eyes.database, participant)


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["rankings with ties"], indirect=True)
def test_a_rehearsal_stores_what_its_raters_say(
    folder: StudyFolder, participant: Participant
) -> None:
    result = rehearse(folder, participants=2, seed=1, workers=2, population=participant.population)
    assert (result.completed, result.kept) == (2, 0)
    with closing(Database.open(sqlite_url(folder.rehearsal))) as database:
        require_stored_as_said(database, participant)


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
def test_who_is_excluded_is_replaced_by_another_rater_where_the_study_says_so(
    folder: StudyFolder,
) -> None:
    text = folder.definition.read_text("utf-8")
    strict = text.replace(
        "attention = { trials = 1 }",
        "attention = { trials = 1, max_failed = 0 }\nreplace_excluded = true",
    )
    folder.definition.write_text(strict, "utf-8")
    people = replace(default_population(folder.study()), kinds={"careless": 0.5}, overlooked=0.0)
    result = rehearse(folder, seed=2, population=people)
    with (
        closing(Database.open(sqlite_url(folder.rehearsal))) as database,
        database.reading() as session,
    ):
        sittings = session.scalars(select(StudySession)).all()
        excluded = sum(is_excluded(folder.study(), sitting) for sitting in sittings)
        assert excluded > 0
        assert result.completed == 3 + excluded
        holders = [place.study_session for place in session.scalars(select(Place))]
        assert len(holders) == 3
        assert not any(holder is None or is_excluded(folder.study(), holder) for holder in holders)
