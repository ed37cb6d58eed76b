"""The kinds of people that a rehearsal simulates."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final, Literal

Kind = Literal[
    "careless",
    "hasty",
    "side_biased",
    "straight_lining",
    "dropping_out",
    "returning",
    "double_clicking",
    "attentive",
]

KINDS: Final[tuple[Kind, ...]] = (
    *("careless", "hasty", "side_biased", "straight_lining"),
    *("dropping_out", "returning", "double_clicking", "attentive"),
)
"""All of them, in the order in which shares of the participants are laid end to end; those who are
left over are attentive."""

UNSOUND: Final[frozenset[Kind]] = frozenset({"careless", "hasty", "side_biased", "straight_lining"})
"""Kinds whose answers say less than those of the attentive, or nothing: an analysis is better off
without them. All others judge as the attentive do."""

DESCRIPTIONS: Final[Mapping[Kind, str]] = MappingProxyType(
    {
        "attentive": "watch, and answer what they prefer",
        "hasty": "watch as little as they may, answer at once, see little",
        "side_biased": "are drawn to one side",
        "straight_lining": "give the same answer again and again",
        "careless": "answer at random",
        "dropping_out": "leave on the way, for good",
        "returning": "leave on the way and come back",
        "double_clicking": "press every button twice",
    }
)
"""What each does, in words."""


def kind_at(shares: Mapping[Kind, float], drawn: float) -> Kind:
    """Return the kind of a rater for whom the number `drawn`, in [0, 1), was drawn."""
    end = 0.0
    for kind in KINDS[:-1]:
        end += shares.get(kind, 0.0)
        if drawn < end:
            return kind
    return KINDS[-1]
