from __future__ import annotations

from dataclasses import replace

from sqlalchemy import select

from studyapp.database.tables import StudySession
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.session.served_study import ServedStudy
from studyapp.session.trial_rows import count_votes
from tests.support.studies.taking_part_steps import Participant


def tally(participant: Participant, served: ServedStudy) -> dict[tuple[str, str], float]:
    with participant.database.reading() as session:
        return dict(count_votes(session, served))


def adaptive(participant: Participant) -> ServedStudy:
    """Return the study as one that follows votes, with the arms that its participants are in."""
    study = participant.served.study.model_copy(update={"comparisons": "adaptive"})
    served = replace(participant.served, study=study)
    vars(served)["arms"] = participant.served.arms
    return served


def test_analysed_answers_to_the_first_question_count(participant: Participant) -> None:
    participant.take_all()
    served = adaptive(participant)

    votes = tally(participant, served)

    # 3 main and 1 repeat; B was always preferred, whoever it was.
    assert sum(votes.values()) == 4
    assert set(votes) == {("rule_based", "mismatched"), ("mismatched", "rule_based")}


def test_no_difference_is_half_a_vote_for_both(participant: Participant) -> None:
    while participant.look().trial is not None:
        participant.take_trial({"rhythm": "0", "emotion": "2"})

    assert set(tally(participant, adaptive(participant)).values()) == {2.0}


def test_whoever_withdrew_or_is_excluded_by_hand_does_not_vote(participant: Participant) -> None:
    leaver = participant.another().enrol("another").begin()
    leaver.take_trial()
    leaver.take_trial()
    leaver.withdraw()
    served = adaptive(participant)
    assert tally(participant, served) == {}
    participant.take_all()
    voted = tally(participant, served)
    with participant.database.reading() as session:
        number = session.scalars(
            select(StudySession.id).where(StudySession.token == participant.token)
        ).one()

    for excluded, left in ((True, {}), (False, voted)):
        decide_exclusion(
            participant.database,
            participant.clock,
            number,
            excluded=excluded,
            by="Ada",
            reason="the sound was off",
        )
        assert tally(participant, served) == left
    assert sum(voted.values()) == 4


def test_nobody_votes_in_another_design_or_for_a_study_that_follows_no_votes(
    participant: Participant,
) -> None:
    participant.take_all()
    served = adaptive(participant)
    vars(served)["arms"] = {(name, "another"): arm for (name, _), arm in served.arms.items()}

    assert tally(participant, served) == tally(participant, participant.served) == {}
