"""What strangers store or ask for does no harm on researchers' pages."""

from __future__ import annotations

from studyapp.database.tables import FormAnswer, RefusalLine, StudySession
from studyapp.researchers.links import invite, join
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.studyapp.web.research.test_access import MAY, PLACE
from tests.studyapp.web.visitor import Visitor
from tests.support.researchers_at_hand import PASSWORD

SCRIPT = "<script>alert(1)</script>\"'><img src=x onerror=alert(1)>"


def test_a_script_that_somebody_stored_is_shown_as_text(log_in: LogIn) -> None:
    owner = log_in("owner")
    token = invite(log_in.stored, log_in.clock, role="viewer", by="Ada")
    join(log_in.stored, log_in.clock, token, name=SCRIPT, password=PASSWORD)
    Visitor(log_in.app, log_in.clock).enrol().begin()
    reason = {"reason": SCRIPT}
    owner.post("/research/study-sessions/1/exclusion", decision="exclude", **reason)
    owner.post("/research/newcomers/more", more="1", **reason)
    with log_in.stored.writing() as session:
        study_session = session.get_one(StudySession, 1)
        study_session.recruiter_participant = study_session.recruiter_study = SCRIPT
        session.add(
            RefusalLine(study_session_id=1, at=log_in.clock.now(), kind="odd", detail=SCRIPT)
        )
        session.add(
            FormAnswer(
                study_session_id=1,
                stage="closing",
                question="remarks",
                value=SCRIPT,
                answered_at=log_in.clock.now(),
            )
        )

    shown = set()
    pages = {PLACE.sub("1", rule) for method, rule in MAY if method == "GET"}
    for address in {*pages - VIDEOS_AND_FILES, *(f"/research/{odd}{SCRIPT}" for odd in ASKING)}:
        answer = owner.client.get(address, follow_redirects=True)
        assert answer.mimetype == "text/html", address
        page = PageReader(answer.text)
        assert "<script>alert" not in page.text, address
        assert "<img" not in page.text, address
        assert [tag for tag in page.soup.find_all("script") if not tag.get("src")] == [], address
        assert not [tag for tag in page.soup.find_all() for name in tag.attrs if name[:2] == "on"]
        if SCRIPT in page.soup.get_text():
            shown.add(address)
    stored_on = ("changes", "newcomers", "researchers", "study-sessions/1")
    assert {f"/research/{name}" for name in stored_on} <= shown


ASKING = ("", "study-sessions?arm=", "study-sessions?called=", "preview?arm=", "log-in?next=")

VIDEOS_AND_FILES = {
    "/research/preview/1/1/1/media/1.mp4",
    "/research/preview/1/1/1/static/1",
    "/research/study-sessions/1/1/1.mp4",
    "/research/rehearsal/study-sessions/1/1/1.mp4",
}

ODD = [
    "/research/../study.toml",
    "/research/%2e%2e/study.toml",
    "/research/..%2f..%2fetc/passwd",
    "/research/rehearsal/../../study.toml",
    "/research/study-sessions/../../responses.db",
    "/research/study-sessions/-1",
    "/research/study-sessions/99999999999999999999",
    "/research/study-sessions/1%00",
    "/research/study-sessions/2147483647",
    "/research/study-sessions?page=99999999999999999999&left_at=-1&standing=done&arm=%00",
    "/research/study-sessions?page=٣&failed=1e9&check=main&_external=1&_scheme=javascript",
    "/research/study-sessions?standing=nonsense",
    "/research/changes?before=0",
    "/research/changes?before=-1",
    "/research/join/..%2f..%2fstudy.toml",
    "/research/join/%00",
    "/research/log-in?next=%00",
    "/research/rehearsal/",
]


def test_odd_addresses_give_no_file_and_no_failure(log_in: LogIn) -> None:
    owner = log_in("owner")
    for address in ODD:
        answer = owner.client.get(address)

        assert answer.status_code in (200, 303, 404), address
        assert "[conditions" not in answer.text
        assert "javascript" not in answer.text
        assert "root:" not in answer.text
        assert "from flask" not in answer.text


def test_a_name_that_no_database_can_store_is_only_wrong(browser: ResearchBrowser) -> None:
    for name in ("a\ud800", "x" * 5000, "' OR 1=1 --"):
        sent = name.encode("utf-8", "surrogatepass")
        answer = browser.client.post(
            "/research/log-in",
            data={"form_code": browser.code(), "name": sent, "password": sent},
        )
        assert answer.status_code == 403
        assert "password or code is wrong" in answer.text


def test_a_rehearsal_has_no_pages_for_researchers(serve: Serve) -> None:
    answer = serve(rehearsal_speed=10.0).test_client().get("/research/log-in")

    assert answer.status_code == 404
