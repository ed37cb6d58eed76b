"""pairwise (amuse): two motions of the same speech, and which one is preferred.

After AMUSE (Chhatre et al. 2024, section 5.3 and appendix H): each comparison has participants of
its own, the first trials are discarded and shown again at the end, sides are random, and catch
trials are scattered among the others. What the paper leaves open is decided here:

- Sides are random but balanced within the participant: of the analysed trials (main and repeat)
  half show the reference on the left, and an odd one falls to either side by chance. Practice
  and catch trials are balanced each among themselves.
- A repeat draws its side anew, so that an answer cannot be given from the memory of a side.
- With ``comparisons = "all_pairs"`` every participant meets all conditions: pairs come equally
  often, along a ring drawn once per study, and a segment may come as often as a condition has
  others to be compared with. With ``"adaptive"`` they are chosen, when a participant
  comes, by how much an answer is worth under what has been answered so far.
- A catch trial is never among the practice trials and never the first trial; two of them do not
  follow each other as long as there are enough places between the others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final, Literal

import numpy as np
from pydantic import Field

from motion.errors import listed
from motion.segment import EMOTIONS, Segment
from studyapp.study.design.adaptive import Pair, most_informative_pairs
from studyapp.study.design.allocation import TrialCount, allocate_segments, planned_trials, shuffled
from studyapp.study.design.order import (
    PREFERENCES,
    draw_segments,
    number_trials,
    pair_trials,
    pair_videos,
    prefers_side,
    scatter,
)
from studyapp.study.design.trial import (
    NO_VOTES,
    Answers,
    Arm,
    Content,
    Kind,
    PlannedTrial,
    Stimulus,
    Tally,
    Trial,
)
from studyapp.study.settings.conditions import Condition, comparison_name, with_sources
from studyapp.study.settings.questions import Question
from studyapp.study.settings.sections import Name
from studyapp.study.settings.study import GROUND_TRUTH, Study

PUBLISHED_PAIRS: Final = 24
"""Pairs that a participant of AMUSE's study judged."""

INSTRUCTED_ANSWERS: Final = (-2, -1, 1, 2)
"""What an attention check may ask for: not the middle, which the undecided choose anyway."""


class PairwiseStudy(Study):
    """Preferences between two motions.

    Attributes
    ----------
    comparisons : {'with_reference', 'all_pairs', 'adaptive'}
        Every other condition with the reference, each with participants of its own; or all
        pairs of conditions, within each participant, evenly or where they are worth most.
    reference : str
        The condition that every other condition is compared with, and that stands first in the
        names of pairs.
    participants_per_comparison : int
        Places of each comparison with the reference; AMUSE has 25.
    participants : int
        Places of a study that compares all pairs.
    trials : int
        Pairs each participant is asked about in the analysed trials, at most; three per emotion
        in AMUSE.
    practice : int
        The first so many trials are discarded and shown again at the end.
    layout : {'composed', 'players'}
        One video with both sides exactly in step, or two players.
    """

    protocol: Literal["pairwise"] = "pairwise"
    comparisons: Literal["with_reference", "all_pairs", "adaptive"] = "with_reference"
    reference: Name
    participants_per_comparison: int = Field(25, ge=1, le=10_000)
    participants: int = Field(60, ge=1, le=100_000)
    trials: int = Field(24, ge=1, le=500)
    practice: int = Field(3, ge=0, le=20)
    layout: Literal["composed", "players"] = "composed"
    conditions: dict[Name, Condition] = Field(min_length=2)

    def problems(self) -> list[str]:
        """Return everything that does not fit together."""
        known = ", ".join(self.conditions)
        problems = super().problems()
        if self.reference not in self.conditions:
            problems.append(
                f"reference {self.reference!r} is not a condition of the study ({known})"
            )
        unused = "participants" if self.has_reference_arms else "participants_per_comparison"
        if unused in self.model_fields_set:
            problems.append(f"{unused} has no meaning with comparisons = {self.comparisons!r}")
        if self.practice > self.trials:
            problems.append(f"practice {self.practice} is more than trials {self.trials}")
        finished = any(map(self.is_finished, (*self.conditions, self.catch.condition)))
        if self.is_composed and finished:
            problems.append('finished videos cannot be composed: set layout = "players"')
        return problems

    @property
    def others(self) -> tuple[str, ...]:
        """The conditions compared with the reference, in the file's order."""
        return tuple(name for name in self.conditions if name != self.reference)

    @property
    def has_reference_arms(self) -> bool:
        """Whether each comparison with the reference has participants of its own."""
        return self.comparisons == "with_reference"

    @property
    def is_composed(self) -> bool:
        """Whether both sides of a pair are in one video."""
        return self.layout == "composed"

    @property
    def follows_votes(self) -> bool:
        """Whether what is shown depends on what was answered before."""
        return self.comparisons == "adaptive"

    @property
    def catch_against(self) -> str:
        """The condition that catch trials show beside the flawed motion."""
        if self.catch.against is not None:
            return self.catch.against
        return GROUND_TRUTH if self.has_recording else self.reference

    @property
    def roles(self) -> Mapping[str, str]:
        """The reference, and what all protocols have."""
        return {self.reference: "reference", **super().roles}

    @property
    def arms(self) -> tuple[Arm, ...]:
        """One arm per comparison with the reference, or one for all pairs."""
        if not self.has_reference_arms:
            everything = (self.reference, *self.others)
            return (Arm(name="all", conditions=everything, places=self.participants),)
        return tuple(
            Arm(
                name=comparison_name(self.reference, other),
                conditions=(self.reference, other),
                places=self.participants_per_comparison,
            )
            for other in self.others
        )

    def design_of(self, arm: Arm) -> Study:
        """Return the study without the conditions that `arm` does not show."""
        shown = {*arm.conditions, *((self.catch_against,) if self.catch.trials else ())}
        return self.model_copy(update={"conditions": with_sources(self.conditions, shown)})

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Every (left, right) a participant may be shown: both orders of each pair."""
        compared = [pair for arm in self.arms for pair in combinations(arm.conditions, 2)]
        if self.catch.trials:
            compared.append((self.catch_against, self.catch.condition))
        return tuple(pair for a, b in compared for pair in ((a, b), (b, a)))

    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield what every video shows that a participant may meet, each once."""
        yield from dict.fromkeys(
            content
            for a, b in self.pairs
            for segment in segments
            for content in pair_videos(
                Stimulus.own(a, segment.name),
                Stimulus.own(b, segment.name),
                composed=self.is_composed,
            )
        )

    def plan(
        self, arm: Arm, number: int, segments: Sequence[Segment], votes: Tally = NO_VOTES
    ) -> tuple[PlannedTrial, ...]:
        """Return practice, then main with catch and attention among them, then the repeats."""
        count = self.count(segments)
        comparison = (self.seed, *arm.name.encode())
        chance = np.random.default_rng([number + 1, *comparison])
        chosen = shuffled(self._heard(segments, count.analysed, number, comparison), chance)
        shown = list(zip(chosen, self._compared(arm, number, len(chosen), votes), strict=True))
        first, rest = shown[: count.practice], shown[count.practice :]
        practice = self._pairs("practice", first, chance)
        analysed = self._pairs("main", [*rest, *first], chance)
        new = count.analysed - count.practice
        main, repeats = analysed[:new], analysed[new:]
        repeats = [
            replace(trial, kind="repeat", repeats=position)
            for position, trial in enumerate(repeats, start=1)
        ]
        heard = draw_segments(
            segments, self.catch.trials + self.attention.trials, chance, heard=chosen
        )
        extra = [
            *self._catch(heard[: self.catch.trials], chance),
            *self._attention(heard[self.catch.trials :], shown, chance),
        ]
        later = scatter(extra, [*main, *repeats], chance, may_lead=bool(practice))
        return number_trials([*practice, *later])

    def count(self, segments: Sequence[Segment]) -> TrialCount:
        """Return how many trials of each kind a participant gets."""
        return planned_trials(
            segments,
            trials=self.trials,
            practice=self.practice,
            rounds=1 if self.has_reference_arms else len(self.conditions) - 1,
        )

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Say how many pairs these segments allow, and what they do not."""
        count = self.count(segments)
        emotions = [e for e in EMOTIONS if e in {segment.emotion for segment in segments}]
        return (
            f"{len(segments)} segments of {listed(emotions)} allow {count.analysed} pairs per "
            f"participant; the published design has {PUBLISHED_PAIRS}, three for each of "
            f"{len(EMOTIONS)} emotions",
            *count.sentences,
        )

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the five levels of preference."""
        del question, trial
        return PREFERENCES[5]

    def prefers(self, answers: Answers, better: int, worse: int) -> bool:
        """Tell whether every answer prefers side `better`, slightly or clearly."""
        del worse
        return prefers_side(answers, better)

    def _pairs(
        self, kind: Kind, shown: Sequence[tuple[Segment, Pair]], chance: np.random.Generator
    ) -> list[PlannedTrial]:
        own = [
            (segment, Stimulus.own(a, segment.name), Stimulus.own(b, segment.name))
            for segment, (a, b) in shown
        ]
        return pair_trials(kind, own, chance, composed=self.is_composed)

    def _heard(
        self, segments: Sequence[Segment], count: int, number: int, seed: tuple[int, ...]
    ) -> list[Segment]:
        """Return the segments of `count` trials; none comes again before all others have come."""
        heard: list[Segment] = []
        while len(heard) < count:
            following = (*seed, len(heard)) if heard else seed
            heard += allocate_segments(segments, count - len(heard), number=number, seed=following)
        return heard

    def _compared(self, arm: Arm, number: int, count: int, votes: Tally) -> list[Pair]:
        """Return the pairs that a participant compares, one for each of `count` segments."""
        pairs = list(combinations(arm.conditions, 2))
        chance = np.random.default_rng([number + 1, self.seed, len(pairs)])
        if self.follows_votes:
            return most_informative_pairs(arm.conditions, votes, count, chance)
        ring = shuffled(pairs, np.random.default_rng([self.seed, len(pairs)]))
        return shuffled(
            [ring[(number * count + step) % len(ring)] for step in range(count)], chance
        )

    def _catch(self, heard: Sequence[Segment], chance: np.random.Generator) -> list[PlannedTrial]:
        pair = (self.catch_against, self.catch.condition)
        return [
            replace(trial, expected=1 + trial.conditions.index(self.catch_against))
            for trial in self._pairs("catch", [(segment, pair) for segment in heard], chance)
        ]

    def _attention(
        self,
        heard: Sequence[Segment],
        shown: Sequence[tuple[Segment, Pair]],
        chance: np.random.Generator,
    ) -> list[PlannedTrial]:
        """Return a check for each of `heard`, with some of the pairs of `shown`."""
        pairs = [shown[index % len(shown)][1] for index in range(len(heard))]
        return [
            replace(trial, instructed=int(chance.choice(INSTRUCTED_ANSWERS)))
            for trial in self._pairs("attention", list(zip(heard, pairs, strict=True)), chance)
        ]
