"""What every metric returns: a number that says how it came about."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType


@dataclass(frozen=True, kw_only=True)
class MetricResult:
    """One score.

    Attributes
    ----------
    name : str
        Names the metric and, where there are several, its preset.
    value : float
        The score; NaN where it is not defined.
    unit : str
        Unit of `value`; empty where it has none.
    n : int
        How many things `value` is a mean over.
    settings : mapping of str to str
        Everything that another score must share to be comparable with this one.
    reason : str
        Why `value` is NaN; empty otherwise.
    """

    name: str
    value: float
    unit: str
    n: int
    settings: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""

    def __post_init__(self) -> None:
        if math.isnan(self.value) != bool(self.reason):
            raise ValueError(f"metric {self.name}: a reason belongs to NaN and to nothing else")
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))
