"""What is stored of answers, and which of them count as votes."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import select, update

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Response, Video
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.session.answers import skip_unplayable
from studyapp.session.ending import MIN_SKIPPED_TRIALS
from studyapp.session.enrolment import count_votes
from studyapp.session.refusal import ConflictError, TooMuchWatchedError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.trials import ShownTrial
from studyapp.session.watch_evidence import Playback
from studyapp.study.settings.questions import Reason
from studyapp.study.settings.recruitment import is_guessable
from tests.support.read_once import read_once
from tests.support.studies.exported import responses_table
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant, SetClock

Arrive = Callable[[str], Participant]


def stored(participant: Participant) -> list[tuple[str, int]]:
    rows = found_in(participant.database, select(Response).order_by(Response.id))
    return [(row.question, row.value) for row in rows]


def trials_of(participant: Participant) -> list[str]:
    with participant.database.reading() as session:
        return [trial.token for trial in session.scalars(select(StudySession)).one().trials]


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
    with pytest.raises(ConflictError, match="not the page you are on"):
        participant.answer(trials_of(participant)[1])

    participant.answer(first)

    assert stored(participant) == [("rhythm", 1), ("emotion", -2)]
    assert participant.trial().position == 2
    with participant.database.reading() as session:
        trial = session.scalars(select(StudySession)).one().trials[0]
        assert trial.answered_at == participant.clock.now()
        assert trial.seconds == 7.0


NO_CHOICE = "not one of the choices"
UNUSABLE: list[tuple[dict[str, str], str]] = [
    *(({"rhythm": each, "emotion": "0"}, NO_CHOICE) for each in ("3", "１", "1.0", "-0", "1\n")),
    ({"rhythm": "1", "emotion": "0", "extra": "1"}, NO_CHOICE),
    ({"rhythm": "1"}, "not answered yet: 2"),
    ({}, "not answered yet: 1 and 2"),
]


def test_unusable_answers_are_refused_and_nothing_is_stored(participant: Participant) -> None:
    first = participant.trial().token
    with pytest.raises(
        UnacceptableError, match=r"^About 2 s .* not been .* switch ad blockers off"
    ):
        participant.answer(first, {"rhythm": "1", "emotion": "0"})
    assert ready(participant) == first

    for answers, words in UNUSABLE:
        with pytest.raises(UnacceptableError, match=words):
            participant.answer(first, answers)

    assert stored(participant) == []
    assert participant.trial().token == first


@pytest.fixture
def arrive(finished_study: Callable[[str], Path], database: Database, clock: SetClock) -> Arrive:
    """Return a function that brings a participant to the first trial of a protocol's study."""

    def make(protocol: str) -> Participant:
        served = ServedStudy.read(finished_study(protocol))
        return Participant(database, served, clock).in_study(served).enrol().begin()

    return make


def ranks(shown: ShownTrial) -> dict[str, str | list[str]]:
    """Return an answer for every field: ranks in the order of the page."""
    return {ask.field: str(ask.stimulus) for ask in shown.asks}


UNUSABLE_RANKINGS: list[tuple[dict[str, str | list[str]], str]] = [
    ({"realism:2": "1"}, "same rank"),
    ({"realism:2": "3"}, NO_CHOICE),
    ({"realism:2": []}, "not answered yet: 1 about B"),
    ({"realism:2": [""]}, "not answered yet: 1 about B"),
    ({"realism:0": "1"}, NO_CHOICE),
    ({"realism:2": ["1", "2"]}, NO_CHOICE),
    ({"realism:reasons": "face"}, NO_CHOICE),
    ({"realism:1:reasons": "face"}, NO_CHOICE),
]


def test_a_ranking_is_an_order_with_its_reason_stored_at_each_rank(arrive: Arrive) -> None:
    participant = arrive("ranking")
    study = participant.served.study
    reason = Reason(name="hands", text="the hands")
    asked = tuple(q.model_copy(update={"reasons": (reason,)}) for q in study.questions)
    participant.served = replace(
        participant.served, study=study.model_copy(update={"questions": asked})
    )
    shown = participant.watch_all()
    for changes, words in UNUSABLE_RANKINGS:
        with pytest.raises(UnacceptableError, match=words):
            participant.answer(shown.token, ranks(shown) | changes)
    fields = ranks(shown) | {"realism:reasons": "hands"}

    participant.answer(shown.token, fields)
    participant.answer(shown.token, fields)

    table = read_once(participant.database, responses_table)
    assert set(table["question"]) == {"realism"}
    assert table["reasons"].tolist() == ["hands"] * len(shown.asks)
    with pytest.raises(ConflictError):
        participant.answer(shown.token, ranks(shown))


def test_videos_cannot_be_watched_simultaneously(arrive: Arrive) -> None:
    participant = arrive("rating")
    _, second, _ = participant.trial().videos
    participant.clock.advance(seconds=2)
    participant.watch((0.0, 2.0))

    with pytest.raises(TooMuchWatchedError, match="than there was time for"):
        participant.report(second.token, (0.0, 2.0))


def test_the_code_appears_with_the_last_answer_and_does_not_change(
    participant: Participant,
) -> None:
    for _ in range(participant.look().presentations):
        assert participant.stored().completion_code is None
        last = participant.take_trial()

    situation = participant.look()
    assert situation.state == "completed"
    code = situation.completion_code
    assert not is_guessable(code or "")
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
def test_a_video_can_be_skipped_only_with_evidence_of_failure(
    participant: Participant, *, sent: bool, media_error: str, stalled: float, shown: bool
) -> None:
    first = participant.trial()
    participant.clock.advance(seconds=10)
    participant.watch((0.0, 0.5), playback=Playback(stalls=1, stalled_seconds=stalled))
    if not sent:
        with participant.database.writing() as session:
            session.execute(update(Video).values(sent_at=None))

    if shown:
        for _ in range(2):
            participant.do(skip_unplayable, first.token, media_error=media_error)
        with pytest.raises(ConflictError):
            participant.answer(first.token)
    else:
        with pytest.raises(UnacceptableError, match="There is no sign yet"):
            participant.do(skip_unplayable, first.token, media_error=media_error)
    assert participant.trial().position == (2 if shown else 1)
    assert stored(participant) == []


def test_skipping_too_many_videos_ends_without_a_code_and_frees_the_place(
    participant: Participant,
) -> None:
    last = trials_of(participant)[MIN_SKIPPED_TRIALS]
    for _ in range(MIN_SKIPPED_TRIALS):
        participant.leave_out()
        assert participant.look().state == "started"
    participant.leave_out()

    situation = participant.look()
    assert (situation.state, situation.completion_code) == ("unwatched", None)
    with participant.database.reading() as session:
        row = session.scalars(select(StudySession)).one()
        assert (row.outcome, row.place) == ("unwatched", None)
        assert not row.trials[MIN_SKIPPED_TRIALS].settled
    with pytest.raises(ConflictError, match="not the page you are on"):
        participant.answer(last)


def test_many_requests_at_once_store_one_answer(participant: Participant) -> None:
    first = ready(participant)

    with ThreadPoolExecutor(8) as pool:
        for done in [pool.submit(participant.answer, first) for _ in range(16)]:
            done.result()

    assert stored(participant) == [("rhythm", 1), ("emotion", -2)]


def tally(participant: Participant, served: ServedStudy) -> dict[tuple[str, str], float]:
    return dict(read_once(participant.database, count_votes, served))


def adaptive(participant: Participant) -> ServedStudy:
    """Return the study as one that follows votes, with the arms that its participants are in."""
    study = participant.served.study.model_copy(update={"comparisons": "adaptive"})
    served = replace(participant.served, study=study)
    vars(served)["arms"] = participant.served.arms
    return served


def test_no_difference_counts_as_half_a_vote_each(participant: Participant) -> None:
    while participant.look().trial is not None:
        participant.take_trial({"rhythm": "0", "emotion": "2"})

    assert set(tally(participant, adaptive(participant)).values()) == {2.0}


def test_votes_are_first_answers_of_analysed_participants_in_this_design(
    participant: Participant,
) -> None:
    leaver = participant.another().enrol("another").begin()
    leaver.take_trial()
    leaver.take_trial()
    leaver.withdraw()
    served = adaptive(participant)
    assert tally(participant, served) == {}

    participant.take_all()

    voted = tally(participant, served)
    # 3 main and 1 repeat; B was always preferred, whoever it was.
    assert sum(voted.values()) == 4
    assert set(voted) == {("rule_based", "mismatched"), ("mismatched", "rule_based")}
    number, decided = participant.stored().id, {"by": "Ada", "reason": "the sound was off"}
    for excluded, votes in ((True, {}), (False, voted)):
        decide_exclusion(
            participant.database, participant.clock, number, excluded=excluded, **decided
        )
        assert tally(participant, served) == votes
    assert tally(participant, participant.served) == {}
    vars(served)["arms"] = {(name, "another"): arm for (name, _), arm in served.arms.items()}
    assert tally(participant, served) == {}
