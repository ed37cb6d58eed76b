from __future__ import annotations

import pandas as pd
import pytest

from studyapp.session.ending import withdraw
from tests.studyapp.exported import responses_table, study_sessions_table
from tests.studyapp.read_once import read_once
from tests.studyapp.taking_part_steps import Participant


def test_an_empty_study_exports_no_answer(participant: Participant) -> None:
    assert read_once(participant.database, responses_table).empty


def test_the_export_holds_every_answer_with_its_kind(participant: Participant) -> None:
    participant.take_all()

    table = read_once(participant.database, responses_table)

    assert len(table) == 12
    assert set(table["kind"]) == {"practice", "main", "repeat", "catch"}
    assert set(table["watched"]) == {1.0}
    assert set(table["seconds"]) == {5.0}


def test_values_keep_their_side(participant: Participant) -> None:
    participant.take_trial({"rhythm": "-2", "emotion": "2"})

    table = read_once(participant.database, responses_table).set_index("question")

    assert table.loc["rhythm", "value"] == -2
    assert table.loc["emotion", "value"] == 2


def test_of_a_catch_trial_other_is_the_flawed_condition(participant: Participant) -> None:
    participant.take_all()

    table = read_once(participant.database, responses_table)
    catch = table[table["kind"] == "catch"]

    assert set(catch["other"]) == {"broken"}
    assert set(catch["reference"]) == {"rule_based"}
    expected_condition = catch["left_condition"].where(
        catch["expected"] == "left", catch["right_condition"]
    )
    assert set(expected_condition) == {"rule_based"}


def test_who_withdrew_is_counted_but_not_exported(participant: Participant) -> None:
    participant.take_trial()
    withdraw(participant.database, participant.token, participant.clock)

    assert read_once(participant.database, responses_table).empty
    assert read_once(participant.database, study_sessions_table)["state"].tolist() == ["withdrawn"]


def test_the_participant_flow_counts_every_study_session(participant: Participant) -> None:
    participant.take_trial()
    participant.leave_out()
    other = Participant(participant.database, participant.served, participant.clock)
    other.enrol("other").begin().take_all()
    Participant(participant.database, participant.served, participant.clock).enrol("third")

    flow = read_once(participant.database, study_sessions_table)

    assert flow["state"].tolist() == ["started", "completed", "instructed"]
    assert flow["answered"].tolist() == [1, 6, 0]
    assert flow["unplayable"].tolist() == [1, 0, 0]
    assert flow["presentations"].tolist() == [6, 6, 6]
    assert pd.Timestamp(flow["completed_at"][1]).tzinfo is not None


def test_the_watched_share_counts_what_was_played_once(participant: Participant) -> None:
    first = participant.trial().token
    participant.clock.advance(seconds=9)
    participant.watch((0.0, 1.94), (0.0, 1.0))
    participant.answer(first)

    assert read_once(participant.database, responses_table)["watched"].tolist() == pytest.approx(
        [0.97, 0.97]
    )
