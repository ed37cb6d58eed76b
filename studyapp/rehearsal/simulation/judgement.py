"""How a simulated rater takes part, and all that it answers on the page of one trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from studyapp.rehearsal.simulation.raters import Rater, SeenTrial, stream
from studyapp.study.design.trial import AnswerKey, Answers, Ask
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.settings.study import Study

THINKS: Final = 4.0
"""Median seconds between the end of the last video and the answers."""

THINKS_SPREAD: Final = 0.4
"""Standard deviation of the logarithm of those seconds, over raters and trials."""

HASTY_THINKS: Final = 0.3
"""Median seconds of who is hasty."""

HASTY_SPARE: Final = 0.01
"""Share of each video that who is hasty watches beyond what must be watched."""


@dataclass(frozen=True, kw_only=True)
class Conduct:
    """How one rater takes part.

    Attributes
    ----------
    rater : Rater
        Who.
    trials : int
        Trials of its study session, at least 1.
    coverage : float
        Share of each video that must be watched, in [0, 1].
    """

    rater: Rater
    trials: int
    coverage: float

    @cached_property
    def leaves_at(self) -> int | None:
        """Position, from 1, of the trial at whose page it leaves; None where it stays."""
        if self.rater.kind not in ("dropping_out", "returning"):
            return None
        chance = stream(self.rater.seed, "leaves", self.rater.name)
        return int(chance.integers(1, self.trials + 1))

    @property
    def returns(self) -> bool:
        """Whether it comes back after it has left."""
        return self.rater.kind == "returning"

    @property
    def clicks_twice(self) -> bool:
        """Whether it presses every button twice."""
        return self.rater.kind == "double_clicking"

    @property
    def watches(self) -> float:
        """Share of each video that it watches, in [0, 1]."""
        return min(1.0, self.coverage + HASTY_SPARE) if self._is_hasty else 1.0

    def thinks(self, position: int) -> float:
        """Return the seconds it takes for its answers to the trial at `position`."""
        draw = stream(self.rater.seed, "thinks", self.rater.name, position)
        median = HASTY_THINKS if self._is_hasty else THINKS
        return median * float(draw.lognormal(0.0, THINKS_SPREAD))

    @property
    def _is_hasty(self) -> bool:
        return self.rater.kind == "hasty"


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
