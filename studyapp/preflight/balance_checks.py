"""Whether the study's planned participants see everything equally often and in every order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from motion.listing import listed
from studyapp.preflight.balance import (
    Share,
    counts_of_pairs,
    counts_of_segments,
    orders_of_pairs,
    places_of_conditions,
)
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import MOST_PLACES, Material

SHARE_OFF: Final = 0.05
"""How far a share may be from an even one."""

BEYOND_CHANCE: Final = 3.5
"""Standard deviations from which a share is no chance, of the dozens that are looked at."""

TIMES: Final = 1.5
"""How many times as often as another one something may be shown."""


def balance_findings(material: Material) -> Iterator[Finding]:
    """Count what the planned participants will see, and say where that is uneven."""
    planned = material.planned
    if not any(plan for _, plans in planned for plan in plans):
        return
    if material.study.follows_votes:
        yield finding(
            "balance",
            "pairs are chosen as answers come, so that what participants will see cannot be "
            "counted beforehand",
        )
        return
    places: list[Share] = []
    orders: list[Share] = []
    for _, plans in planned:
        places += places_of_conditions(plans)
        orders += orders_of_pairs(plans)
    together = [plan for _, plans in planned for plan in plans]
    segments = counts_of_segments(together, list(material.by_name))
    yield finding("balance", _balance(material, places, segments))
    yield from _share_findings(places, orders)
    yield from _count_findings(material, segments)


def _balance(material: Material, places: list[Share], segments: dict[str, int]) -> str:
    participants = sum(len(plans) for _, plans in material.planned)
    most = max(arm.places for arm in material.study.arms)
    of = f" (the first {MOST_PLACES} of each arm)" if most > MOST_PLACES else ""
    used = [times for times in segments.values() if times]
    said = f"{participants} planned participants{of} judge each segment {_between(used)} times"
    if places:
        off = max(places, key=lambda share: share.off)
        said += (
            f"; {off.what} in {off.share:.0%} of {off.of} trials, which is farthest from an even "
            f"{off.even:.0%}"
        )
    return said


def _share_findings(places: Iterable[Share], orders: Iterable[Share]) -> Iterator[Finding]:
    for name, shares, of in (
        ("sides-uneven", places, "trials"),
        ("orders-uneven", orders, "participants"),
    ):
        for share in shares:
            if share.off > SHARE_OFF and share.deviations > BEYOND_CHANCE:
                yield finding(
                    name,
                    f"{share.what} in {share.share:.0%} of {share.of} {of}, instead of "
                    f"{share.even:.0%}",
                    where="seed",
                )


def _count_findings(material: Material, segments: dict[str, int]) -> Iterator[Finding]:
    unused = [name for name, times in segments.items() if not times]
    if unused:
        yield finding(
            "segments-unused", f"nobody judges {_some(unused)}", where="speech/segments.csv"
        )
    used = {name: times for name, times in segments.items() if times}
    if _uneven(used.values()):
        least, most = (pick(used, key=used.__getitem__) for pick in (min, max))
        yield finding(
            "segments-uneven",
            f"segment {most} is judged {used[most]} times and segment {least} {used[least]} times",
            where="speech/segments.csv",
        )
    for arm, plans in material.planned:
        for part, pairs in counts_of_pairs(plans).items():
            if _uneven(pairs.values()):
                rare, often = (pick(pairs, key=pairs.__getitem__) for pick in (min, max))
                yield finding(
                    "conditions-uneven",
                    f"{listed(often)} are shown {pairs[often]} times, {listed(rare)} "
                    f"{pairs[rare]} times",
                    where=part or arm.name,
                )


def _uneven(times: Iterable[int]) -> bool:
    """Tell whether the most frequent is more than `TIMES` as frequent, and not by one or two."""
    counts = list(times)
    return bool(counts) and max(counts) > TIMES * min(counts) and max(counts) - min(counts) > 2


def _between(counts: list[int]) -> str:
    low, high = min(counts, default=0), max(counts, default=0)
    return f"{low}" if low == high else f"{low} to {high}"


def _some(names: list[str]) -> str:
    """Return some of many names."""
    if len(names) <= 5:
        return listed(names)
    return f"{', '.join(names[:4])} and {len(names) - 4} more"
