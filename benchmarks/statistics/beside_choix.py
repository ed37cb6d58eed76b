"""Bradley-Terry strengths beside choix's `ilsr_pairwise`."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Final

import numpy as np

from analysis.stats.strengths.bradley_terry import bradley_terry
from analysis.stats.strengths.votes import Votes
from benchmarks.statistics.clock import timed

CONDITIONS: Final = 10
PARTICIPANTS: Final = 1000


@dataclass(frozen=True, kw_only=True)
class BesideChoix:
    """The same strengths by both.

    Attributes
    ----------
    seconds, seconds_choix : float
        Processor time of each; ours includes the clustered errors, which choix has not.
    strengths_apart : float
        Largest difference of a log strength.
    """

    seconds: float
    seconds_choix: float
    strengths_apart: float

    @property
    def times_faster(self) -> float:
        """Choix's time over ours."""
        return self.seconds_choix / self.seconds


def why_not_choix() -> str:
    """Say that choix is missing; empty where it is not."""
    return "" if importlib.util.find_spec("choix") else "choix is not installed"


def made_votes(count: int) -> Votes:
    """Return votes without ties, which choix does not know."""
    chance = np.random.default_rng(0)
    strengths = chance.normal(0, 0.7, CONDITIONS)
    left = chance.integers(CONDITIONS, size=count)
    right = (left + chance.integers(1, CONDITIONS, size=count)) % CONDITIONS
    won = chance.logistic(size=count) < strengths[left] - strengths[right]
    return Votes(
        conditions=tuple("abcdefghij"),
        left=left.astype(np.intp),
        right=right.astype(np.intp),
        outcome=np.where(won, 1, -1).astype(np.intp),
        participant=chance.integers(PARTICIPANTS, size=count).astype(np.intp),
    )


def beside_choix(votes: Votes, *, turns: int = 5) -> BesideChoix:
    """Find the strengths of `votes` here and by choix."""
    # A copy each time: votes remember what was counted of them.
    ours, seconds = timed(lambda: bradley_terry(replace(votes), left=False), turns=turns)
    won = votes.outcome > 0
    pairs = np.column_stack(
        [np.where(won, votes.left, votes.right), np.where(won, votes.right, votes.left)]
    ).tolist()
    choix = import_module("choix")
    theirs, theirs_seconds = timed(lambda: choix.ilsr_pairwise(CONDITIONS, pairs))
    return BesideChoix(
        seconds=seconds,
        seconds_choix=theirs_seconds,
        strengths_apart=float(np.abs(theirs - np.mean(theirs) - ours.strengths).max()),
    )
