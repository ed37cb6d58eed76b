"""mismatch: which of two speeches a motion fits, and how real motions look without any.

After the GENEA evaluations (Kucherenko et al. 2023; the leaderboard of arXiv 2511.01233). The
task ``fit`` shows one motion twice, with its own and with another segment's speech, in two
players. The task ``realism`` shows two conditions without sound. What is decided here:

- The other speech of a segment is the same for all participants and conditions: the next one, in
  an order drawn once per study, that is at least as long. So each motion needs two videos only.
- Conditions, or pairs of them, come equally often; sides are balanced within a participant.
- Catch trials belong to the task ``realism``; with the task ``fit`` alone there are none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final, Literal

import numpy as np
from pydantic import Field

from motion.segment import Segment
from studyapp.study.design.allocation import allocate_segments, even_quotas, shuffled
from studyapp.study.design.order import (
    PREFERENCES,
    Levels,
    StimulusPair,
    draw_segments,
    number_trials,
    pair_trials,
    prefers_side,
    scatter_by_part,
)
from studyapp.study.design.trial import (
    NO_VOTES,
    Answers,
    Arm,
    Content,
    PlannedTrial,
    Stimulus,
    Tally,
    Trial,
)
from studyapp.study.settings.conditions import Catch
from studyapp.study.settings.questions import Question
from studyapp.study.settings.study import Study

FIT: Final = "fit"
REALISM: Final = "realism"

DURATION_TOLERANCE: Final = 0.05
"""Seconds by which another speech may be shorter than the motion."""


class MismatchQuestion(Question):
    """A question between two players.

    Attributes
    ----------
    levels : {2, 3, 5}
        How many answers there are: A or B; with 'no difference'; or clearly and slightly each.
    """

    levels: Levels = 3


class MismatchStudy(Study):
    """Whether motion fits its speech, and whether it looks real.

    Attributes
    ----------
    participants : int
        How many are wanted.
    fit, realism : int
        Trials of each task; 0 leaves a task out.
    """

    protocol: Literal["mismatch"] = "mismatch"
    participants: int = Field(30, ge=1, le=100_000)
    fit: int = Field(24, ge=0, le=500)
    realism: int = Field(0, ge=0, le=500)
    catch: Catch = Catch(trials=0)
    questions: tuple[MismatchQuestion, ...] = Field(min_length=1, max_length=8, strict=False)

    def problems(self) -> list[str]:
        """Return everything that does not fit together."""
        problems = super().problems()
        if not self.parts:
            problems.append("fit and realism are both 0, so there is no task")
        if self.realism and len(self.conditions) < 2:
            problems.append("realism compares conditions, and there is only one")
        if self.catch.trials and not self.realism:
            problems.append("catch trials belong to the task realism, which has no trials")
        return problems

    @property
    def parts(self) -> tuple[str, ...]:
        """The tasks."""
        return tuple(name for name, n in ((FIT, self.fit), (REALISM, self.realism)) if n)

    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield every motion with its own and with another speech, and without sound."""
        other = self._other_speech(segments)
        for condition in self.conditions if self.fit else ():
            for segment in segments:
                for stimulus in _matched_and_mismatched(condition, segment, other):
                    yield (stimulus,)
        muted = self.conditions if self.realism else ()
        caught = (self.catch_against, self.catch.condition) if self.catch.trials else ()
        for condition in dict.fromkeys((*muted, *caught)):
            for segment in segments:
                yield (_muted(condition, segment),)

    def plan(
        self, arm: Arm, number: int, segments: Sequence[Segment], votes: Tally = NO_VOTES
    ) -> tuple[PlannedTrial, ...]:
        """Return the tasks one after the other, catch trials and attention checks among them."""
        del arm, votes
        chance = np.random.default_rng([number + 1, self.seed])
        fit = pair_trials(
            "main", self._fitting(number, segments, chance), chance, composed=False, part=FIT
        )
        real = pair_trials(
            "main", self._real(number, segments, chance), chance, composed=False, part=REALISM
        )
        heard = [trial.segment for trial in (*fit, *real)]
        drawn = draw_segments(
            segments, self.catch.trials + self.attention.trials, chance, heard=heard
        )
        extra = [
            *self._catch(drawn[: self.catch.trials], chance),
            *self._attention(drawn[self.catch.trials :], [*fit, *real], segments, chance),
        ]
        return number_trials(scatter_by_part(extra, [*fit, *real], chance))

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the levels of preference that the question has."""
        del trial
        levels = next(asked.levels for asked in self.questions if asked.name == question.name)
        return PREFERENCES[levels]

    def prefers(self, answers: Answers, better: int, worse: int) -> bool:
        """Tell whether every answer prefers side `better`, however little."""
        del worse
        return prefers_side(answers, better)

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Say which motions outlast the other speech they are shown with."""
        by_name = {segment.name: segment for segment in segments}
        short = [
            name
            for name, speech in self._other_speech(segments).items()
            if by_name[speech].duration < by_name[name].duration - DURATION_TOLERANCE
        ]
        return (
            (f"no other speech is as long as that of {', '.join(short)}: it ends before them",)
            if self.fit and short
            else ()
        )

    def _other_speech(self, segments: Sequence[Segment]) -> dict[str, str]:
        """Return, for each segment, the other one whose speech its motion is shown with."""
        ring = shuffled(segments, np.random.default_rng([self.seed, len(segments)]))
        other = {}
        for index, segment in enumerate(ring):
            following = [*ring[index + 1 :], *ring[:index]]
            enough = [s for s in following if s.duration >= segment.duration - DURATION_TOLERANCE]
            longest = sorted(following, key=lambda s: s.duration, reverse=True)
            for chosen in (enough or longest)[:1]:
                other[segment.name] = chosen.name
        return other

    def _fitting(
        self, number: int, segments: Sequence[Segment], chance: np.random.Generator
    ) -> list[StimulusPair]:
        other = self._other_speech(segments)
        available = {condition: len(other) for condition in self.conditions}
        return shuffled(
            [
                (segment, *_matched_and_mismatched(condition, segment, other))
                for condition, counts in _trial_counts(available, self.fit, number).items()
                for segment in allocate_segments(
                    segments if other else (),
                    counts[-1],
                    number=number,
                    seed=(self.seed, *condition.encode()),
                    before=counts[:-1],
                )
            ],
            chance,
        )

    def _real(
        self, number: int, segments: Sequence[Segment], chance: np.random.Generator
    ) -> list[StimulusPair]:
        pairs = {f"{a} {b}": (a, b) for a, b in combinations(self.conditions, 2)}
        available = dict.fromkeys(pairs, len(segments))
        return shuffled(
            [
                (segment, _muted(pairs[name][0], segment), _muted(pairs[name][1], segment))
                for name, counts in _trial_counts(available, self.realism, number).items()
                for segment in allocate_segments(
                    segments,
                    counts[-1],
                    number=number,
                    seed=(self.seed, *name.encode()),
                    before=counts[:-1],
                )
            ],
            chance,
        )

    def _catch(self, heard: Sequence[Segment], chance: np.random.Generator) -> list[PlannedTrial]:
        right, flawed = self.catch_against, self.catch.condition
        shown = [(segment, _muted(right, segment), _muted(flawed, segment)) for segment in heard]
        return [
            replace(trial, expected=1 + trial.conditions.index(right))
            for trial in pair_trials("catch", shown, chance, composed=False, part=REALISM)
        ]

    def _attention(
        self,
        heard: Sequence[Segment],
        ordinary: Sequence[PlannedTrial],
        segments: Sequence[Segment],
        chance: np.random.Generator,
    ) -> list[PlannedTrial]:
        """Return a check for each of `heard` that looks like some of the ordinary trials."""
        looks = shuffled(ordinary, chance)
        other = self._other_speech(segments)
        checks: list[PlannedTrial] = []
        for index, segment in enumerate(heard if looks else ()):
            like = looks[index % len(looks)]
            first, second = like.conditions
            sides = _muted(first, segment), _muted(second, segment)
            if like.part == FIT:
                sides = _matched_and_mismatched(first, segment, other)
            checks += pair_trials(
                "attention", [(segment, *sides)], chance, composed=False, part=like.part
            )
        return [replace(check, instructed=int(chance.choice((-1, 1)))) for check in checks]


def _trial_counts(available: Mapping[str, int], total: int, number: int) -> dict[str, list[int]]:
    """Return how many trials of each kind the participants up to `number` get, one by one."""
    quotas = [even_quotas(available, total, earlier) for earlier in range(number + 1)]
    return {name: [quota[name] for quota in quotas] for name in available}


def _matched_and_mismatched(
    condition: str, segment: Segment, other: dict[str, str]
) -> tuple[Stimulus, Stimulus]:
    own = Stimulus.own(condition, segment.name)
    return own, replace(own, speech=other.get(segment.name))


def _muted(condition: str, segment: Segment) -> Stimulus:
    return Stimulus(condition=condition, segment=segment.name, speech=None)
