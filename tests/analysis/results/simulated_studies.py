"""Rated studies in which a metric agrees with people to a known degree."""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.metrics.scores import Better, ClipScore, Metric, StudyMetrics, clip_means


@dataclass(frozen=True, kw_only=True)
class AgreeingStudy:
    """Conditions drawn from a population in which metric and preference are jointly normal.

    Attributes
    ----------
    conditions, participants, segments : int
        How many of each.
    tau : float
        Kendall's tau of metric and preference among all conditions.
    within : float
        Correlation of metric and preference among the clips of a condition.
    noise : float
        Standard deviation of what single participants and answers add, conditions' being 1.
    offset : float
        Added to all scores.
    """

    conditions: int = 6
    participants: int = 20
    segments: int = 12
    tau: float = 0.5
    within: float = 0.0
    noise: float = 0.7
    offset: float = 0.0

    def drawn(self, chance: np.random.Generator) -> tuple[pd.DataFrame, StudyMetrics]:
        """Return the answers and the metrics of one study."""
        rho = math.sin(math.pi * self.tau / 2)
        score, liking = _correlated(chance, rho, (self.conditions,))
        clip, clip_liking = _correlated(chance, self.within, (self.conditions, self.segments))
        taste = chance.normal(0, self.noise, (self.participants, self.conditions))
        scores = score[:, None] + 0.5 * clip
        likings = liking[:, None] + 0.5 * clip_liking
        given = likings[None] + taste[:, :, None]
        given = given + chance.normal(0, self.noise, given.shape)
        answers = {
            axis: pd.Categorical([f"{axis[0]}{number:02d}" for number in place.ravel()])
            for axis, place in zip(
                ("participant", "condition", "segment"), np.indices(given.shape), strict=True
            )
        }
        return pd.DataFrame(answers).assign(value=given.ravel()), metrics_of(scores + self.offset)


def names(letter: str, count: int) -> list[str]:
    """Return names such as c00, c01."""
    return [f"{letter}{number:02d}" for number in range(count)]


def metrics_of(scores: np.ndarray, *, better: Better = "higher") -> StudyMetrics:
    """Return one metric with the given scores, shape (conditions, segments); NaN for none."""
    metric = Metric("liveliness", "m/s", better)
    clips = tuple(
        ClipScore(
            condition=condition,
            segment=segment,
            result=metric.missing("too short")
            if np.isnan(value)
            else metric.score(float(value), 1),
        )
        for condition, row in zip(names("c", len(scores)), scores, strict=True)
        for segment, value in zip(names("s", len(row)), row, strict=True)
    )
    return StudyMetrics(
        frame_rate=30.0,
        clips=clips,
        conditions=tuple(
            score
            for condition in names("c", len(scores))
            for score in clip_means(condition, [c for c in clips if c.condition == condition])
        ),
    )


def _correlated(
    chance: np.random.Generator, rho: float, shape: tuple[int, ...]
) -> tuple[np.ndarray, np.ndarray]:
    first = chance.standard_normal(shape)
    return first, rho * first + math.sqrt(1 - rho**2) * chance.standard_normal(shape)
