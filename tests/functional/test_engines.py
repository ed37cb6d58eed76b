"""A participant's and a researcher's whole way in Firefox and WebKit, at two sizes of window.

``make engines`` runs these tests alone and keeps a screenshot of each page.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Response, WatchRecord
from tests.functional.engines import PROGRAMS, Window, missing, window
from tests.functional.joining import NAME, link_for_owner
from tests.functional.shown_studies import write_way
from tests.support.researcher_accounts import PASSWORD

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LAPTOP = (1366, 768)
NARROW = (500, 844)
"""The narrowest window that Firefox makes."""


@pytest.fixture(scope="module", params=PROGRAMS)
def engine(request: pytest.FixtureRequest) -> str:
    """Return the name of an engine that is installed."""
    name = str(request.param)
    if lacking := missing(name):
        pytest.skip(f"{', '.join(lacking)} is not installed: make setup-engines installs it")
    return name


@pytest.fixture(scope="module")
def study(engine: str, tiny_study_template: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study for each engine, with everything around its two trials."""
    folder = tmp_path_factory.mktemp(engine) / "study"
    write_way(folder, tiny_study_template, trials=1)
    return folder


@pytest.fixture(scope="module")
def seen(engine: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Window]:
    """Give a window of the engine, as large as a laptop's."""
    with window(engine, tmp_path_factory.mktemp(f"{engine}-profile")) as opened:
        opened.resize(*LAPTOP)
        yield opened


def look_at(seen: Window, name: str) -> None:
    """Take the page in a narrow window and a laptop's; nothing may be wider than the window."""
    seen.resize(*NARROW)
    seen.photograph(f"{name}-narrow")
    seen.wait("document.documentElement.scrollWidth <= innerWidth")
    seen.resize(*LAPTOP)
    seen.photograph(name)


def choose(seen: Window, answer: str) -> None:
    """Choose an answer by its value."""
    seen.click(f"label:has(input[value='{answer}'])")


def test_a_participant_completes_a_study(
    seen: Window, engine: str, address: str, database: Database
) -> None:
    seen.go(f"{address}/?PROLIFIC_PID={engine}&STUDY_ID=s1&SESSION_ID=x1")
    look_at(seen, f"{engine}-1-eligibility")
    choose(seen, "yes")
    seen.click("#eligibility .primary")
    seen.see("#start")
    choose(seen, "yes")
    look_at(seen, f"{engine}-2-consent")
    seen.click("#start .primary")

    seen.read("Can you hear this?")
    look_at(seen, f"{engine}-3-sound-check")
    seen.wait("document.querySelector('audio').duration > 0")
    query = select(StudySession).where(StudySession.recruiter_participant == engine)
    with database.reading() as session:
        digits = session.scalars(query).one().sound_digits
    seen.write("#digits", digits)
    seen.click("#sound-check .primary")

    seen.read("A few questions about you")
    seen.write("#form-age", "31")
    choose(seen, "3")
    look_at(seen, f"{engine}-4-questions")
    seen.click("form .primary")
    seen.read("What you will do")
    look_at(seen, f"{engine}-5-instructions")
    seen.click("form .primary")

    for number in (1, 2):
        take_trial(seen, engine, number)
    seen.read("A few last questions")
    seen.click("form .primary")

    seen.see("#completion-code")
    look_at(seen, f"{engine}-7-code")
    code = seen.run("return document.querySelector('#completion-code').innerText")
    with database.reading() as session:
        study_session = session.scalars(query).one()
        answers = session.scalars(select(Response)).all()
        watched = session.scalars(select(WatchRecord)).all()
        assert study_session.completion_code == code
        assert [answer.value for answer in answers] == [-1] * 4
        assert [len(record.intervals) for record in watched] == [1, 1]


def take_trial(seen: Window, engine: str, number: int) -> None:
    """Watch the trial's video to its end inside the page, answer and go on."""
    seen.wait(f"document.querySelector('.progress')?.innerText.includes('Trial {number} of 2')")
    look_at(seen, f"{engine}-6-trial-{number}")
    seen.click(".play")
    seen.wait("document.querySelector('video').ended")
    assert seen.run("return document.fullscreenElement") is None
    for question in ("rhythm", "emotion"):
        seen.click(f"[data-question={question}] label:has([value='-1'])")
    seen.wait("document.querySelector('#needed').classList.contains('complete')")
    look_at(seen, f"{engine}-6-trial-{number}-answered")
    seen.click("#next")


def test_a_researcher_logs_in_and_watches_a_study(
    seen: Window, engine: str, address: str, database: Database
) -> None:
    name = f"{NAME} of {engine}"
    seen.go(link_for_owner(address, database))
    seen.read("Join as an owner")
    seen.write("#name", name)
    for field in ("password", "again"):
        seen.write(f"[name={field}]", PASSWORD)
    seen.click("main .primary")
    seen.read("Progress")
    seen.click("header form button")

    seen.read("Log in as a researcher")
    seen.write("#name", name)
    seen.write("#password", PASSWORD)
    look_at(seen, f"{engine}-8-log-in")
    seen.click("main .primary")
    seen.read("Progress")

    links = "return [...document.querySelectorAll('header nav a')].map(link => link.href)"
    pages = seen.run(links)
    assert len(pages) == 8
    for number, page in enumerate(pages, start=1):
        seen.go(page)
        seen.see("h1")
        look_at(seen, f"{engine}-9-page-{number}")

    seen.go(f"{address}/research/preview")
    seen.click("tbody th a")
    seen.click(".play")
    seen.wait("document.querySelector('video').ended")
    look_at(seen, f"{engine}-9-previewed-trial")
