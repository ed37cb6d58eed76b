from pathlib import Path

import pytest

from studyapp.database.engine import Database
from studyapp.database.tables.researchers import Event
from studyapp.researchers.audit import MAX_LINES, log_change
from studyapp.session.enrolment import Arrival
from tests.studyapp.conftest import OwnStudy
from tests.support.command_line import run, run_in_terminal
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.stored import opened, writing
from tests.support.studies.taking_part_steps import SetClock, taking_part

PERSON = "5f3c1d9e7a2b4c6d8e0f1a2b"


@pytest.fixture
def study(own_study: OwnStudy) -> Path:
    """Return a study in which one participant, recruited by name, has seen the first trial."""
    root = own_study("pairwise").root
    with taking_part(root) as participant:
        arrival = Arrival(recruiter_participant=PERSON, recruiter_study="one")
        participant.arrive(arrival).begin().look()
    return root


def is_in_the_file(study: Path) -> bool:
    return any(PERSON.encode() in path.read_bytes() for path in study.glob("responses.db*"))


def test_tables_follow_their_extension_and_a_shared_folder_is_explained(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = run("export", study, "--out", tmp_path / "out.parquet")
    assert f"Wrote 0 answers to {tmp_path / 'out.parquet'}" in output
    assert not list(tmp_path.glob("*.csv"))

    output = run_in_terminal(monkeypatch, "export", study, "--folder", tmp_path / "to lend")
    assert f"motionjury report '{tmp_path / 'to lend' / 'sourcedata' / 'study'}'" in output
    assert "export: copying the study" in output


def test_a_participant_is_erased_after_a_question_and_what_remains_is_printed(study: Path) -> None:
    assert "Nothing was erased" in run("forget", study, PERSON, typed="n\n")
    assert is_in_the_file(study)

    erased = run("forget", study, PERSON, typed="y\n")

    assert "Study session 1 (started, arm all). To be erased" in erased
    assert "What remains: one row" in erased
    assert "Left to do by hand" in erased
    assert not is_in_the_file(study)


def test_erasing_again_rewrites_the_files(study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cleared: list[Database] = []
    monkeypatch.setattr("studyapp.cli.exclude_command.scrub", cleared.append)
    assert "No participant has this" in run("forget", study, "nobody", "--yes")
    assert not cleared
    run("forget", study, PERSON, "--yes")
    with writing(study / "responses.db") as session:
        for _ in range(MAX_LINES):
            log_change(session, SetClock().now(), Event.LOGGED_IN, by="ada")

    assert "No participant has this" in run("forget", study, PERSON, "--yes")

    assert len(cleared) == 2


def test_a_participant_is_found_by_a_pseudonym_from_an_earlier_export(study: Path) -> None:
    run("export", study, "--with-recruiter-ids")
    pseudonym = (study / "recruiter_ids.csv").read_text().splitlines()[1].split(",")[0]

    run("forget", study, pseudonym, "--yes")

    assert not is_in_the_file(study)
    run("export", study, "--with-recruiter-ids")
    assert (study / "recruiter_ids.csv").read_text().count("\n") == 1
    with opened(study / "responses.db") as database:
        assert read_once(database, responses_table).empty
