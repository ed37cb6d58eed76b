"""Whom a rehearsal simulates: how good each condition is to them, and how people differ."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from studyapp.definition.study import GROUND_TRUTH

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from studyapp.definition.study import Study

QUALITY: Final[Mapping[str, float]] = MappingProxyType(
    {GROUND_TRUTH: 1.0, "rule_based": 0.5, "mismatched": 0.0, "static": -1.0, "broken": -6.0}
)
"""Latent quality in logits of the conditions, or generators, that every study knows."""

FIRST_UNKNOWN: Final = 0.75
STEP_UNKNOWN: Final = 0.25
FURTHER_QUESTION: Final = 0.8


@dataclass(frozen=True, kw_only=True)
class Population:
    """The people a rehearsal draws its raters from.

    A rater finds condition ``c`` in segment ``i``, asked question ``q``, as good as
    ``quality[c][q] + taste + fit`` logits: ``taste`` is this rater's own, ``fit`` this segment's,
    both normal, independent between conditions and questions. What decides an answer is the
    difference between the two sides of a pair. This is a cumulative link mixed model (logit
    link, symmetric thresholds, crossed random slopes of participants and items; Agresti 2010,
    Analysis of Ordinal Categorical Data, ch. 10), run forwards.

    Attributes
    ----------
    quality : mapping of condition to mapping of question to float
        Mean latent quality in logits; only differences matter.
    participant_sd, item_sd : float
        Standard deviations, over raters and over segments, of the *difference* between two
        conditions, in logits. One condition's ``taste`` or ``fit`` has this over sqrt(2).
    side_bias, side_bias_sd : float
        Mean and standard deviation over raters of their pull towards the right video (B), in
        logits.
    weak, strong : float
        A difference (with logistic noise) beyond `weak` is answered 'slightly', beyond `strong`
        'clearly'; ``0 < weak < strong``.
    inattentive : float
        Share of raters who answer everything at random, catch trials included; in [0, 1].
    """

    quality: dict[str, dict[str, float]]
    participant_sd: float = 0.6
    item_sd: float = 0.45
    side_bias: float = -0.15
    side_bias_sd: float = 0.15
    weak: float = 0.45
    strong: float = 2.0
    inattentive: float = 0.08

    def __post_init__(self) -> None:
        if not 0 < self.weak < self.strong:
            raise ValueError(f"thresholds {self.weak}, {self.strong} are not 0 < weak < strong")
        if min(self.participant_sd, self.item_sd, self.side_bias_sd) < 0:
            raise ValueError("a standard deviation is negative")
        if not 0 <= self.inattentive <= 1:
            raise ValueError(f"inattentive {self.inattentive} is no share")

    @property
    def thresholds(self) -> tuple[float, float, float, float]:
        """Borders between the five answers, from 'clearly A' to 'clearly B', in logits."""
        return (-self.strong, -self.weak, self.weak, self.strong)

    @property
    def taste_sd(self) -> float:
        """Standard deviation over raters of one condition's quality, in logits."""
        return self.participant_sd / math.sqrt(2)

    @property
    def fit_sd(self) -> float:
        """Standard deviation over segments of one condition's quality, in logits."""
        return self.item_sd / math.sqrt(2)


def default_population(study: Study) -> Population:
    """Return the population that `motionjury rehearse` simulates for `study`.

    A condition is as good as `QUALITY` says for its name, or else for its generator. Any other
    condition is taken for a system of unknown merit: in the file's order these get .75, .5,
    .25, 0, 0, ... logits. The catch condition is always as bad as ``broken``. The first question
    tells the conditions apart in full, each further one .8 times as well as the one before, so
    that questions differ in their truth.
    """
    general = _general_qualities(study)
    weights = {
        question.name: FURTHER_QUESTION**index for index, question in enumerate(study.questions)
    }
    quality = {
        condition: {question: value * weight for question, weight in weights.items()}
        for condition, value in general.items()
    }
    # A flaw that catch trials rest on is equally plain whatever the question.
    quality[study.catch.condition] = dict.fromkeys(weights, QUALITY["broken"])
    return Population(quality=quality)


def _general_qualities(study: Study) -> dict[str, float]:
    """Return each condition's quality before questions are told apart."""
    known = {
        name: QUALITY.get(name, QUALITY.get(condition.generator or ""))
        for name, condition in study.conditions.items()
    }
    unknown: Sequence[str] = [name for name, value in known.items() if value is None]
    guesses = {
        name: max(0.0, FIRST_UNKNOWN - STEP_UNKNOWN * index) for index, name in enumerate(unknown)
    }
    return {name: guesses[name] if value is None else value for name, value in known.items()}
