"""A simulated rater: how it takes part, how good each motion is to it, and what it answers."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final, Protocol

import numpy as np

from studyapp.rehearsal.simulation.population import (
    Kind,
    Population,
    kind_at,
    preference_thresholds,
    ranks,
    rating_thresholds,
    step,
)
from studyapp.study.design.trial import AnswerKey, Answers, Ask, Stimulus, Trial
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.settings.study import Study


def stream(seed: int, *event: str | int) -> np.random.Generator:
    """Return the random stream of one named event.

    The same seed and event always give the same stream, and no stream depends on which others
    were drawn before. A rehearsal therefore gives the same answers in whatever order its
    participants arrive, and whether or not it was interrupted.

    Parameters
    ----------
    seed : int
        Seed of the rehearsal.
    *event : str or int
        What happens: for example ``"taste", "static", "rhythm"``.
    """
    digest = hashlib.sha256(json.dumps([seed, *event]).encode()).digest()
    return np.random.default_rng(int.from_bytes(digest, "big"))


@lru_cache(maxsize=65_536)
def standard_normal(seed: int, *event: str | int) -> float:
    """Return the first draw of an event's stream from the standard normal distribution.

    For traits, which every answer asks for again.
    """
    return float(stream(seed, *event).standard_normal())


class SeenTrial(Trial, Protocol):
    """A trial, planned or stored, with what its page hides."""

    @property
    def position(self) -> int:
        """Which presentation of the study session it is."""

    @property
    def stimuli(self) -> tuple[Stimulus, ...]:
        """What is judged, number 1 (A) first."""


THINKS: Final = 4.0
"""Median seconds between the end of the last video and the answers."""

THINKS_SPREAD: Final = 0.4
"""Standard deviation of the logarithm of those seconds, over raters and trials."""

HASTY_THINKS: Final = 0.3
"""Median seconds of who is hasty."""

HASTY_SPARE: Final = 0.01
"""Share of each video that who is hasty watches beyond what must be watched."""

SIDE_PULL: Final = 2.5
"""Logits by which somebody side-biased prefers the side they are drawn to."""

HASTY_SIGHT: Final = 0.35
"""Share of every difference that somebody hasty sees."""

HASTY_OVERLOOKED: Final = 0.5
"""Share of attention checks that somebody hasty overlooks."""

_BLIND: Final[frozenset[Kind]] = frozenset({"careless", "straight_lining"})
"""Whose answers no video decides."""


@dataclass(frozen=True, kw_only=True)
class Rater:
    """One simulated rater, whole from its name: nothing in it changes while it answers.

    Attributes
    ----------
    population : Population
        Where it comes from.
    seed : int
        Seed of the rehearsal.
    name : str
        Tells this rater from every other one of the rehearsal.
    """

    population: Population
    seed: int
    name: str

    @cached_property
    def kind(self) -> Kind:
        """What kind of rater it is."""
        drawn = stream(self.seed, "attention", self.name).random()
        return kind_at(self.population.kinds, float(drawn))

    @cached_property
    def pull(self) -> float:
        """What its own habit adds for the right or last of the videos over the left or first."""
        if self.kind != "side_biased":
            return 0.0
        to_the_right = stream(self.seed, "habit", self.name).random() < 0.5
        return SIDE_PULL if to_the_right else -SIDE_PULL

    def leaves_at(self, trials: int) -> int | None:
        """Return at which of so many trials, from 1, it leaves; None if it stays."""
        if self.kind not in ("dropping_out", "returning"):
            return None
        return int(stream(self.seed, "leaves", self.name).integers(1, trials + 1))

    @property
    def returns(self) -> bool:
        """Whether it comes back after it has left."""
        return self.kind == "returning"

    def watches(self, coverage: float) -> float:
        """Return the share of each video that it watches if it must watch `coverage` of it."""
        return min(1.0, coverage + HASTY_SPARE) if self.kind == "hasty" else 1.0

    def thinks(self, position: int) -> float:
        """Return the seconds it takes for its answers to the trial at `position`."""
        draw = stream(self.seed, "thinks", self.name, position)
        median = HASTY_THINKS if self.kind == "hasty" else THINKS
        return median * float(draw.lognormal(0.0, THINKS_SPREAD))

    def utility(self, stimulus: Stimulus, question: str) -> float:
        """Return how good `stimulus` is to this rater, as far as it looks, in logits."""
        condition, segment = stimulus.condition, stimulus.segment
        draw = standard_normal(self.seed, "taste", self.name, condition, question)
        own = (
            self.population.quality[condition][question]
            + self.population.taste_sd * draw
            + segment_fit(self.population, self.seed, condition, segment, question)
        )
        if stimulus.speech not in (None, segment):
            own -= self._cost_of_wrong_speech(condition, segment, question)
        return HASTY_SIGHT * own if self.kind == "hasty" else own

    def obeys(self, trial: SeenTrial) -> bool:
        """Tell whether it does what the page of `trial` asks, on an attention check."""
        if trial.instructed is None or self.kind in _BLIND:
            return False
        overlooked = HASTY_OVERLOOKED if self.kind == "hasty" else self.population.overlooked
        draw = stream(self.seed, "overlooked", self.name, trial.position).random()
        return bool(draw >= overlooked)

    def prefer(self, trial: SeenTrial, ask: Ask) -> int:
        """Return its preference between the two stimuli of `trial`."""
        noise = stream(self.seed, "answer", self.name, trial.position, ask.question)
        if self.kind in _BLIND:
            return self._blindly(ask, noise)
        left, right = trial.stimuli
        people, draw = self.population, standard_normal(self.seed, "side", self.name)
        latent = (
            self.utility(right, ask.question)
            - self.utility(left, ask.question)
            + people.side_bias
            + people.side_bias_sd * draw
            + self.pull
            + noise.logistic()
        )
        return step(ask.values, preference_thresholds(self.population, len(ask.values)), latent)

    def rate(self, trial: SeenTrial, ask: Ask) -> int:
        """Return its rating of the stimulus that `ask` is about."""
        number = ask.stimulus or 1
        noise = stream(self.seed, "answer", self.name, trial.position, ask.question, number)
        if self.kind in _BLIND:
            return self._blindly(ask, noise)
        stimulus = trial.stimuli[number - 1]
        felt = self.utility(stimulus, ask.question) + self._place_value(trial, number)
        leniency = self.population.leniency_sd * standard_normal(self.seed, "leniency", self.name)
        latent = felt + leniency + noise.logistic()
        return step(ask.values, rating_thresholds(self.population, len(ask.values)), latent)

    def rank(
        self, trial: SeenTrial, question: str, *, ties: bool, first: int | None = None
    ) -> tuple[int, ...]:
        """Return the ranks it gives to the stimuli of `trial`, number 1 first.

        Parameters
        ----------
        ties : bool
            Whether stimuli may share a rank.
        first : int, optional
            Number of the stimulus that is to be put first, whatever it is like.
        """
        noise = stream(self.seed, "answer", self.name, trial.position, question)
        count = len(trial.stimuli)
        if self.kind == "straight_lining":
            forwards = stream(self.seed, "line", self.name, question).random() < 0.5
            return tuple(range(1, count + 1) if forwards else range(count, 0, -1))
        if self.kind == "careless":
            return tuple(int(rank) + 1 for rank in noise.permutation(count))
        felt = [
            self.utility(stimulus, question) + self._place_value(trial, number) + float(draw)
            for number, (stimulus, draw) in enumerate(
                zip(trial.stimuli, noise.gumbel(size=count), strict=True), start=1
            )
        ]
        if first is not None:
            felt[first - 1] = float("inf")
        return ranks(felt, tie_within=self.population.weak if ties else None)

    def reasons(self, trial: SeenTrial, ask: Ask) -> tuple[str, ...]:
        """Return the reasons it ticks beside an answer, or once for all that share them."""
        draws = stream(self.seed, "reasons", self.name, trial.position, ask.reasons_field)
        ticked = draws.random(len(ask.reasons)) < self.population.reasons
        return tuple(name for name, tick in zip(ask.reasons, ticked, strict=True) if tick)

    def _blindly(self, ask: Ask, noise: np.random.Generator) -> int:
        """Return an answer that no video decides: any, or always the same one."""
        if self.kind == "straight_lining":
            noise = stream(self.seed, "line", self.name, ask.question)
        return ask.values[int(noise.integers(len(ask.values)))]

    def _place_value(self, trial: SeenTrial, number: int) -> float:
        """Return what its habit adds to stimulus `number` for its place on the page, in logits."""
        others = len(trial.stimuli) - 1
        return self.pull * ((number - 1) / others - 0.5) if others else 0.0

    def _cost_of_wrong_speech(self, condition: str, segment: str, question: str) -> float:
        """Return how much worse this rater finds a motion with another segment's speech."""
        draw = standard_normal(self.seed, "belonging", self.name, condition, question)
        return (
            self.population.belonging[condition][question]
            + self.population.participant_sd * draw
            + speech_fit(self.population, self.seed, condition, segment, question)
        )


def segment_fit(
    population: Population, seed: int, condition: str, segment: str, question: str
) -> float:
    """Return how much better than usual `condition` does in `segment`, in logits.

    The same for every rater of a rehearsal: it is a trait of the stimulus.
    """
    return population.fit_sd * standard_normal(seed, "fit", condition, segment, question)


def speech_fit(
    population: Population, seed: int, condition: str, segment: str, question: str
) -> float:
    """Return how much more than usual another speech spoils a motion, in logits.

    The same for every rater of a rehearsal, as the other speech of a segment is.
    """
    return population.item_sd * standard_normal(seed, "other speech", condition, segment, question)


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
