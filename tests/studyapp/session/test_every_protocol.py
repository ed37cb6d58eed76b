"""The bookkeeping knows no protocol: answers to orders and to several videos are taken alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from studyapp.database.engine import Database
from studyapp.session.refusal import ConflictError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.shown_trials import ShownTrial
from studyapp.session.versions import open_study
from studyapp.study.settings.questions import Reason
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.taking_part_steps import Participant, SetClock

Arrive = Callable[[str], Participant]


@pytest.fixture
def arrive(finished_study: Callable[[str], Path], database: Database, clock: SetClock) -> Arrive:
    """Return a function that brings a participant to the first trial of a protocol's study."""

    def make(protocol: str) -> Participant:
        served = ServedStudy.read(finished_study(protocol))
        open_study(database, served, clock)
        return Participant(database, served, clock).enrol().begin()

    return make


def some_answers(shown: ShownTrial) -> dict[str, str | list[str]]:
    """Return an answer for every field: the first one offered, or ranks in the page's order."""
    ranked = all(ask.stimulus is not None and min(ask.values) == 1 for ask in shown.asks)
    return {ask.field: [str(ask.stimulus if ranked else min(ask.values))] for ask in shown.asks}


def exported(participant: Participant) -> pd.DataFrame:
    return read_once(participant.database, responses_table)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"realism:2": ["1"]}, "same rank"),
        ({"realism:2": ["3"]}, "not one of the choices"),
        ({"realism:2": []}, "Question 1 about B is not answered"),
        ({"realism:0": ["1"]}, "does not ask"),
        ({"realism": ["1"]}, "does not ask"),
        ({"realism:2": ["1", "2"]}, "not one of the choices"),
        ({"realism:reasons": ["face"]}, "reason was ticked"),
        ({"realism:1:reasons": ["face"]}, "does not ask"),
    ],
)
def test_a_ranking_that_is_none_is_refused(
    arrive: Arrive, changes: dict[str, str | list[str]], words: str
) -> None:
    participant = arrive("ranking")
    shown = participant.watch_all()

    with pytest.raises(UnacceptableError, match=words):
        participant.answer(shown.token, some_answers(shown) | changes)
    assert exported(participant).empty


def test_reasons_of_an_order_are_ticked_once_and_stand_beside_each_of_its_ranks(
    arrive: Arrive,
) -> None:
    participant = arrive("ranking")
    reason = Reason(name="hands", text="the hands")
    study = participant.served.study
    asked = tuple(q.model_copy(update={"reasons": (reason,)}) for q in study.questions)
    participant.served = replace(
        participant.served, study=study.model_copy(update={"questions": asked})
    )
    shown = participant.watch_all()
    fields = some_answers(shown) | {"realism:reasons": ["hands"]}

    participant.answer(shown.token, fields)
    participant.answer(shown.token, fields)

    table = exported(participant)
    assert set(table["question"]) == {"realism"}
    assert table["reasons"].tolist() == ["hands"] * len(shown.asks)
    with pytest.raises(ConflictError):
        participant.answer(shown.token, some_answers(shown))


def test_every_video_has_to_be_played_in_a_time_of_its_own(arrive: Arrive) -> None:
    participant = arrive("rating")
    _, second, _ = participant.trial().videos
    participant.clock.advance(seconds=2)
    participant.watch((0.0, 2.0))

    with pytest.raises(UnacceptableError, match="than there was time for"):
        participant.report(second.token, (0.0, 2.0))
