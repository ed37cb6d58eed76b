"""Whole rehearsals of every protocol, by page and by server."""

import re
import shutil
import socket
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path

import httpx
import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables.study_session import StudySession
from studyapp.rehearsal.eyes import Eyes, read_sight
from studyapp.rehearsal.pages import BrokenPageError
from studyapp.rehearsal.participant import Participant, study_client
from studyapp.rehearsal.simulation.raters import Rater, judge
from studyapp.study.folder import StudyFolder
from tests.studyapp.rehearsal.protocol_studies import STUDIES, write_study
from tests.studyapp.rehearsal.steps import browser
from tests.support.studies.finished_study import write_short_video

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
        (r"/begin", "/begun", r"/begun.*status 405"),
        (r"<video(?!.*<video).*?</video>", "", "does not show the videos of one trial"),
        (r'src="/media/', 'src="/media/x', "does not show the videos of one trial"),
    ],
)
def test_a_broken_page_stops_the_simulated_participant(
    app: Flask, participant: Participant, pattern: str, spoilt: str, problem: str
) -> None:
    with (
        browser(app, lambda html: re.sub(pattern, spoilt, html, flags=re.S)) as client,
        pytest.raises(BrokenPageError, match=problem),
    ):
        participant.take_part(client)


@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
def test_a_page_that_only_links_to_itself_is_left(participant: Participant) -> None:
    circle = "<h1>Start</h1><form method='post'><button>Go</button></form>"
    transport = httpx.MockTransport(lambda _: httpx.Response(200, html=circle))
    with (
        httpx.Client(transport=transport, base_url="http://study.test") as client,
        pytest.raises(BrokenPageError, match="'Start' comes back"),
    ):
        participant.take_part(client)


@each_study
def test_a_simulated_participant_completes_all_pages_and_its_answers_are_stored(
    app: Flask, participant: Participant, eyes: Eyes
) -> None:
    with browser(app) as client:
        code = participant.take_part(client)
    with browser(app) as client:
        assert participant.take_part(client) == code
    with eyes.database.reading() as session:
        study_session = session.scalars(select(StudySession)).one()
        assert study_session.sound_checked_at is not None
        assert study_session.rested_at_position is not None
        assert len(study_session.form_answers) == 6
        name = f"{study_session.arm} {study_session.number}"
        rater = Rater(population=participant.population, seed=participant.seed, name=name)
        for trial in study_session.trials:
            said = judge(participant.study, rater, read_sight(session, trial)).values
            assert {(r.question, r.stimulus): r.value for r in trial.responses} == said


REQUESTS = 3


def test_a_connection_closed_between_requests_loses_no_request() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(60)

        def serve() -> None:
            """Serve one request of each connection, and close it on the second one."""
            for _ in range(REQUESTS):
                connection, _address = listener.accept()
                with connection:
                    connection.recv(65536)
                    connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nyes")
                    connection.recv(65536)

        threading.Thread(target=serve, daemon=True).start()
        with study_client(f"http://127.0.0.1:{listener.getsockname()[1]}") as client:
            assert [client.get("/").status_code for _ in range(REQUESTS)] == [200] * REQUESTS
