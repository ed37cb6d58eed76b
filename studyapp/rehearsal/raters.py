"""A simulated rater: how good each motion is to it, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from studyapp.rehearsal.chance import stream
from studyapp.rehearsal.scales import preference_thresholds, ranks, rating_thresholds, step

if TYPE_CHECKING:
    from studyapp.design.asking import Ask
    from studyapp.design.stimulus import Stimulus
    from studyapp.rehearsal.population import Population
    from studyapp.rehearsal.sight import SeenTrial


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
    def attentive(self) -> bool:
        """Whether it looks at all; else every answer is random."""
        share = self.population.inattentive
        return bool(stream(self.seed, "attention", self.name).random() >= share)

    @cached_property
    def side_bias(self) -> float:
        """Its own pull towards the right video, in logits."""
        draw = stream(self.seed, "side", self.name).standard_normal()
        return self.population.side_bias + self.population.side_bias_sd * float(draw)

    @cached_property
    def leniency(self) -> float:
        """How much better than others it rates everything, in logits."""
        draw = stream(self.seed, "leniency", self.name).standard_normal()
        return self.population.leniency_sd * float(draw)

    def utility(self, stimulus: Stimulus, question: str) -> float:
        """Return how good `stimulus` is to this rater, in logits."""
        condition, segment = stimulus.condition, stimulus.segment
        draw = stream(self.seed, "taste", self.name, condition, question).standard_normal()
        own = (
            self.population.quality[condition][question]
            + self.population.taste_sd * float(draw)
            + segment_fit(self.population, self.seed, condition, segment, question)
        )
        if stimulus.speech in (None, segment):
            return own
        return own - self._cost_of_wrong_speech(condition, segment, question)

    def obeys(self, trial: SeenTrial) -> bool:
        """Tell whether it does what the page of `trial` asks, on an attention check."""
        if trial.instructed is None or not self.attentive:
            return False
        draw = stream(self.seed, "overlooked", self.name, trial.position).random()
        return bool(draw >= self.population.overlooked)

    def prefer(self, trial: SeenTrial, ask: Ask) -> int:
        """Return its preference between the two stimuli of `trial`."""
        noise = stream(self.seed, "answer", self.name, trial.position, ask.question)
        if not self.attentive:
            return ask.values[int(noise.integers(len(ask.values)))]
        left, right = trial.stimuli
        latent = (
            self.utility(right, ask.question)
            - self.utility(left, ask.question)
            + self.side_bias
            + noise.logistic()
        )
        return step(ask.values, preference_thresholds(self.population, len(ask.values)), latent)

    def rate(self, trial: SeenTrial, ask: Ask) -> int:
        """Return its rating of the stimulus that `ask` is about."""
        number = ask.stimulus or 1
        noise = stream(self.seed, "answer", self.name, trial.position, ask.question, number)
        if not self.attentive:
            return ask.values[int(noise.integers(len(ask.values)))]
        stimulus = trial.stimuli[number - 1]
        latent = self.utility(stimulus, ask.question) + self.leniency + noise.logistic()
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
        if not self.attentive:
            return tuple(int(rank) + 1 for rank in noise.permutation(count))
        felt = [
            self.utility(stimulus, question) + float(draw)
            for stimulus, draw in zip(trial.stimuli, noise.gumbel(size=count), strict=True)
        ]
        if first is not None:
            felt[first - 1] = float("inf")
        return ranks(felt, tie_within=self.population.weak if ties else None)

    def reasons(self, trial: SeenTrial, ask: Ask) -> tuple[str, ...]:
        """Return the reasons it ticks beside an answer, or once for all that share them."""
        draws = stream(self.seed, "reasons", self.name, trial.position, ask.reasons_field)
        ticked = draws.random(len(ask.reasons)) < self.population.reasons
        return tuple(name for name, tick in zip(ask.reasons, ticked, strict=True) if tick)

    def _cost_of_wrong_speech(self, condition: str, segment: str, question: str) -> float:
        """Return how much worse this rater finds a motion with another segment's speech."""
        draw = stream(self.seed, "belonging", self.name, condition, question).standard_normal()
        return (
            self.population.belonging[condition][question]
            + self.population.participant_sd * float(draw)
            + speech_fit(self.population, self.seed, condition, segment, question)
        )


def segment_fit(
    population: Population, seed: int, condition: str, segment: str, question: str
) -> float:
    """Return how much better than usual `condition` does in `segment`, in logits.

    The same for every rater of a rehearsal: it is a trait of the stimulus.
    """
    draw = stream(seed, "fit", condition, segment, question).standard_normal()
    return population.fit_sd * float(draw)


def speech_fit(
    population: Population, seed: int, condition: str, segment: str, question: str
) -> float:
    """Return how much more than usual another speech spoils a motion, in logits.

    The same for every rater of a rehearsal, as the other speech of a segment is.
    """
    draw = stream(seed, "other speech", condition, segment, question).standard_normal()
    return population.item_sd * float(draw)
