"""The log of looks: what it holds, and what is taken out of it when somebody is forgotten."""

from __future__ import annotations

from studyapp.database.engine import Database
from studyapp.researchers.audit import StudyState, latest_changes, latest_looks, log_look
from studyapp.results.stored_answers import stored_answers
from tests.support.read_once import read_once
from tests.support.servers.both_databases import BOTH
from tests.support.studies.taking_part_steps import SetClock

STATE = StudyState(finished=12, planned=25, answers=300)


@BOTH
def test_a_look_is_in_both_logs_and_researchers_are_numbered_for_others(
    opened: Database, clock: SetClock
) -> None:
    for by, reason in (("Ada", "a video broke"), ("", ""), ("Grace", "curious"), ("Ada", "again")):
        with opened.writing() as session:
            log_look(
                session,
                clock.now(),
                STATE,
                way="page" if by else "report",
                by=by,
                reason=reason,
            )

    found = latest_looks(opened)
    assert [look.researcher for look in found] == ["Ada", "Grace", "", "Ada"]
    assert {(look.finished, look.planned, look.answers) for look in found} == {(12, 25, 300)}
    newest = latest_changes(opened)[0]
    assert (newest.event, newest.researcher) == ("results looked at", "Ada")
    assert newest.detail == "12 of 25 participants had finished"
    passed_on = read_once(opened, stored_answers).looks
    numbered = ["researcher 1", "command line", "researcher 2", "researcher 1"]
    assert passed_on["by"].tolist() == numbered
    assert set(passed_on["day"]) == {"2026-05-04"}
