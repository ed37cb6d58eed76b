"""What the answers of a rehearsal say, beside what its raters were given to prefer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from sqlalchemy import select
from sqlalchemy.orm import selectinload

from analysis.trial_kinds import ANALYSED_KINDS
from studyapp.definition.protocols.pairwise import comparison_name
from studyapp.definition.protocols.ranking import RankingStudy
from studyapp.definition.study import Study
from studyapp.models import Response, StudySession, Trial, TrialStimulus
from studyapp.rehearsal.record import Expected, Measure
from studyapp.services.database import Database
from studyapp.services.exclusion import is_excluded

Key = tuple[str, str, Measure, str]
"""Part, question, measure, and what it is about."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One number, as it was put in and as the answers say.

    Attributes
    ----------
    part, question, measure, about
        As in `Expected`.
    put_in : float or None
        What very many attentive raters would say of the study's segments; None where that was
        not computed.
    found : float
        The mean over `answers`.
    answers : int
        Analysed answers it rests on.
    """

    part: str
    question: str
    measure: Measure
    about: str
    put_in: float | None
    found: float
    answers: int


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What a rehearsal's answers say.

    Attributes
    ----------
    excluded : int
        Finished participants whom the study's own rules leave out.
    rows : tuple of Finding
        In the order of what was expected.
    """

    excluded: int
    rows: tuple[Finding, ...]


def findings(database: Database, study: Study, expected: Sequence[Expected]) -> Findings:
    """Return plain means of the analysed answers of those who finished and are not excluded."""
    scores: dict[Key, list[float]] = {}
    excluded = 0
    with database.reading() as session:
        sittings = session.scalars(
            select(StudySession)
            .where(StudySession.completed_at.is_not(None))
            .order_by(StudySession.id)
            .options(
                selectinload(StudySession.trials).selectinload(Trial.responses),
                selectinload(StudySession.trials).selectinload(Trial.stimuli),
            )
        )
        for sitting in sittings:
            if is_excluded(study, sitting):
                excluded += 1
                continue
            for trial in sitting.trials:
                if trial.kind in ANALYSED_KINDS:
                    for response in trial.responses:
                        key, score = _scored(study, sitting.conditions, trial, response)
                        scores.setdefault(key, []).append(score)
    known = {(e.part, e.question, e.measure, e.about): e for e in expected}
    order = [*known, *sorted(set(scores) - set(known))]
    return Findings(
        excluded=excluded,
        rows=tuple(_finding(key, known.get(key), scores[key]) for key in order if key in scores),
    )


def _finding(key: Key, expected: Expected | None, scores: Sequence[float]) -> Finding:
    part, question, measure, about = key
    return Finding(
        part=part,
        question=question,
        measure=measure,
        about=about,
        put_in=None if expected is None else expected.value_on_these_segments,
        found=fmean(scores),
        answers=len(scores),
    )


def _scored(
    study: Study, conditions: Sequence[str], trial: Trial, response: Response
) -> tuple[Key, float]:
    """Return what `response` measures, and its share in the mean."""
    shown = {stimulus.number: stimulus for stimulus in trial.stimuli}
    if response.stimulus is not None:
        measure: Measure = "mean_rank" if isinstance(study, RankingStudy) else "mean_rating"
        about = shown[response.stimulus].condition
        return (trial.part, response.question, measure, about), float(response.value)
    first, second = _in_order(shown[1], shown[2], conditions)
    for_first = response.value * (1 if first is shown[2] else -1)
    score = 0.5 if response.value == 0 else float(for_first > 0)
    if first.condition == second.condition:
        return (trial.part, response.question, "own_speech", first.condition), score
    pair = comparison_name(first.condition, second.condition)
    return (trial.part, response.question, "win_share", pair), score


def _in_order(
    left: TrialStimulus, right: TrialStimulus, conditions: Sequence[str]
) -> tuple[TrialStimulus, TrialStimulus]:
    """Return the stimulus whose wins are counted first: the study's first, or with its speech."""

    def rank(shown: TrialStimulus) -> tuple[int, bool]:
        return conditions.index(shown.condition), shown.speech != shown.segment

    return (left, right) if rank(left) <= rank(right) else (right, left)
