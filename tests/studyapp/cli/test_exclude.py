from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from motion.errors import InputError
from studyapp.cli.exclude_command import command
from studyapp.database.engine import Database, sqlite_url
from studyapp.researchers.audit import logged_changes
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.results.export.tables import pseudonyms
from studyapp.results.stored_answers import stored_answers
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder
from tests.studyapp.read_once import read_once
from tests.studyapp.taking_part_steps import Participant, SetClock


@pytest.fixture
def database(tiny_study: Path, empty_sqlite: Path, monkeypatch: pytest.MonkeyPatch) -> Database:
    """Return the database of a study in which two have begun."""
    monkeypatch.delenv("DATABASE_URL", raising=False)
    file = shutil.copyfile(empty_sqlite, tiny_study / "responses.db")
    made = Database.open(sqlite_url(file))
    served, clock = ServedStudy.read(tiny_study), SetClock()
    open_study(made, served, clock)
    for name in ("one", "two"):
        Participant(made, served, clock).enrol(name).begin()
    return made


def exclude(*arguments: object) -> Result:
    return CliRunner().invoke(command, [*map(str, arguments)], catch_exceptions=False)


def reasons(database: Database) -> list[str]:
    found: list[str] = (
        read_once(database, stored_answers).study_sessions["excluded_because"].tolist()
    )
    return found


def test_a_participant_is_excluded_and_reinstated_by_number_or_pseudonym(
    tiny_study: Path, database: Database
) -> None:
    key = PseudonymKey.read_or_make(StudyFolder(tiny_study).pseudonym_key)
    name = read_once(database, pseudonyms, key)["2"]

    done = exclude(tiny_study, "1", "--reason", "asleep")
    assert (done.exit_code, reasons(database)) == (0, ["asleep", ""])
    assert "left out of the analysis" in done.output
    exclude(tiny_study, name, "--reason", "played at double speed")
    assert reasons(database) == ["asleep", "played at double speed"]
    back = exclude(tiny_study, name, "--reinstate", "--reason", "that was another one")
    assert reasons(database) == ["asleep", ""]
    assert "rules of the study file hold as before" in back.output
    assert [(line.researcher, line.event) for line in logged_changes(database)[:2]] == [
        ("", "participant reinstated"),
        ("", "participant excluded"),
    ]


def test_nobody_is_excluded_without_a_reason_or_by_a_name_that_nobody_has(
    tiny_study: Path, database: Database
) -> None:
    assert exclude(tiny_study, "1").exit_code == 2
    for name in ("77", "p" * 17, "-", ""):
        with pytest.raises(InputError, match="no study session is called"):
            exclude(tiny_study, "--reason", "asleep", "--", name)
    (tiny_study / "responses.db").rename(tiny_study / "elsewhere.db")
    with pytest.raises(InputError, match="no study session is called"):
        exclude(tiny_study, "1", "--reason", "asleep")

    assert not (tiny_study / "responses.db").exists()
