from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from motion.errors import InputError
from studyapp.cli.exclude_command import forget_command
from studyapp.cli.export_command import command as export_command
from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables import Event
from studyapp.researchers.audit import LINES, log_change
from studyapp.session.arrivals import Arrival
from studyapp.session.enrolment import enrol
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.studyapp.exported import responses_table
from tests.studyapp.read_once import read_once
from tests.studyapp.taking_part_steps import Participant, SetClock

PERSON = "5f3c1d9e7a2b4c6d8e0f1a2b"


@pytest.fixture
def study(
    finished_study: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """Return a study in which one participant, recruited by name, has seen the first trial."""
    monkeypatch.delenv("DATABASE_URL", raising=False)
    root = tmp_path / "study"
    shutil.copytree(finished_study("pairwise"), root)
    database = Database.open(sqlite_url(root / "responses.db"))
    served = ServedStudy.read(root)
    clock = SetClock()
    open_study(database, served, clock)
    participant = Participant(database, served, clock)
    arrival = Arrival(recruiter_participant=PERSON, recruiter_study="one")
    participant.token = enrol(database, served, arrival, clock)
    participant.begin().look()
    database.close()
    return root


def export(*arguments: object) -> Result:
    return CliRunner().invoke(export_command, [*map(str, arguments)], catch_exceptions=False)


def forget(*arguments: object, said: str = "") -> Result:
    return CliRunner().invoke(forget_command, [*map(str, arguments)], said, catch_exceptions=False)


def is_in_the_file(study: Path) -> bool:
    return any(PERSON.encode() in path.read_bytes() for path in study.glob("responses.db*"))


def test_tables_are_written_as_their_ending_says(study: Path, tmp_path: Path) -> None:
    found = export(study, "--out", tmp_path / "out.parquet")

    assert found.exit_code == 0
    assert f"Wrote 0 answers to {tmp_path / 'out.parquet'}" in found.output
    assert not list(tmp_path.glob("*.csv"))
    with pytest.raises(InputError, match=r"neither in \.csv nor in \.parquet"):
        export(study, "--out", tmp_path / "out.xlsx")


def test_a_folder_for_another_lab_says_what_to_do_with_it(study: Path, tmp_path: Path) -> None:
    found = export(study, "--folder", tmp_path / "out")

    assert found.exit_code == 0
    assert f"motionjury report {tmp_path / 'out' / 'sourcedata' / 'study'}" in found.output
    for wrong in (["--with-recruiter-ids"], ["--out", "x.csv"], ["--format", "csv"]):
        with pytest.raises(InputError, match="cannot be given with --folder"):
            export(study, "--folder", tmp_path / "other", *wrong)
    with pytest.raises(InputError, match="for a folder for another lab"):
        export(study, "--with-videos")


def test_a_participant_is_erased_when_asked_and_told_what_remains(study: Path) -> None:
    assert is_in_the_file(study)

    kept = forget(study, PERSON, said="n\n")
    assert kept.exit_code == 1
    assert is_in_the_file(study)

    erased = forget(study, PERSON, said="y\n")
    assert erased.exit_code == 0
    assert "found by its recruiter id" in erased.output
    assert "What remains: one row" in erased.output
    assert "Left to do by hand" in erased.output
    assert not is_in_the_file(study)


def test_erasing_again_changes_nothing_and_says_so(study: Path) -> None:
    export(study)
    assert forget(study, PERSON, "--yes").output.count("responses.csv") == 1

    again = forget(study, PERSON, "--yes")

    assert again.exit_code == 0
    assert "Nobody in this study" in again.output


def test_erasing_again_clears_the_files_however_much_has_happened_since(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cleared: list[Database] = []
    monkeypatch.setattr("studyapp.cli.exclude_command.leave_nothing", cleared.append)
    forget(study, PERSON, "--yes")
    with (
        closing(Database.open(sqlite_url(study / "responses.db"))) as database,
        database.writing() as session,
    ):
        for _ in range(LINES):
            log_change(session, SetClock().now(), Event.LOGGED_IN, by="ada")

    forget(study, PERSON, "--yes")

    assert len(cleared) == 2


def test_the_pseudonym_of_an_export_finds_the_participant_who_is_in_none_afterwards(
    study: Path,
) -> None:
    export(study, "--with-recruiter-ids")
    pseudonym = (study / "recruiter_ids.csv").read_text().splitlines()[1].split(",")[0]

    assert "found by its pseudonym" in forget(study, pseudonym, "--yes").output
    assert not is_in_the_file(study)
    export(study, "--with-recruiter-ids")
    assert (study / "recruiter_ids.csv").read_text().count("\n") == 1
    with closing(Database.open(sqlite_url(study / "responses.db"))) as database:
        assert read_once(database, responses_table).empty


def test_nobody_is_forgotten_where_nobody_took_part(
    finished_study: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    root = finished_study("rating")

    assert "Nobody in this study" in forget(root, PERSON, "--yes").output
    assert not (root / "responses.db").exists()
