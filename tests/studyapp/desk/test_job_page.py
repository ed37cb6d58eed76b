"""Rights to run and see jobs at the desk, and to download their results."""

import io
from datetime import UTC, datetime
from zipfile import ZipFile

import pytest

from studyapp.desk.job_kinds import RUN, SHARED, TAKE_HOME
from studyapp.desk.jobs import Job
from studyapp.desk.lab import LabStudy
from studyapp.researchers.audit import latest_looks
from tests.studyapp.desk.conftest import Joined, changes
from tests.studyapp.desk.job_watching import SLOW, begin, wait_until_ended
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.studies.answered_study import answer_study
from tests.support.studies.redefining import redefine

TINY = "/research/studies/tiny/"
JOBS = f"{TINY}jobs/"


def write_earlier_results(tiny: LabStudy) -> None:
    """Leave a report and an archive of answers, as earlier jobs would."""
    report = tiny.folder.report
    (report / "tables").mkdir(parents=True)
    (report / "report.html").write_text("<script>document.title</script>")
    (report / "tables" / "answers.csv").write_text("a,b\n")
    own = tiny.folder.jobs / "tables"
    own.mkdir(parents=True)
    began_at = datetime(2026, 5, 4, tzinfo=UTC)
    job = Job(kind="tables", command=("export",), by="Ada", began_at=began_at, status=0)
    job.model_copy(update={"packed": "jobs/tables/answers"}).write(own)
    (own / "answers.zip").write_bytes(b"PK")


def test_a_job_is_run_watched_and_logged(tiny: LabStudy, ada: ResearchBrowser) -> None:
    assert "It has not been run yet" in ada.get(f"{JOBS}check").text
    answer = ada.post(f"{JOBS}check")
    assert (answer.status_code, answer.headers["Location"]) == (303, f"{JOBS}check")
    page = ada.get(f"{JOBS}check")
    assert "started by Ada" in page.text or "failed" in page.text
    standing = wait_until_ended(tiny.folder.jobs, "check")
    # The videos of this study differ in size, which is an error.
    assert standing.state == "failed"
    page = ada.get(f"{JOBS}check")
    assert "must be fixed before participants can take part" in page.soup.select("pre")[0].text
    assert page.soup.select("#live")[0]["data-seconds"] == "0"
    assert str(tiny.folder.root) not in page.text
    assert ("Ada", "job started", "Check") in changes(tiny)
    assert "Run again" in ada.get(TINY).text


def test_a_running_job_blocks_others_and_can_be_stopped_by_any_manager(
    tiny: LabStudy, ada: ResearchBrowser, joined: Joined
) -> None:
    analyst = joined("analyst")
    begin(tiny.folder.jobs, *SLOW, kind="rehearse")
    page = ada.get(TINY)
    assert "started by Ada" in page.text
    assert not [each for each in page.soup.select("form") if "/jobs/" in str(each["action"])]
    refused = ada.post(f"{JOBS}check")
    assert refused.status_code == 409
    assert "Another job of this study is running" in refused.text
    assert analyst.post(f"{JOBS}rehearse/stop").status_code == 303
    assert wait_until_ended(tiny.folder.jobs, "rehearse").job.stopped_by == "Some analyst"
    assert ("Some analyst", "job stopped", "Rehearse") in changes(tiny)
    assert ada.post(f"{JOBS}rehearse/stop").status_code == 409
    assert "Resume" in ada.get(f"{JOBS}rehearse").text


def test_viewers_see_jobs_and_run_none(
    tiny: LabStudy, ada: ResearchBrowser, joined: Joined
) -> None:
    write_earlier_results(tiny)
    viewer = joined("viewer")
    page = viewer.get(TINY)
    assert "Rehearse" in page.text
    assert "Take home" not in page.text
    for kind in RUN:
        assert not viewer.get(f"{JOBS}{kind.name}").soup.select("main form")
    for each in TAKE_HOME:
        assert "not for your role" in viewer.get(f"{JOBS}{each.name}", 403).text
    viewer.get(f"{JOBS}report/files/report.html", 403)
    viewer.get(f"{JOBS}tables/archive", 403)


def test_only_listed_commands_run_and_only_listed_files_are_sent(
    tiny: LabStudy, ada: ResearchBrowser
) -> None:
    write_earlier_results(tiny)
    for address in (
        "forget",
        "check/files/study.toml",
        "check/files/../study.toml",
        "report/files/../study.toml",
        "report/files/%2e%2e/responses.db",
        "report/files/tables",
        "report/archive",
        "figure/files/.hidden",
    ):
        ada.get(f"{JOBS}{address}", 404)
    assert ada.post(f"{JOBS}forget").status_code == 404
    assert ada.post(f"{JOBS}figure", figure="strip", segment="../x").status_code == 409
    assert ada.post(f"{JOBS}rehearse", participants="-1").status_code == 409
    assert not [event for _, event, _ in changes(tiny) if event == "job started"]


def test_a_figure_is_offered_only_where_there_is_motion_to_draw(
    tiny: LabStudy, ada: ResearchBrowser
) -> None:
    assert ada.get(f"{JOBS}figure").soup.select("form[action$=figure]")
    redefine(
        tiny.folder.root,
        ("[conditions.rule_based]", "[conditions.rule_based]\nvideos = true"),
        ("[conditions.mismatched]", "[conditions.mismatched]\nvideos = true"),
        ('generator = "broken"', "videos = true"),
    )
    page = ada.get(f"{JOBS}figure")
    assert "There is no motion to draw" in page.text
    assert not page.soup.select("form[action$=figure]")


def test_a_report_is_shown_in_a_sandbox(tiny: LabStudy, ada: ResearchBrowser) -> None:
    write_earlier_results(tiny)
    with ada.client.get(f"{JOBS}report/files/report.html") as shown:
        policy = shown.headers["Content-Security-Policy"]
        assert policy.startswith("sandbox allow-scripts")
        assert "allow-same-origin" not in policy
        assert "'self'" not in policy
        assert "attachment" not in shown.headers["Content-Disposition"]
    with ada.client.get(f"{JOBS}report/files/tables/answers.csv") as table:
        assert table.headers["Content-Disposition"].startswith("attachment")
        assert table.headers["Cache-Control"] == "no-store"
    assert ("Ada", "downloaded", "Report: tables/answers.csv") in changes(tiny)


def test_answers_before_the_end_require_a_reason(tiny: LabStudy, ada: ResearchBrowser) -> None:
    write_earlier_results(tiny)
    answer_study(tiny.folder.root, people=2)
    page = ada.get(TINY)
    assert "you must give a reason, which is logged" in page.text
    assert not page.soup.select("[action$='jobs/report']")
    assert "Figure for a paper" in page.text, "it shows no answers"
    for address in ("report/files/report.html", "tables/archive"):
        refused = ada.client.get(JOBS + address)
        assert refused.status_code == 409
        assert "sandbox" not in refused.headers["Content-Security-Policy"], "the page has a style"
    for kind in ("report", "tables", "share"):
        assert ada.post(JOBS + kind).status_code == 409
    assert not [event for _, event, _ in changes(tiny) if event in ("job started", "downloaded")]
    ada.post(f"{TINY}open", way="results")
    results_page = "/tiny/research/results"
    code = ada.get(results_page).value("main [name=form_code]", "value")
    reason = "The ethics board asks"
    assert ada.post(results_page, form_code=code, reason=reason).status_code == 303
    assert ada.post(f"{JOBS}tables").status_code == 303
    standing = wait_until_ended(tiny.folder.jobs, "tables")
    assert (standing.state, standing.job.status, standing.job.by) == ("done", 0, "Ada")
    assert standing.job.ended_at is not None
    newest = latest_looks(tiny.database)[0]
    assert (newest.way, newest.researcher, newest.reason) == ("export", "Ada", reason)
    with ada.client.get(f"{JOBS}tables/archive") as archive:
        assert "filename=tiny-tables.zip" in archive.headers["Content-Disposition"]
        with ZipFile(io.BytesIO(archive.data)) as unpacked:
            assert "answers/responses.csv" in unpacked.namelist()
    assert ("Ada", "downloaded", "Tables of answers") in changes(tiny)


def test_forms_and_data_decide_what_a_command_is_given(
    tiny: LabStudy, ada: ResearchBrowser, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[tuple[str, ...]] = []
    monkeypatch.setattr(
        "studyapp.desk.job_page.run_job", lambda _jobs, job: begun.append(job.command)
    )
    tiny.folder.rehearsal.write_bytes(tiny.folder.responses.read_bytes())
    assert ada.post(f"{JOBS}share").status_code == 303
    write_earlier_results(tiny)
    page = ada.get(f"{JOBS}report")
    assert page.soup.select("[name=motion][type=checkbox]:not([checked])")
    size = (tiny.folder.report / "report.html").stat().st_size
    assert f"Open the report</a>, {size} Bytes" in page.text
    assert ada.post(f"{JOBS}report", motion="on").status_code == 303
    assert begun == [
        ("export", "--folder", SHARED, "--rehearsal"),
        ("report", ".", "--with-motion"),
    ]
