from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from studyapp.results.answer_table import MIDDLE, StudyAnswers, study_answers
from studyapp.results.stored_answers import stored_answers
from studyapp.study.folder import StudyFolder
from tests.support.studies.exported import responses_table
from tests.support.studies.finished_study import PROTOCOLS
from tests.support.studies.stored import reading

Once = Callable[..., Path]


def read(folder: StudyFolder) -> tuple[pd.DataFrame, StudyAnswers]:
    """Return the answers as they are exported, and as they are analysed."""
    with reading(folder.responses) as session:
        return responses_table(session), study_answers(folder.study(), stored_answers(session))


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_same_answers_stand_in_the_table_and_in_the_export(
    answered_once: Once, protocol: str
) -> None:
    folder = StudyFolder(answered_once(protocol))
    exported, given = read(folder)

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


def test_right_answers_of_pairs_are_those_shown_and_failures_those_that_the_protocol_finds(
    answered_once: Once,
) -> None:
    _, given = read(StudyFolder(answered_once("pairwise")))
    table = given.tables["pairwise"]

    assert len(given.known) == 2
    assert (table[table["kind"] == "main"]["correct_side"] == "").all()
    for session, known in given.known.items():
        own = table[table["participant"] == session]
        catch = own[own["kind"] == "catch"].iloc[0]
        assert catch[catch["correct_side"]] == "real"
        towards = int(catch["response"]) - MIDDLE
        right = towards > 0 if catch["correct_side"] == "right" else towards < 0
        assert known.failed_catch == int(not right)
        asked = own[own["kind"] == "attention"].iloc[0]
        assert int(asked["instructed"]) in (1, 2, 4, 5)
        assert known.failed_attention == int(asked["response"] != asked["instructed"])
        assert (known.trials, known.settled) == (6, 6)
