import pandas as pd

from studyapp.results.export.rows import refusals_table, watching_table
from studyapp.session.refusal import ConflictError, log_refusal
from studyapp.session.watch_evidence import Playback
from tests.support.read_once import read_once
from tests.support.servers.both_databases import BOTH
from tests.support.studies.exported import responses_table, study_sessions_table
from tests.support.studies.taking_part_steps import Participant


def test_a_catch_trials_other_condition_is_the_flawed_one(participant: Participant) -> None:
    participant.take_all()

    table = read_once(participant.database, responses_table)
    catch = table[table["kind"] == "catch"]

    assert set(catch["other"]) == {"broken"}
    assert set(catch["reference"]) == {"rule_based"}
    expected = catch["left_condition"].where(catch["expected"] == "left", catch["right_condition"])
    assert set(expected) == {"rule_based"}


@BOTH
def test_the_participant_flow_counts_every_study_session_and_marks_unplayable_videos(
    participant: Participant,
) -> None:
    participant.take_trial()
    participant.leave_out()
    skipped_at = participant.clock.now()
    participant.look()
    participant.another().enrol("other").begin().take_all()
    participant.another().enrol("third")

    flow = read_once(participant.database, study_sessions_table)

    assert flow["state"].tolist() == ["started", "completed", "instructed"]
    assert flow["answered"].tolist() == [1, 6, 0]
    assert flow["unplayable"].tolist() == [1, 0, 0]
    assert flow["presentations"].tolist() == [6, 6, 6]
    watched = read_once(participant.database, watching_table)
    own = watched[watched["study_session"] == 1]
    assert own["position"].tolist() == [1, 2, 3]
    assert own["unplayable_at"].tolist() == [pd.NaT, skipped_at, pd.NaT]
    assert pd.Timestamp(flow["completed_at"][1]).tzinfo is not None


@BOTH
def test_a_video_is_one_row_with_all_measurements(participant: Participant) -> None:
    other = participant.another().enrol("other").begin()
    never_sent = other.trial().videos[0].token
    participant.look()
    participant.clock.advance(seconds=30)
    participant.watch((0.0, 1.0), playback=Playback(stalls=1, stalled_seconds=2.0, frames=20))
    participant.watch((0.0, 2.0), batch=1, playback=Playback(rate=2.0, frames=20))
    participant.watch((0.5, 1.5), batch=2, playback=Playback(frames=20, dropped_frames=6))
    other.report(never_sent, (0.0, 2.0))

    row, unsent = read_once(participant.database, watching_table).to_dict("records")

    assert row["watched"] == 0.75
    assert row["times_played"] == 2.0
    assert (row["rate"], row["stalls"], row["stalled_seconds"]) == (2.0, 1, 2.0)
    assert (row["frames"], row["dropped_share"]) == (60, 0.1)
    assert row["stimuli"] == "1 2"
    assert set(str(row["conditions"]).split()) <= {"rule_based", "mismatched", "broken"}
    assert row["unplayable_at"] is None
    assert unsent["sent_at"] is pd.NaT
    assert (unsent["watched"], unsent["times_played"]) == (0.0, 1.0)


def test_refusals_are_exported_without_tokens(participant: Participant) -> None:
    participant.take_trial()
    refusal = ConflictError("No.", "Try again.")
    log_refusal(participant.database, participant.token, "answers", refusal, participant.clock)

    refused, watched = (
        read_once(participant.database, table) for table in (refusals_table, watching_table)
    )

    assert refused["kind"].tolist() == ["stale-page"]
    assert refused["study_session"].tolist() == [1]
    assert participant.token not in refused.to_csv() + watched.to_csv()
