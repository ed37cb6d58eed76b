from __future__ import annotations

import pandas as pd

from tests.support.read_once import read_once
from tests.support.servers.both_databases import BOTH
from tests.support.studies.exported import responses_table, study_sessions_table
from tests.support.studies.taking_part_steps import Participant


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


@BOTH
def test_the_participant_flow_counts_every_study_session(participant: Participant) -> None:
    participant.take_trial()
    participant.leave_out()
    participant.another().enrol("other").begin().take_all()
    participant.another().enrol("third")

    flow = read_once(participant.database, study_sessions_table)

    assert flow["state"].tolist() == ["started", "completed", "instructed"]
    assert flow["answered"].tolist() == [1, 6, 0]
    assert flow["unplayable"].tolist() == [1, 0, 0]
    assert flow["presentations"].tolist() == [6, 6, 6]
    assert pd.Timestamp(flow["completed_at"][1]).tzinfo is not None
