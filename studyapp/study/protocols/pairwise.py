"""pairwise (amuse): two motions of the same segment, and which one is preferred.

After AMUSE (Chhatre et al. 2024, section 5.3 and appendix H): each comparison has its own
participants, the first trials are discarded and shown again at the end, sides are random, and
catch trials are scattered among the others. The paper leaves open:

- Sides are balanced within a participant: half of the analysed trials (main and repeat) show the
  reference on the left. Practice and catch trials are balanced among themselves.
- A repeat draws its side anew, so that nobody can answer from memory of a side.
- With ``comparisons = "all_pairs"`` every participant sees all conditions: pairs come equally
  often, along a ring drawn once per study, and a segment comes at most once for each other
  condition, with another pair each time. With ``"adaptive"`` the pairs are chosen when a
  participant arrives, by how much their answers would add to those given so far.
- A catch trial is never among the practice trials and never the first trial; two of them are not
  adjacent if there are enough other trials.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final, Literal

import numpy as np
from pydantic import Field

from motion.errors import counted, listed
from motion.segment import EMOTIONS, Segment
from studyapp.study.design.adaptive import Pair, most_informative_pairs
from studyapp.study.design.allocation import (
    PREFERENCES,
    allocate_segments,
    number_trials,
    pair_trials,
    pair_videos,
    scatter,
    shuffled,
)
from studyapp.study.design.trial import (
    NO_VOTES,
    Arm,
    Content,
    Kind,
    PlannedTrial,
    Stimulus,
    Tally,
    Trial,
)
from studyapp.study.settings.conditions import (
    Condition,
    comparison_name,
    unknown_condition,
    with_sources,
)
from studyapp.study.settings.questions import Question
from studyapp.study.settings.sections import Name
from studyapp.study.settings.study import Study

PUBLISHED_PAIRS: Final = 24
"""Pairs that each participant of AMUSE's study judged."""

INSTRUCTED_ANSWERS: Final = (-2, -1, 1, 2)
"""Answers that an attention check may ask for: not the middle, which the undecided choose."""


class PairwiseStudy(Study):
    """Preferences between two motions.

    Attributes
    ----------
    comparisons : {'with_reference', 'all_pairs', 'adaptive'}
        Every other condition with the reference, each with its own participants; or all pairs of
        conditions within each participant, evenly or where answers are the most informative.
    reference : str
        The condition that all others are compared with; it comes first in the names of pairs.
    participants_per_comparison : int
        Places of each comparison with the reference; AMUSE has 25.
    participants : int
        Places of a study that compares all pairs.
    trials : int
        Analysed pairs of each participant, at most; in AMUSE, three for each emotion.
    practice : int
        Trials at the beginning that are discarded and shown again at the end.
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
    margin: float | None = Field(None, gt=0, lt=0.5, strict=False)
    conditions: dict[Name, Condition] = Field(min_length=2)

    def problems(self) -> list[str]:
        """Return everything that does not fit together."""
        problems = super().problems()
        problems += unknown_condition("reference", self.reference, self.conditions)
        unused = "participants" if self.has_reference_arms else "participants_per_comparison"
        if unused in self.model_fields_set:
            problems.append(f"{unused} has no effect with comparisons = {self.comparisons!r}")
        if self.practice > self.trials:
            problems.append(f"practice ({self.practice}) is more than trials ({self.trials})")
        finished = any(map(self.is_finished, (*self.conditions, self.catch.condition)))
        if self.is_composed and finished:
            problems.append('finished videos cannot be composed: set layout = "players"')
        return problems

    @property
    def others(self) -> tuple[str, ...]:
        """The conditions compared with the reference, in the file's order."""
        return tuple(name for name in self.conditions if name != self.reference)

    @property
    def judged(self) -> tuple[str, ...]:
        """All conditions, the reference first."""
        return (self.reference, *self.others)

    @property
    def has_reference_arms(self) -> bool:
        """Whether each comparison with the reference has its own participants."""
        return self.comparisons == "with_reference"

    @property
    def is_composed(self) -> bool:
        """Whether both sides of a pair are in one video."""
        return self.layout == "composed"

    @property
    def follows_votes(self) -> bool:
        """Whether the trials of a place depend on earlier answers."""
        return self.comparisons == "adaptive"

    @property
    def roles(self) -> Mapping[str, str]:
        """The roles of the reference and of catch trials."""
        return {self.reference: "reference", **super().roles}

    @property
    def arms(self) -> tuple[Arm, ...]:
        """One arm per comparison with the reference, or one for all pairs."""
        if not self.has_reference_arms:
            return (Arm(name="all", conditions=self.judged, places=self.participants),)
        return tuple(
            Arm(
                name=comparison_name(self.reference, other),
                conditions=(self.reference, other),
                places=self.participants_per_comparison,
            )
            for other in self.others
        )

    def design_of(self, arm: Arm) -> Study:
        """Return the study without conditions that `arm` does not show."""
        shown = {*arm.conditions, *((self.catch_against,) if self.catch.trials else ())}
        return self.model_copy(update={"conditions": with_sources(self.conditions, shown)})

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Every (left, right) that a participant may see: both orders of each pair."""
        compared = [pair for arm in self.arms for pair in combinations(arm.conditions, 2)]
        if self.catch.trials:
            compared.append((self.catch_against, self.catch.condition))
        return tuple(pair for a, b in compared for pair in ((a, b), (b, a)))

    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield the content of every video that a participant may see, each once."""
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
        practised, analysed_pairs = self._count_pairs(segments)
        seed = (self.seed, *arm.name.encode())
        chance = np.random.default_rng([number + 1, *seed])
        chosen = shuffled(self._choose_segments(segments, analysed_pairs, number, seed), chance)
        compared = self._choose_pairs(arm, number, len(chosen), votes)
        pairs = _without_repetition(list(zip(chosen, compared, strict=True)))
        repeated, others = pairs[:practised], pairs[practised:]
        practice = self._trials("practice", repeated, chance)
        analysed = self._trials("main", [*others, *repeated], chance)
        main = analysed[: len(others)]
        repeats = [
            replace(trial, kind="repeat", repeats=position)
            for position, trial in enumerate(analysed[len(others) :], start=1)
        ]
        catch, attention = self.draw_extra_segments(segments, analysed, chance)
        caught = (self.catch_against, self.catch.condition)
        extra = [
            *self._trials("catch", [(segment, caught) for segment in catch], chance),
            *self._attention_checks(attention, pairs, chance),
        ]
        later = scatter(extra, [*main, *repeats], chance, may_lead=bool(practice))
        return number_trials([*practice, *later])

    @property
    def _rounds(self) -> int:
        """How often a participant judges the same segment at most."""
        return 1 if self.has_reference_arms else len(self.conditions) - 1

    def _count_pairs(self, segments: Sequence[Segment]) -> tuple[int, int]:
        """Return how many pairs of a participant are practice, and how many are analysed."""
        pairs = min(self.trials, self._rounds * len(segments))
        return min(self.practice, pairs), pairs

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Say how many pairs the segments allow, and why not more."""
        _, pairs = self._count_pairs(segments)
        available = Counter(segment.emotion for segment in segments)
        notes = [
            f"with {counted(len(segments), 'segment')} of "
            f"{listed([e for e in EMOTIONS if e in available])}, a participant can judge "
            f"{counted(pairs, 'pair')}; the published design has {PUBLISHED_PAIRS}, three for each "
            f"of {len(EMOTIONS)} emotions"
        ]
        if pairs < self.trials:
            notes.append(
                f"each participant judges {counted(pairs, 'pair')} instead of {self.trials}, "
                f"because the study has {counted(len(segments), 'segment')} and shows each "
                f"{'once' if self._rounds == 1 else f'{self._rounds} times'}"
            )
        share = int(pairs / self._rounds // max(1, len(available)))
        short = [f"{emotion} ({count})" for emotion, count in available.items() if count < share]
        if short:
            notes.append(
                f"the emotions are not shown equally often: an even share is {share} segments "
                f"each, but there are fewer of {', '.join(short)}"
            )
        return tuple(notes)

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the five levels of preference."""
        del question, trial
        return PREFERENCES[5]

    def _trials(
        self, kind: Kind, pairs: Sequence[tuple[Segment, Pair]], chance: np.random.Generator
    ) -> list[PlannedTrial]:
        stimuli = [
            (segment, Stimulus.own(a, segment.name), Stimulus.own(b, segment.name))
            for segment, (a, b) in pairs
        ]
        return pair_trials(kind, stimuli, chance, composed=self.is_composed)

    def _choose_segments(
        self, segments: Sequence[Segment], count: int, number: int, seed: tuple[int, ...]
    ) -> list[Segment]:
        """Return the segments of `count` trials; none is repeated before all have come."""
        chosen: list[Segment] = []
        while len(chosen) < count:
            round_seed = (*seed, len(chosen)) if chosen else seed
            missing = count - len(chosen)
            chosen += allocate_segments(segments, missing, number=number, seed=round_seed)
        return chosen

    def _choose_pairs(self, arm: Arm, number: int, count: int, votes: Tally) -> list[Pair]:
        """Return the pairs that a participant compares, one for each of `count` segments."""
        pairs = list(combinations(arm.conditions, 2))
        chance = np.random.default_rng([number + 1, self.seed, len(pairs)])
        if self.follows_votes:
            return most_informative_pairs(arm.conditions, votes, count, chance)
        ring = shuffled(pairs, np.random.default_rng([self.seed, len(pairs)]))
        return shuffled(
            [ring[(number * count + step) % len(ring)] for step in range(count)], chance
        )

    def _attention_checks(
        self,
        segments: Sequence[Segment],
        pairs: Sequence[tuple[Segment, Pair]],
        chance: np.random.Generator,
    ) -> list[PlannedTrial]:
        """Return a check for each segment, with the conditions of `pairs` in turn."""
        shown = [(segment, pairs[index % len(pairs)][1]) for index, segment in enumerate(segments)]
        return [
            replace(trial, instructed=int(chance.choice(INSTRUCTED_ANSWERS)))
            for trial in self._trials("attention", shown, chance)
        ]


def _without_repetition(pairs: list[tuple[Segment, Pair]]) -> list[tuple[Segment, Pair]]:
    """Exchange pairs so that no segment comes twice with the same one, as far as possible."""
    times = Counter(pairs)
    for index, (segment, pair) in enumerate(pairs):
        if times[segment, pair] < 2:
            continue
        for other_index, (other_segment, other_pair) in enumerate(pairs):
            exchanged = ((segment, other_pair), (other_segment, pair))
            if not any(times[each] for each in exchanged):
                times.subtract((pairs[index], pairs[other_index]))
                times.update(exchanged)
                pairs[index], pairs[other_index] = exchanged
                break
    return pairs
