from __future__ import annotations

from collections.abc import Callable

import pandas as pd
import pytest
from sqlalchemy.orm import Session

from studyapp.results.export.rows import refusals_table, watching_table
from studyapp.session.ending import withdraw
from studyapp.session.refusal import ConflictError, UnacceptableError, log_refusal
from studyapp.session.watch_evidence import Playback
from tests.support.read_once import read_once
from tests.support.servers.both_databases import BOTH
from tests.support.studies.taking_part_steps import Participant


@BOTH
def test_a_video_is_one_row_with_all_that_was_measured(participant: Participant) -> None:
    participant.look()
    participant.clock.advance(seconds=30)
    participant.watch((0.0, 1.0), playback=Playback(stalls=1, stalled_seconds=2.0, frames=20))
    participant.watch((0.0, 2.0), batch=1, playback=Playback(rate=2.0, frames=20))
    participant.watch((0.5, 1.5), batch=2, playback=Playback(frames=20, dropped_frames=6))

    (row,) = read_once(participant.database, watching_table).to_dict("records")

    assert row["watched"] == 0.75
    assert row["times_played"] == 2.0
    assert (row["rate"], row["stalls"], row["stalled_seconds"]) == (2.0, 1, 2.0)
    assert (row["frames"], row["dropped_share"]) == (60, 0.1)
    assert row["stimuli"] == "1 2"
    assert set(str(row["conditions"]).split()) <= {"rule_based", "mismatched", "broken"}
    assert row["unplayable_at"] is None


def test_a_video_that_does_not_play_is_named(participant: Participant) -> None:
    participant.leave_out()
    participant.look()

    table = read_once(participant.database, watching_table)

    assert table["position"].tolist() == [1, 2]
    assert table["unplayable_at"].tolist() == [participant.clock.now(), pd.NaT]


def test_what_was_never_sent_was_not_watched_whatever_its_browser_reports(
    participant: Participant,
) -> None:
    trial = participant.trial()
    participant.clock.advance(seconds=30)
    known = participant.report(trial.videos[0].token, (0.0, 2.0))
    assert not known.intervals
    assert known.missing == pytest.approx(1.9)
    with pytest.raises(UnacceptableError, match="About 2 s"):
        participant.answer(trial.token)

    (row,) = read_once(participant.database, watching_table).to_dict("records")

    assert (row["sent_at"], row["watched"], row["times_played"]) == (None, 0.0, 1.0)


@pytest.mark.parametrize("table", [watching_table, refusals_table])
def test_who_withdrew_is_not_exported(
    participant: Participant, table: Callable[[Session], pd.DataFrame]
) -> None:
    participant.take_trial()
    refusal = ConflictError("No.", "Try again.")
    log_refusal(participant.database, participant.token, "answers", refusal, participant.clock)
    assert not read_once(participant.database, table).empty

    withdraw(participant.database, participant.token, participant.clock)

    assert read_once(participant.database, table).empty


def test_a_refusal_is_exported_without_token(participant: Participant) -> None:
    refusal = ConflictError("No.", "Try again.")
    log_refusal(participant.database, participant.token, "answers", refusal, participant.clock)

    table = read_once(participant.database, refusals_table)

    assert table["kind"].tolist() == ["stale-page"]
    assert table["study_session"].tolist() == [1]
    assert participant.token not in table.to_csv()
