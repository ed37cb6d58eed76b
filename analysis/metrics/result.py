"""The results of metrics: scores with their settings, and confusions of emotions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Literal

Better = Literal["lower", "higher", "near the reference", "unsaid"]
"""Which of two scores is better; 'near the reference' if too much is as bad as too little, 'unsaid'
for numbers that only help to read others."""


@dataclass(frozen=True, kw_only=True)
class MetricResult:
    """One score.

    Attributes
    ----------
    name : str
        The metric and, if there are several, its preset.
    value : float
        The score; NaN where it is not defined.
    unit : str
        Unit of `value`; empty where it has none.
    n : int
        Number of items that `value` is a mean over.
    settings : mapping of str to str
        Everything that another score must share to be comparable with this one.
    reason : str
        Why `value` is NaN; empty otherwise.
    interval : (float, float) or None
        95% interval of `value`; `settings` say how it was made.
    remark : str
        A caution about `value`, such as too small a sample.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores are better.
    """

    name: str
    value: float
    unit: str
    n: int
    settings: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""
    interval: tuple[float, float] | None = None
    remark: str = ""
    better: Better = "unsaid"

    def __post_init__(self) -> None:
        if math.isnan(self.value) != bool(self.reason):
            raise ValueError(f"metric {self.name}: a reason belongs to NaN and to nothing else")
        if self.interval is not None and not self.interval[0] <= self.interval[1]:
            raise ValueError(f"metric {self.name}: {self.interval} is no interval")
        object.__setattr__(self, "settings", _shared(tuple(self.settings.items())))

    def __getstate__(self) -> dict[str, object]:
        """Return what another process needs; a read-only mapping does not travel."""
        return {**vars(self), "settings": tuple(self.settings.items())}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Take over what another process sent."""
        vars(self).update(state, settings=_shared(state["settings"]))


@dataclass(frozen=True)
class Metric:
    """The name of a score, its unit, and which scores are better."""

    name: str
    unit: str = ""
    better: Better = "unsaid"

    def score(
        self,
        value: float,
        n: int,
        settings: Mapping[str, str] | None = None,
        *,
        interval: tuple[float, float] | None = None,
        remark: str = "",
    ) -> MetricResult:
        """Return a score; `MetricResult` says what each part is."""
        return MetricResult(
            name=self.name,
            value=value,
            unit=self.unit,
            n=n,
            settings=settings or {},
            interval=interval,
            remark=remark,
            better=self.better,
        )

    def missing(self, reason: str, settings: Mapping[str, str] | None = None) -> MetricResult:
        """Return that there is no score, and why."""
        return MetricResult(
            name=self.name,
            value=math.nan,
            unit=self.unit,
            n=0,
            settings=settings or {},
            reason=reason,
            better=self.better,
        )


@lru_cache(maxsize=1024)
def _shared(settings: tuple[tuple[str, str], ...]) -> Mapping[str, str]:
    """Return one read-only mapping for all scores of equal settings: there are a great many."""
    return MappingProxyType(dict(settings))


@dataclass(frozen=True, kw_only=True)
class EmotionConfusion:
    """The emotions that a network named for the gestures of one condition.

    Attributes
    ----------
    condition : str
        The condition.
    network : str
        Hash of the network's file.
    spoken : tuple of str
        Emotions of the speech, in the order of the network's labels, with at least one clip each.
    named : tuple of str
        All emotions that the network classifies.
    counts : tuple of tuple of int
        Clips by spoken emotion (rows) and named emotion (columns).
    """

    condition: str
    network: str
    spoken: tuple[str, ...]
    named: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]
