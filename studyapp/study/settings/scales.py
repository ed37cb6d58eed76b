"""Scales on which single stimuli are rated, from the worst to the best."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal, Self

from pydantic import Field, model_validator

from studyapp.study.settings.questions import Question

STEPS: Final = 5

QUALITY_CATEGORIES: Final = ("bad", "poor", "fair", "good", "excellent")
"""The five categories of absolute category rating, from the worst (ITU-T P.910)."""

SLIDER_END: Final = 100
BAND: Final = SLIDER_END // STEPS


class RatingQuestion(Question):
    """A question about each stimulus of a trial.

    Attributes
    ----------
    scale : {'labels', 'slider', 'mean_opinion'}
        Five labels of the study's own; a slider from 0 to 100 without a preset, in five labelled
        bands (HEMVIP, Jonell et al. 2021); or the five categories of ITU-T P.910.
    labels : tuple of str
        From the worst to the best: the labels, or the names of the slider's bands.
    """

    scale: Literal["labels", "slider", "mean_opinion"] = "labels"
    labels: tuple[str, ...] = Field(QUALITY_CATEGORIES, strict=False)

    @model_validator(mode="after")
    def _has_labels(self) -> Self:
        given = "labels" in self.model_fields_set
        if self.scale == "labels" and not given:
            raise ValueError("a scale of labels needs its five labels, from the worst to the best")
        if self.scale == "mean_opinion" and given:
            raise ValueError('mean_opinion has labels of its own; use scale = "labels"')
        if len(set(self.labels)) != STEPS:
            raise ValueError("labels must be five different ones, from the worst to the best")
        return self

    @property
    def values(self) -> Sequence[int]:
        """What may be answered; 1 or 0 is the worst."""
        return range(SLIDER_END + 1) if self.scale == "slider" else range(1, STEPS + 1)

    def step(self, value: int) -> int:
        """Return which of the five labels `value` falls under, from 1."""
        return min(value // BAND + 1, STEPS) if self.scale == "slider" else value
