"""The votes so far, for studies that choose their pairs by them."""

from __future__ import annotations

from collections import defaultdict

from sqlalchemy import select, tuple_
from sqlalchemy.orm import Session, aliased

from analysis.answers.columns import ANALYSED_KINDS
from studyapp.database.tables import Response, StudySession, Trial, TrialStimulus
from studyapp.researchers.exclusion_decisions import standing_exclusions
from studyapp.session.served_study import ServedStudy
from studyapp.study.design.tally import NO_VOTES, Tally


def votes_so_far(session: Session, served: ServedStudy) -> Tally:
    """Return how often each condition was preferred on the study's first question.

    Empty for studies that do not look at it. Whoever withdrew, is excluded by hand, or was asked by
    an earlier design of the study has no vote. A slight preference counts as a clear one, and no
    difference as half a vote for both.
    """
    if not served.study.follows_votes:
        return NO_VOTES
    first, second = aliased(TrialStimulus), aliased(TrialStimulus)
    rows = session.execute(
        select(first.condition, second.condition, Response.value)
        .join(Trial, Trial.id == Response.trial_id)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .join(first, (first.trial_id == Trial.id) & (first.number == 1))
        .join(second, (second.trial_id == Trial.id) & (second.number == 2))
        .where(
            Trial.kind.in_(ANALYSED_KINDS),
            Response.question == served.study.questions[0].name,
            StudySession.withdrawn_at.is_(None),
            tuple_(StudySession.arm, StudySession.arm_design).in_(list(served.arms)),
            StudySession.id.not_in(select(standing_exclusions().subquery().c.study_session_id)),
        )
    )
    votes: defaultdict[tuple[str, str], float] = defaultdict(float)
    for a, b, value in rows:
        share = 0.5 if value == 0 else float(value > 0)
        votes[b, a] += share
        votes[a, b] += 1 - share
    return dict(votes)
