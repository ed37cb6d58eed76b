"""The simulated kinds of studies, with their sizes and spreads of opinion."""

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
    """A protocol and its simulated designs.

    Attributes
    ----------
    name : str
        Name in the table.
    protocol : Protocol
        The kind of study.
    designs : tuple of Design
        Designs, whose effects the protocol sets.
    share : float
        Simulated studies per requested study: fewer for slow kinds, more for quick ones.
    """

    name: str
    protocol: Protocol
    designs: tuple[Design, ...]
    share: float


def _designs(
    *,
    items: int = 24,
    few: Sequence[int] = FEW,
    spreads: Sequence[tuple[float, float]] = SPREADS,
) -> tuple[Design, ...]:
    """Return studies of one size with increasingly varied answers, and some with few items."""
    crossed = [
        Design(participants=22, items=items, effect=0.0, participant_sd=p, item_sd=i)
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
"""One size of study, with answers that arise differently from those in a rehearsal."""

_ONE_TASTE: Final = _designs(few=FEW[1:], spreads=SPREADS[2:3])

EXPERIMENTS: Final = tuple(
    Experiment(name=name, protocol=protocol, designs=designs, share=share)
    for name, protocol, designs, share in (
        ("pairs", PREFERENCES, _designs(), 1.0),
        ("pairs, mixed model", NET_PREFERENCE, _designs(), 1.0),
        ("pairs, equivalence", EQUIVALENCE, _designs(), 2.0),
        ("pairs, heterogeneity", HETEROGENEITY, _designs(few=FEW[:1]), 2.0),
        ("mismatch", MISMATCH, _designs(), 6.0),
        ("ratings", RATINGS, _designs(), 2.0),
        ("ratings, one taste", AGREED_RATINGS, _ONE_TASTE, 2.0),
        ("ratings, equivalence", RATED_EQUIVALENCE, _designs(few=FEW[1:]), 2.0),
        ("votes", VOTES, _designs(), 3.0),
        ("rankings", RANKINGS, _designs(items=8, few=FEW[2:]), 1.0),
        ("verdicts, other processes", VERDICTS, OTHERS, 1.0),
    )
)
