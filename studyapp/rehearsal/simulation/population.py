"""Whom a rehearsal simulates: kinds of people, how good conditions are to them, their scales."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Final, Literal, get_args

import numpy as np
from scipy.special import logit

from studyapp.study.settings.rehearsal import EVERY_QUESTION
from studyapp.study.settings.study import GROUND_TRUTH, Study

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

KINDS: Final[tuple[Kind, ...]] = get_args(Kind)
"""All of them, in the order in which shares of the participants are laid end to end; those who are
left over are attentive."""

UNSOUND: Final[frozenset[Kind]] = frozenset({"careless", "hasty", "side_biased", "straight_lining"})
"""Kinds whose answers say less than those of the attentive, or nothing: an analysis is better off
without them. All others judge as the attentive do."""

DESCRIPTIONS: Final[Mapping[Kind, str]] = {
    "attentive": "watch, and answer what they prefer",
    "hasty": "watch as little as they may, answer at once, see little",
    "side_biased": "are drawn to one side",
    "straight_lining": "give the same answer again and again",
    "careless": "answer at random",
    "dropping_out": "leave on the way, for good",
    "returning": "leave on the way and come back",
    "double_clicking": "press every button twice",
}
"""What each does, in words."""


def kind_at(shares: Mapping[Kind, float], drawn: float) -> Kind:
    """Return the kind of a rater for whom the number `drawn`, in [0, 1), was drawn."""
    end = 0.0
    for kind in KINDS[:-1]:
        end += shares.get(kind, 0.0)
        if drawn < end:
            return kind
    return KINDS[-1]


QUALITY: Final[Mapping[str, float]] = {
    GROUND_TRUTH: 1.0,
    "rule_based": 0.5,
    "mismatched": 0.0,
    "static": -1.0,
    "broken": -6.0,
}
"""Latent quality in logits of the conditions, or generators, that every study knows."""

FIRST_UNKNOWN: Final = 0.75
STEP_UNKNOWN: Final = 0.25
FURTHER_QUESTION: Final = 0.8

BELONGING: Final = 1.5
"""Logits by which motion suits its own speech better than another, for each logit of quality."""


@dataclass(frozen=True, kw_only=True)
class Population:
    """The people a rehearsal draws its raters from.

    A rater finds condition ``c`` in segment ``i``, asked question ``q``, as good as
    ``quality[c][q] + taste + fit`` logits: ``taste`` is this rater's own, ``fit`` this segment's,
    both normal, independent between conditions and questions. Heard with another segment's
    speech, a motion is ``belonging[c][q]`` logits worse, give or take as much as raters and
    segments differ between two conditions. Every answer rests on these utilities:

    - a **preference** on the difference between the two sides, the rater's pull to one side and
      logistic noise, cut by `weak` and `strong`: a cumulative link mixed model (logit link,
      symmetric thresholds, crossed random slopes of participants and items; Agresti 2010,
      Analysis of Ordinal Categorical Data, ch. 10), run forwards;
    - a **rating** on one utility, the rater's leniency and logistic noise, cut into the
      categories of the scale: the same model with a random intercept of the rater;
    - a **ranking** on all utilities with Gumbel noise, in falling order: the model of Plackett
      and Luce (Luce 1959; Plackett 1975), in which two motions are ordered as a preference
      without ties would order them.

    Attributes
    ----------
    quality : mapping of condition to mapping of question to float
        Mean latent quality in logits; only differences matter between conditions that are
        compared, while a rating's middle lies at 0.
    belonging : mapping of condition to mapping of question to float
        How many logits better a motion suits its own speech than another's.
    participant_sd, item_sd : float
        Standard deviations, over raters and over segments, of the *difference* between two
        conditions, in logits. One condition's ``taste`` or ``fit`` has this over sqrt(2).
    side_bias, side_bias_sd : float
        Mean and standard deviation over raters of their pull towards the right video (B), in
        logits.
    weak, strong : float
        A difference (with its noise) beyond `weak` is answered 'slightly', beyond `strong`
        'clearly'; ``0 < weak < strong``. Where a ranking allows ties, motions within `weak` of
        the best that has their rank share it.
    leniency_sd : float
        Standard deviation over raters of how much better they rate everything, in logits.
    rating_spread : float
        Logits that a rating's latent value is divided by, before the logistic function turns it
        into a place on the scale; above 0.
    kinds : mapping of kind to float
        Share of each of `KINDS` (see `kinds`) that is not plainly attentive; each in [0, 1], and
        together at most 1.
    overlooked : float
        Share of attention checks that an attentive rater answers as if they asked what all other
        pages ask; in [0, 1].
    reasons : float
        Chance of each reason offered beside an answer to be ticked; in [0, 1].
    """

    quality: dict[str, dict[str, float]]
    belonging: dict[str, dict[str, float]] = field(default_factory=dict)
    participant_sd: float = 0.6
    item_sd: float = 0.45
    side_bias: float = -0.15
    side_bias_sd: float = 0.15
    weak: float = 0.45
    strong: float = 2.0
    leniency_sd: float = 0.5
    rating_spread: float = 1.8
    kinds: dict[Kind, float] = field(default_factory=dict)
    overlooked: float = 0.02
    reasons: float = 0.3

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

    Whatever the study's ``[rehearsal]`` states holds. Else a condition is as good as `QUALITY`
    says for its name, or for its generator. Any other condition is taken for a system of unknown
    merit: in the file's order these get .75, .5, .25, 0, 0, ... logits. The catch condition is as
    bad as ``broken``. What is better than the mismatched motion, whose quality is 0, suits its own
    speech `BELONGING` times as much better; the others suit any speech alike. The first question
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
    stated = study.rehearsal
    quality = _as_stated(quality, stated.strength)
    belonging = {
        condition: {
            question: BELONGING * max(0.0, value) for question, value in by_question.items()
        }
        for condition, by_question in quality.items()
    }
    return Population(
        quality=quality,
        belonging=_as_stated(belonging, stated.own_speech),
        participant_sd=stated.participants_differ,
        item_sd=stated.segments_differ,
        kinds={kind: stated.shares[kind] for kind in KINDS if kind in stated.shares},
    )


def _as_stated(
    guessed: Mapping[str, Mapping[str, float]], stated: Mapping[str, Mapping[str, float]]
) -> dict[str, dict[str, float]]:
    """Return what is stated of each condition and question, and what is guessed of the others."""

    def value(condition: str, question: str, guess: float) -> float:
        by_question = stated.get(condition, {})
        return by_question.get(question, by_question.get(EVERY_QUESTION, guess))

    return {
        condition: {question: value(condition, question, guess) for question, guess in each.items()}
        for condition, each in guessed.items()
    }


def _general_qualities(study: Study) -> dict[str, float]:
    """Return each condition's quality before questions are told apart."""
    known = {
        name: QUALITY.get(name, QUALITY.get(condition.generator or ""))
        for name, condition in study.conditions.items()
    }
    guesses = (max(0.0, FIRST_UNKNOWN - STEP_UNKNOWN * index) for index in count())
    return {name: next(guesses) if value is None else value for name, value in known.items()}


def preference_thresholds(population: Population, levels: int) -> tuple[float, ...]:
    """Return the borders between `levels` (2, 3 or 5) preferences from A to B, in logits."""
    weak, strong = population.weak, population.strong
    return {2: (0.0,), 3: (-weak, weak), 5: (-strong, -weak, weak, strong)}[levels]


def rating_thresholds(population: Population, levels: int) -> tuple[float, ...]:
    """Return the borders between `levels` equally wide steps of a rating scale, in logits.

    A latent value of 0 lies in the middle of the scale. A slider is the same scale in finer
    steps, so that its five bands hold what five labels would be given for.
    """
    shares = np.arange(1, levels) / levels
    return tuple((population.rating_spread * logit(shares)).tolist())


def step(values: Sequence[int], thresholds: Sequence[float], latent: float) -> int:
    """Return the one of `values` that `latent` falls on; there is one threshold fewer."""
    return values[int(np.searchsorted(thresholds, latent))]


def ranks(utilities: Sequence[float], *, tie_within: float | None = None) -> tuple[int, ...]:
    """Return the rank of each of `utilities`, the highest first, counted from 1 without gaps.

    Parameters
    ----------
    utilities : sequence of float
        With their noise, in logits.
    tie_within : float, optional
        What is at most so far below the best of a rank shares it; by default nothing does.
    """
    order = sorted(range(len(utilities)), key=lambda index: -utilities[index])
    found = [0] * len(utilities)
    rank, best = 0, 0.0
    for index in order:
        if not rank or tie_within is None or best - utilities[index] > tie_within:
            rank, best = rank + 1, utilities[index]
        found[index] = rank
    return tuple(found)
