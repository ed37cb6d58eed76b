"""All that a simulated rater answers on the page of one trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.simulation.sight import SeenTrial
from studyapp.study.design.asking import AnswerKey, Answers, Ask
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """What one rater answers to one trial.

    Attributes
    ----------
    asks : tuple of Ask
        What the trial asks for.
    values : mapping of AnswerKey to int
        An answer to each.
    reasons : mapping of AnswerKey to tuple of str
        What is ticked beside them.
    """

    asks: tuple[Ask, ...]
    values: Answers
    reasons: Mapping[AnswerKey, tuple[str, ...]]

    def fields(self) -> dict[str, tuple[str, ...]]:
        """Return the fields of the page's form with these answers."""
        fields = {ask.field: (str(self.values[ask.key]),) for ask in self.asks}
        ticked = {
            ask.reasons_field: self.reasons[ask.key]
            for ask in self.asks
            if self.reasons.get(ask.key)
        }
        return fields | ticked


def judge(study: Study, rater: Rater, trial: SeenTrial) -> Judgement:
    """Return what `rater` answers to `trial`; it goes together as `study` demands."""
    asks = study.asks(trial)
    if isinstance(study, RankingStudy):
        values = _ranked(study, rater, trial, asks)
    elif rater.obeys(trial):
        values = {ask.key: _obedient(study, trial, ask) for ask in asks}
    elif study.asks_each_stimulus:
        values = {ask.key: rater.rate(trial, ask) for ask in asks}
    else:
        values = {ask.key: rater.prefer(trial, ask) for ask in asks}
    reasons = {ask.key: rater.reasons(trial, ask) for ask in asks if ask.reasons}
    return Judgement(asks=asks, values=values, reasons=reasons)


def _ranked(
    study: RankingStudy, rater: Rater, trial: SeenTrial, asks: tuple[Ask, ...]
) -> dict[AnswerKey, int]:
    first = trial.instructed if rater.obeys(trial) else None
    return {
        (question, number): rank
        for question in dict.fromkeys(ask.question for ask in asks)
        for number, rank in enumerate(
            rater.rank(trial, question, ties=study.ties, first=first), start=1
        )
    }


def _obedient(study: Study, trial: SeenTrial, ask: Ask) -> int:
    """Return the answer that an attention check asks for: of those that are right, the middle."""
    right = [value for value in ask.values if not study.disobeys(trial, {ask.key: value})]
    return right[len(right) // 2]
