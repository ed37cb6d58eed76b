"""How often conclusions are right: counted over simulated studies, and judged."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Final

import numpy as np

from benchmarks.validity.conclusions.conclusion import Conclusion, Protocol
from benchmarks.validity.studies import Design

LEVEL: Final = 0.05
"""Nominal false-positive rate."""

MOST_FALSE: Final = 0.065
"""A number with a higher false-positive rate is not a headline."""

LEAST_COVERED: Final = 0.93
"""A number whose 95% interval has lower coverage is not a headline."""

CONSERVATIVE: Final = 0.03
"""Below this false-positive rate a test is called conservative."""


@dataclass(frozen=True, kw_only=True)
class Tally:
    """Counts over some studies of one design.

    Attributes
    ----------
    studies : int
        Simulated studies.
    tested, significant : int
        Studies with a p value, and studies with one below `LEVEL`.
    bounded, covered : int
        Studies with an interval, and studies whose interval contains the truth.
    silent : int
        Studies with neither.
    """

    studies: int = 0
    tested: int = 0
    significant: int = 0
    bounded: int = 0
    covered: int = 0
    silent: int = 0

    def __add__(self, other: Tally) -> Tally:
        return Tally(
            **{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)}
        )


@dataclass(frozen=True, kw_only=True)
class Share:
    """A share of simulated studies.

    Attributes
    ----------
    value, error : float
        The share, and its Monte-Carlo standard error; NaN without studies.
    """

    value: float
    error: float

    @classmethod
    def of(cls, part: int, whole: int) -> Share:
        """Return `part` of `whole`."""
        if not whole:
            return cls(value=math.nan, error=math.nan)
        # One more study of each kind, because a share of 0 or 1 has an error too.
        likely = (part + 1) / (whole + 2)
        return cls(value=part / whole, error=math.sqrt(likely * (1 - likely) / whole))


@dataclass(frozen=True, kw_only=True)
class Realised:
    """The validity of one number of the report in one design.

    Attributes
    ----------
    false_positives : Share
        Share of studies without an effect that find one; NaN without tests.
    coverage : Share
        Share of studies with an effect whose interval contains the truth; NaN without intervals.
    power : Share
        Share of studies with an effect that find it.
    silent : float
        Share of all studies for which the report gives no number.
    """

    false_positives: Share
    coverage: Share
    power: Share
    silent: float

    @classmethod
    def of(cls, without: Tally, with_effect: Tally) -> Realised:
        """Return the shares counted without and with an effect."""
        total = without.studies + with_effect.studies
        return cls(
            false_positives=Share.of(without.significant, without.tested),
            coverage=Share.of(with_effect.covered, with_effect.bounded),
            power=Share.of(with_effect.significant, with_effect.tested),
            silent=(without.silent + with_effect.silent) / total if total else math.nan,
        )

    @property
    def verdict(self) -> str:
        """The verdict by `MOST_FALSE`, `LEAST_COVERED` and `CONSERVATIVE`."""
        false, covered = self.false_positives, self.coverage
        broken = [
            abs(share.value - limit) < 2 * share.error
            for share, limit, wrong in (
                (false, MOST_FALSE, false.value > MOST_FALSE),
                (covered, LEAST_COVERED, covered.value < LEAST_COVERED),
            )
            if wrong
        ]
        if broken:
            return "not a headline" + (" (within error)" if all(broken) else "")
        if false.value < CONSERVATIVE:
            return "conservative"
        return "headline"


@dataclass(frozen=True, kw_only=True)
class Row:
    """One number in one design.

    Attributes
    ----------
    experiment : str
        The kind of study.
    design : Design
        Its size, and the variation of opinions.
    number : str
        Name of the report's number.
    naive : bool
        Whether it treats answers as independent, as papers do.
    realised : Realised
        Its rates.
    """

    experiment: str
    design: Design
    number: str
    naive: bool
    realised: Realised

    @property
    def size(self) -> str:
        """Participants x items, and the spread between them, in logits."""
        design = self.design
        spreads = f"{design.participant_sd:g}/{design.item_sd:g}"
        process = "" if design.process == "normal tastes" else f", {design.process}"
        return f"{design.participants} x {design.items}, {spreads}{process}"


def overall(rows: Sequence[Row]) -> str:
    """Return the verdict on one number over all designs: the worst, and its designs."""
    for verdict in ("not a headline", "not a headline (within error)", "conservative"):
        where = [row.size for row in rows if row.realised.verdict == verdict]
        if where:
            return verdict + (f" at {'; '.join(where)}" if len(where) < len(rows) else "")
    return "headline"


def tally(
    protocol: Protocol,
    design: Design,
    truths: Mapping[str, float],
    generators: Iterable[np.random.Generator],
) -> dict[str, Tally]:
    """Simulate one study with each of `generators` and count by conclusion."""
    tallies: dict[str, Tally] = {}
    for generator in generators:
        for name, conclusion in protocol.conclude(design, generator).items():
            tallies[name] = tallies.get(name, Tally()) + _counted(conclusion, truths.get(name))
    return tallies


def _counted(conclusion: Conclusion, truth: float | None) -> Tally:
    bounded = truth is not None and not math.isnan(conclusion.low)
    tested = not math.isnan(conclusion.p_value)
    return Tally(
        studies=1,
        tested=int(tested),
        silent=int(not tested and not bounded),
        significant=int(conclusion.p_value < LEVEL),
        bounded=int(bounded),
        covered=int(bounded and conclusion.low <= truth <= conclusion.high),  # type: ignore[operator]
    )
