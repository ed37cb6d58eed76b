"""Conclusions about the first of several conditions that are shown in pairs."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from analysis.stats.strength_models import Votes, bradley_terry
from benchmarks.validity.conclusions.conclusion import (
    RANKS_HOLD,
    Conclusion,
    Protocol,
    of_error,
    of_ranks,
    of_two_way,
)
from benchmarks.validity.studies import Design, judgements, true_outcomes, votes

VOTED: Final = ("a", "b", "c", "d")

EXPECTED: Final = 3_000
"""Votes per pair of conditions, divided as expected, from which the truth is estimated."""

STRENGTH: Final = "Bradley-Terry strength, two-way clustered"
RANKS: Final = "Bradley-Terry ranks of all conditions"
BY_PARTICIPANT: Final = "Bradley-Terry strength, clustered by participant"
NAIVE: Final = "Bradley-Terry strength, errors of the model"


def conclude_votes(design: Design, generator: np.random.Generator) -> Mapping[str, Conclusion]:
    """Return the conclusions of one study."""
    judged = judgements(design, len(VOTED), generator)
    left, right, outcome = votes(judged, generator)
    found = bradley_terry(
        Votes(
            conditions=VOTED,
            left=left,
            right=right,
            outcome=outcome,
            participant=judged.participants,
            segment=judged.items,
        )
    )
    return {
        STRENGTH: of_two_way(found.strengths, found.two_way),
        RANKS: of_ranks(found.strengths, found.two_way, effect=design.effect),
        BY_PARTICIPANT: of_error(found.strengths[0], found.errors[0]),
        NAIVE: of_error(found.strengths[0], found.errors_by_model[0]),
    }


def _truths(design: Design) -> Mapping[str, float]:
    """Return the limits of the strengths for many participants and items."""
    rows = []
    for left in range(len(VOTED)):
        for right in range(len(VOTED)):
            if left != right:
                effect = design.effect * ((left == 0) - (right == 0))
                shares = true_outcomes(replace(design, effect=effect))
                counts = np.rint(EXPECTED * np.array(shares)).astype(np.intp)
                rows.append(np.repeat([[left, right, won] for won in (1, 0, -1)], counts, axis=0))
    every = np.concatenate(rows)
    found = bradley_terry(
        Votes(
            conditions=VOTED,
            left=every[:, 0],
            right=every[:, 1],
            outcome=every[:, 2],
            participant=np.arange(len(every)),
            segment=np.zeros(len(every), np.intp),
        )
    )
    names = (STRENGTH, BY_PARTICIPANT, NAIVE)
    return dict.fromkeys(names, float(found.strengths[0])) | {RANKS: RANKS_HOLD}


VOTES: Final = Protocol(conclude=conclude_votes, truths=_truths, naive=(NAIVE,))
