from __future__ import annotations

from dataclasses import replace

from sqlalchemy import select

from studyapp.database.tables import StudySession
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.session.served_study import ServedStudy
from studyapp.session.trial_rows import votes_so_far
from tests.studyapp.taking_part_steps import Participant


def tally(participant: Participant, served: ServedStudy) -> dict[tuple[str, str], float]:
    with participant.database.reading() as session:
        return dict(votes_so_far(session, served))


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


def test_who_withdrew_does_not_vote(participant: Participant) -> None:
    for _ in range(3):
        participant.take_trial()
    participant.withdraw()

    assert tally(participant, adaptive(participant)) == {}


def test_who_is_excluded_by_hand_does_not_vote_until_reinstated(participant: Participant) -> None:
    participant.take_all()
    served, voted = adaptive(participant), tally(participant, adaptive(participant))
    with participant.database.reading() as session:
        number = session.scalars(select(StudySession.id)).one()

    def decide(*, excluded: bool) -> None:
        decide_exclusion(
            participant.database,
            participant.clock,
            number,
            excluded=excluded,
            by="Ada",
            reason="the sound was off",
        )

    decide(excluded=True)
    assert tally(participant, served) == {}
    decide(excluded=False)
    assert tally(participant, served) == voted != {}


def test_who_was_asked_by_an_earlier_design_does_not_vote(participant: Participant) -> None:
    participant.take_all()
    served = adaptive(participant)
    assert tally(participant, served) != {}

    vars(served)["arms"] = {(name, "another"): arm for (name, _), arm in served.arms.items()}

    assert tally(participant, served) == {}


def test_other_studies_look_at_no_votes(participant: Participant) -> None:
    participant.take_all()

    assert tally(participant, participant.served) == {}
