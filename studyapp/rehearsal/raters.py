"""A simulated rater: what it sees in a pair, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from studyapp.rehearsal.chance import stream

if TYPE_CHECKING:
    from studyapp.rehearsal.population import Population

CLEAREST = 2
"""Answers run from -2, clearly A (left), to 2, clearly B (right)."""


@dataclass(frozen=True, kw_only=True)
class ShownPair:
    """What the rater's eyes tell it of one presentation.

    Attributes
    ----------
    position : int
        Which presentation of the study session it is.
    left, right : str
        The conditions under A and B.
    instructed : int or None
        The answer that the page asks for, on an attention check.
    """

    position: int
    segment: str
    left: str
    right: str
    instructed: int | None = None


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

    def utility(self, condition: str, segment: str, question: str) -> float:
        """Return how good `condition` is to this rater in `segment`, in logits."""
        draw = stream(self.seed, "taste", self.name, condition, question).standard_normal()
        return (
            self.population.quality[condition][question]
            + self.population.taste_sd * float(draw)
            + segment_fit(self.population, self.seed, condition, segment, question)
        )

    def answer(self, shown: ShownPair, question: str) -> int:
        """Return its answer to `question`, from -2 (clearly left) to 2 (clearly right)."""
        noise = stream(self.seed, "answer", self.name, shown.position, question)
        if not self.attentive:
            return int(noise.integers(-CLEAREST, CLEAREST, endpoint=True))
        if shown.instructed is not None:
            return shown.instructed
        latent = (
            self.utility(shown.right, shown.segment, question)
            - self.utility(shown.left, shown.segment, question)
            + self.side_bias
            + noise.logistic()
        )
        return int(np.searchsorted(self.population.thresholds, latent)) - CLEAREST


def segment_fit(
    population: Population, seed: int, condition: str, segment: str, question: str
) -> float:
    """Return how much better than usual `condition` does in `segment`, in logits.

    The same for every rater of a rehearsal: it is a trait of the stimulus.
    """
    draw = stream(seed, "fit", condition, segment, question).standard_normal()
    return population.fit_sd * float(draw)
