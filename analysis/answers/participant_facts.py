"""What exclusion rules know of one participant; loaded without pandas, since the server asks."""

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
    trials, settled : int
        Trials of the whole study session, and how many of them the participant is done with:
        answered, or said that a video does not play.
    failed_catch, failed_attention : int or None
        Catch trials and attention checks that were failed, as the study's protocol judges them;
        None where the study has none.
    decided : str
        Why a researcher excluded the participant by hand; empty where nobody did.
    """

    trials: int
    settled: int
    failed_catch: int | None
    failed_attention: int | None
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


def _no_times() -> NDArray[np.float64]:
    return np.zeros(0)


@dataclass(frozen=True, kw_only=True, eq=False)
class ParticipantFacts:
    """The facts of one participant that rules decide from.

    Attributes
    ----------
    participant : str
        Who.
    marked : str
        Why the table itself excludes the participant; empty where it does not.
    decided : str
        As in `KnownFacts`; empty where that is not known.
    trials, settled : int or None
        As in `KnownFacts`; None where that is not known.
    failed_catch, failed_attention : int or None
        How many were failed; None where that is not known.
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
    decided: str = ""
    trials: int | None = None
    settled: int | None = None
    failed_catch: int | None = None
    failed_attention: int | None = None
    watched: float = math.nan
    seconds: NDArray[np.float64] = field(default_factory=_no_times)
    same_answers: tuple[SameAnswer, ...] | None = None
