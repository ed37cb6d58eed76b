from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from studyapp.database.engine import Database, sqlite_url
from studyapp.results.answer_table import MIDDLE, StudyAnswers, study_answers
from studyapp.results.stored_answers import StoredAnswers, stored_answers
from studyapp.study.folder import StudyFolder
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.finished_study import PROTOCOLS

Once = Callable[..., Path]


def read(folder: StudyFolder) -> tuple[StoredAnswers, StudyAnswers]:
    database = Database.open_for_reading(sqlite_url(folder.responses))
    assert database is not None
    stored = read_once(database, stored_answers)
    database.close()
    return stored, study_answers(folder.study(), stored)


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_same_answers_stand_in_the_table_and_in_the_export(
    answered_once: Once, protocol: str
) -> None:
    folder = StudyFolder(answered_once(protocol))
    _, given = read(folder)
    database = Database.open_for_reading(sqlite_url(folder.responses))
    assert database is not None
    exported = read_once(database, responses_table)
    database.close()

    count = sum(len(table) for table in given.tables.values())
    assert count == len(exported)
    for name, table in given.tables.items():
        answer = "rank" if name == "ranking" else "response"
        shift = 0 if name in ("rating", "ranking") else MIDDLE
        part = exported
        if protocol == "mismatch":
            part = exported[exported["part"] == ("fit" if name == "mismatch" else "realism")]
        assert table[answer].astype(int).tolist() == (part["value"] + shift).tolist()
        assert table["participant"].astype(int).tolist() == part["study_session"].tolist()
        assert table["trial"].astype(int).tolist() == part["position"].tolist()
        assert table["watched"].astype(float).tolist() == part["watched"].tolist()


def test_sides_and_right_answers_of_pairs_are_those_shown(
    answered_once: Once,
) -> None:
    _, given = read(StudyFolder(answered_once("pairwise")))
    table = given.tables["pairwise"]

    catch = table[table["kind"] == "catch"]
    assert len(catch) == 2
    for row in catch.itertuples():
        assert getattr(row, str(row.correct_side)) == "real"
    asked = table[table["kind"] == "attention"]["instructed"].astype(int)
    assert set(asked) <= {1, 2, 4, 5}
    assert (table[table["kind"] == "main"]["correct_side"] == "").all()


def test_failures_are_those_that_the_protocol_finds(answered_once: Once) -> None:
    stored, given = read(StudyFolder(answered_once("pairwise")))
    table = given.tables["pairwise"]

    for session, known in given.known.items():
        own = table[table["participant"] == session]
        catch = own[own["kind"] == "catch"].iloc[0]
        towards = int(catch["response"]) - MIDDLE
        right = towards > 0 if catch["correct_side"] == "right" else towards < 0
        assert known.failed_catch == int(not right)
        asked = own[own["kind"] == "attention"].iloc[0]
        assert known.failed_attention == int(asked["response"] != asked["instructed"])
        assert (known.trials, known.settled) == (6, 6)
    assert len(stored.study_sessions) == 2
