from __future__ import annotations

from dataclasses import replace

from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.session.enrolment import count_votes
from studyapp.session.served_study import ServedStudy
from tests.support.read_once import read_once
from tests.support.studies.taking_part_steps import Participant


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
