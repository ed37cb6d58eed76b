"""What exclusion rules know of one participant; loads without pandas, since the server uses it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True)
class KnownFacts:
    """What a study knows of a participant that a table of answers does not hold.

    Attributes
    ----------
    trials, settled : int or None
        Trials of the whole study session, and how many of them the participant is done with:
        answered, or said that a video does not play; None where that is not known.
    failed_catch, failed_attention : int or None
        Catch trials and attention checks that were failed; None where there are none, or that is
        not known.
    decided : str
        Why a researcher excluded the participant by hand; empty where nobody did.
    """

    trials: int | None = None
    settled: int | None = None
    failed_catch: int | None = None
    failed_attention: int | None = None
    decided: str = ""


@dataclass(frozen=True, kw_only=True)
class SameAnswer:
    """How alike one participant's answers to one question are.

    Attributes
    ----------
    question : str
        Its name.
    answers : int
        How many were given in main and repeated trials.
    share : float
        The share of the most frequent one, in (0, 1].
    """

    question: str
    answers: int
    share: float


@dataclass(frozen=True, kw_only=True, eq=False)
class ParticipantFacts(KnownFacts):
    """The facts of one participant that rules decide from.

    Attributes
    ----------
    participant : str
        Who.
    marked : str
        Why the table itself excludes the participant; empty where it does not.
    watched : float
        Mean share of the videos that was watched, over the answers of main and repeated trials,
        in [0, 1]; NaN where that is not known.
    seconds : ndarray, shape (N,)
        How long answers of main and repeated trials took, as far as that is known; ascending.
    same_answers : tuple of SameAnswer or None
        One for each question answered; None where the answers to a trial exclude one another,
        so that they are never alike.
    """

    participant: str
    marked: str = ""
    watched: float = math.nan
    seconds: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    same_answers: tuple[SameAnswer, ...] | None = None
