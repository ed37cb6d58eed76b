from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest
from sqlalchemy import select, update

from studyapp.database.tables import Response, StudySession, Video
from studyapp.session.answers import skip_unplayable
from studyapp.session.ending import MIN_SKIPPED_TRIALS
from studyapp.session.refusal import (
    ConflictError,
    UnacceptableError,
)
from studyapp.session.watch_evidence import Playback
from studyapp.study.settings.recruitment import CODE_LENGTH, CODE_LETTERS
from tests.support.studies.taking_part_steps import Participant


def stored(participant: Participant) -> list[tuple[str, int]]:
    with participant.database.reading() as session:
        rows = session.scalars(select(Response).order_by(Response.id))
        return [(row.question, row.value) for row in rows]


def ready(participant: Participant) -> str:
    """Watch the present trial to the end and return its token."""
    token = participant.trial().token
    participant.clock.advance(seconds=7)
    participant.watch((0.0, 2.0))
    return token


def test_an_answer_is_stored_with_its_time_before_the_next_trial_is_shown(
    participant: Participant,
) -> None:
    first = ready(participant)

    participant.answer(first)

    assert stored(participant) == [("rhythm", 1), ("emotion", -2)]
    assert participant.trial().position == 2
    with participant.database.reading() as session:
        trial = session.scalars(select(StudySession)).one().trials[0]
        assert trial.answered_at == participant.clock.now()
        assert trial.seconds == 7.0


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ({"rhythm": "3", "emotion": "0"}, "not one of the choices"),
        ({"rhythm": "１", "emotion": "0"}, "not one of the choices"),
        ({"rhythm": "1.0", "emotion": "0"}, "not one of the choices"),
        ({"rhythm": "", "emotion": "0"}, "not one of the choices"),
        ({"rhythm": "-0", "emotion": "0"}, "not one of the choices"),
        ({"rhythm": "1\n", "emotion": "0"}, "not one of the choices"),
        ({"rhythm": "1"}, "Question 2 is not answered"),
        ({}, "Questions 1 and 2 are not answered"),
        ({"rhythm": "1", "emotion": "0", "extra": "1"}, "does not ask"),
    ],
)
def test_unusable_answers_are_refused_and_nothing_is_stored(
    participant: Participant, answers: dict[str, str], words: str
) -> None:
    first = ready(participant)

    with pytest.raises(UnacceptableError, match=words):
        participant.answer(first, answers)

    assert stored(participant) == []
    assert participant.trial().token == first


def test_a_trial_ahead_of_the_present_one_is_refused(participant: Participant) -> None:
    ready(participant)
    with participant.database.reading() as session:
        following = session.scalars(select(StudySession)).one().trials[1].token

    with pytest.raises(ConflictError, match="not the page you are on"):
        participant.answer(following)
    assert stored(participant) == []


def test_there_is_no_code_before_the_last_answer_and_one_with_it(
    participant: Participant,
) -> None:
    presentations = participant.look().presentations
    for _ in range(presentations):
        with participant.database.reading() as session:
            assert session.scalars(select(StudySession)).one().completion_code is None
        last = participant.take_trial()

    situation = participant.look()
    assert situation.state == "completed"
    code = situation.completion_code
    assert code is not None
    assert len(code) == CODE_LENGTH
    assert set(code) <= set(CODE_LETTERS)
    participant.answer(last)
    assert participant.look().completion_code == code
    assert participant.another().enrol("another").begin().take_all() != code


@pytest.mark.parametrize(
    ("sent", "media_error", "stalled", "shown"),
    [
        (True, "4", 0.0, True),
        (True, "", 5.0, True),
        (True, "", 1.0, False),
        (True, "1", 0.0, False),
        (False, "4", 5.0, False),
    ],
)
def test_a_video_is_left_out_only_where_something_shows_that_it_failed(
    participant: Participant, *, sent: bool, media_error: str, stalled: float, shown: bool
) -> None:
    first = participant.trial()
    participant.clock.advance(seconds=10)
    participant.watch((0.0, 0.5), playback=Playback(stalls=1, stalled_seconds=stalled))
    if not sent:
        with participant.database.writing() as session:
            session.execute(update(Video).values(sent_at=None))

    if shown:
        participant.do(skip_unplayable, first.token, media_error=media_error)
        assert participant.trial().position == 2
        assert stored(participant) == []
        with pytest.raises(ConflictError):
            participant.answer(first.token)
    else:
        with pytest.raises(UnacceptableError, match="There is no sign yet"):
            participant.do(skip_unplayable, first.token, media_error=media_error)
        assert participant.trial().position == 1


def test_who_leaves_out_too_many_ends_without_a_code_and_frees_the_place(
    participant: Participant,
) -> None:
    for _ in range(MIN_SKIPPED_TRIALS):
        participant.leave_out()
        assert participant.look().state == "started"
    participant.leave_out()

    situation = participant.look()
    assert (situation.state, situation.completion_code) == ("unwatched", None)
    with participant.database.reading() as session:
        (known,) = session.scalars(select(StudySession))
        assert known.outcome == "unwatched"
        assert known.place is None
        last = known.trials[MIN_SKIPPED_TRIALS]
        assert not last.settled
    assert participant.look().state == "unwatched"
    with pytest.raises(ConflictError, match="Too many videos"):
        participant.answer(last.token)


def test_many_requests_at_once_store_one_answer(participant: Participant) -> None:
    first = ready(participant)

    with ThreadPoolExecutor(8) as pool:
        for done in [pool.submit(participant.answer, first) for _ in range(16)]:
            done.result()

    assert stored(participant) == [("rhythm", 1), ("emotion", -2)]
