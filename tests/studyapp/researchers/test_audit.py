"""The log of looks, and the part shared with other labs."""

from __future__ import annotations

from studyapp.database.engine import Database
from studyapp.researchers.audit import StudyState, Way, latest_changes, latest_looks, log_look
from studyapp.results.stored_answers import stored_answers
from tests.support.read_once import read_once
from tests.support.servers.both_databases import BOTH
from tests.support.studies.taking_part_steps import SetClock


@BOTH
def test_a_look_is_in_both_logs_and_researchers_are_numbered(
    opened: Database, clock: SetClock
) -> None:
    state = StudyState(finished=12, planned=25, answers=300)
    for by, reason in (("Ada", "a video broke"), ("", ""), ("Grace", "curious"), ("Ada", "again")):
        way: Way = "page" if by else "report"
        with opened.writing() as session:
            log_look(session, clock.now(), state, way=way, by=by, reason=reason)

    looks = latest_looks(opened)
    assert [look.researcher for look in looks] == ["Ada", "Grace", "", "Ada"]
    assert {(look.finished, look.planned, look.answers) for look in looks} == {(12, 25, 300)}
    newest = latest_changes(opened)[0]
    assert (newest.event, newest.researcher) == ("results looked at", "Ada")
    assert newest.detail == "12 of 25 participants had finished"
    shared = read_once(opened, stored_answers).looks
    numbered = ["researcher 1", "command line", "researcher 2", "researcher 1"]
    assert shared["by"].tolist() == numbered
    assert set(shared["day"]) == {"2026-05-04"}
