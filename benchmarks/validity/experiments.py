"""Which kinds of studies are simulated, in which sizes and with which spreads of opinion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, get_args

from benchmarks.validity.conclusions.conclusion import Protocol
from benchmarks.validity.conclusions.decided import VERDICTS
from benchmarks.validity.conclusions.pairs import (
    EQUIVALENCE,
    HETEROGENEITY,
    MISMATCH,
    NET_PREFERENCE,
    PREFERENCES,
)
from benchmarks.validity.conclusions.ranked import RANKINGS
from benchmarks.validity.conclusions.rated import (
    AGREED_RATINGS,
    RATED_EQUIVALENCE,
    RATINGS,
)
from benchmarks.validity.conclusions.voted import VOTES
from benchmarks.validity.studies import Design, Process

SPREADS: Final = ((0.0, 0.0), (0.6, 0.0), (0.6, 0.45), (1.0, 0.8))
"""How much participants and items vary, in logits."""

FEW: Final = (12, 6, 3)
"""Items of small studies."""


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """A protocol in the designs that it is simulated with.

    Attributes
    ----------
    name : str
        For the table.
    protocol : Protocol
        What is simulated and concluded.
    designs : tuple of Design
        Their effect is the protocol's to set.
    share : float
        Of the studies asked for, how many are simulated: those that take long get fewer, those
        that are quick more.
    """

    name: str
    protocol: Protocol
    designs: tuple[Design, ...]
    share: float = 1.0


def _designs(
    participants: int, items: int, few: Sequence[int], spreads: Sequence[tuple[float, float]]
) -> tuple[Design, ...]:
    """Return studies of one size in which answers vary more and more, and some with few items."""
    crossed = [
        Design(participants=participants, items=items, effect=0.0, participant_sd=p, item_sd=i)
        for p, i in spreads
    ]
    clustered = Design(participants=25, items=items, effect=0.0, participant_sd=0.6, item_sd=0.45)
    return (*crossed, *(replace(clustered, items=count) for count in few))


OTHERS: Final = tuple(
    Design(
        participants=150 if process == "leaderboard" else 22,
        items=12,
        effect=0.0,
        participant_sd=0.6,
        item_sd=0.45,
        process=process,
    )
    for process in get_args(Process)
)
"""One size of study, with answers that come about otherwise than in a rehearsal."""

EXPERIMENTS: Final = (
    Experiment(
        name="pairs", protocol=PREFERENCES, designs=_designs(22, 24, FEW, SPREADS), share=1.0
    ),
    Experiment(
        name="pairs, mixed model", protocol=NET_PREFERENCE, designs=_designs(22, 24, FEW, SPREADS)
    ),
    Experiment(
        name="pairs, equivalence",
        protocol=EQUIVALENCE,
        designs=_designs(22, 24, FEW, SPREADS),
        share=2.0,
    ),
    Experiment(
        name="pairs, heterogeneity",
        protocol=HETEROGENEITY,
        designs=_designs(22, 24, FEW[:1], SPREADS),
        share=2.0,
    ),
    Experiment(
        name="mismatch", protocol=MISMATCH, designs=_designs(22, 24, FEW, SPREADS), share=6.0
    ),
    Experiment(name="ratings", protocol=RATINGS, designs=_designs(22, 24, FEW, SPREADS), share=2.0),
    Experiment(
        name="ratings, one taste",
        protocol=AGREED_RATINGS,
        designs=_designs(22, 24, FEW[1:], SPREADS[2:3]),
        share=2.0,
    ),
    Experiment(
        name="ratings, equivalence",
        protocol=RATED_EQUIVALENCE,
        designs=_designs(22, 24, FEW[1:], SPREADS),
        share=2.0,
    ),
    Experiment(name="votes", protocol=VOTES, designs=_designs(22, 24, FEW, SPREADS), share=3.0),
    Experiment(
        name="rankings", protocol=RANKINGS, designs=_designs(22, 8, FEW[2:], SPREADS), share=1.0
    ),
    Experiment(name="verdicts, other processes", protocol=VERDICTS, designs=OTHERS),
)
