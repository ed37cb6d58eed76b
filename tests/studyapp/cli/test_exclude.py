"""Exclusions by hand, and their effect on reports and exports."""

import json

import pytest

from studyapp.database.engine import Database
from studyapp.database.tables.researchers import Event
from studyapp.researchers.audit import latest_changes
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.export.tables import pseudonyms
from studyapp.results.report import report
from studyapp.results.stored_answers import stored_answers
from studyapp.session.intake import add_places
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder
from tests.studyapp.conftest import OwnStudy
from tests.support.command_line import run
from tests.support.read_once import read_once
from tests.support.studies.answered_study import answer_study
from tests.support.studies.redefining import set_keys
from tests.support.studies.stored import opened
from tests.support.studies.taking_part_steps import SetClock

REASON = '=cmd; wrote to us, "fell asleep"'


@pytest.fixture
def folder(own_study: OwnStudy) -> StudyFolder:
    """Return a study that four participants answered by chance, the last one in part."""
    study = own_study("mismatch")
    set_keys(study.definition, {"participants": 4})
    answer_study(study.root, people=4, stop_after=2)
    return study


def exclude(folder: StudyFolder, name: str, *options: str, reason: str = REASON) -> str:
    return run("exclude", folder.root, name, "--reason", reason, *options)


def reasons(database: Database) -> list[str]:
    return list(read_once(database, stored_answers).study_sessions["excluded_because"])


def test_a_participant_is_excluded_and_reinstated_by_number_or_pseudonym(
    folder: StudyFolder,
) -> None:
    key = PseudonymKey.read_or_make(folder.pseudonym_key)
    with opened(folder.responses) as database:
        name = read_once(database, pseudonyms, key)["2"]

        assert "excluded from the analysis" in exclude(folder, "1", reason="asleep")
        assert reasons(database) == ["asleep", "", "", ""]
        exclude(folder, name, reason="played at double speed")
        assert reasons(database) == ["asleep", "played at double speed", "", ""]
        output = exclude(folder, name, "--reinstate", reason="that was somebody else")
        assert reasons(database) == ["asleep", "", "", ""]
        assert "exclusion rules still apply" in output
        assert [(line.researcher, line.event) for line in latest_changes(database)[:2]] == [
            ("", Event.REINSTATED),
            ("", Event.EXCLUDED),
        ]


def test_only_a_known_participant_is_excluded_and_no_database_is_made(folder: StudyFolder) -> None:
    for name in ("77", "p" * 17, "-", ""):
        given = ("exclude", folder.root, "--reason", "asleep", "--", name)
        assert "there is no study session" in run(*given, status=1)
    folder.responses.unlink()
    assert "DATABASE_URL" in run("exclude", folder.root, "1", "--reason", "asleep", status=1)
    run("forget", folder.root, "somebody", "--yes", status=1)

    assert not folder.responses.exists()


def test_reports_apply_exclusions_by_hand_after_the_rules_and_mark_them(
    folder: StudyFolder,
) -> None:
    for name in ("2", "4"):
        exclude(folder, name)
    with opened(folder.responses) as database:
        served = ServedStudy.read(folder.root)
        add_places(database, served, SetClock(), 3, by="Ada", reason="more")
    places = sum(arm.places for arm in folder.study().arms)

    document = json.loads(report(folder).with_name("results.json").read_text("utf-8"))

    rule = document["rules"][-1]
    assert (rule["rule"], rule["removed"], rule["exploratory"]) == ("researcher", 1, True)
    # Participants whom a rule excludes too count under the rule.
    assert list(document["exclusions"]) == ["4", "2"]
    assert document["exclusions"]["4"].endswith("trials answered")
    assert document["exclusions"]["2"] == REASON
    assert document["participants"] == {"recruited": 4, "attentive": 2}
    first = document["sensitivity"][0]
    assert first["as_planned"]["participants"] == first["analysed"]["participants"] + 1
    assert sum(flow["places"] for flow in document["flow"]) == places + 3
    page = (folder.report / "report.html").read_text("utf-8")
    assert "1 participant whom the earlier rules would have kept was excluded by hand" in page
    assert "excluded by a researcher (exploratory)" in page

    folder.shared_answers.touch()
    passed_on = run("exclude", folder.root, "1", "--reason", "asleep", status=1)
    assert "comes from another lab" in passed_on
