"""mismatch: which of two segments' speech a motion fits, and how real motions look without sound.

After the GENEA evaluations (Kucherenko et al. 2023; the leaderboard of arXiv 2511.01233). The
task ``fit`` shows one motion twice, with its own and with another segment's speech, in two
players. The task ``realism`` shows two conditions without sound. The papers leave open:

- The mismatched speech of a segment is the same for all participants and conditions: the next one,
  in an order drawn once per study, that is at least as long. So each motion needs only two videos.
- Conditions, or pairs of them, are shown equally often; sides are balanced within a participant.
- Catch trials belong to the task ``realism``; the task ``fit`` alone has none.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import Final, Literal

import numpy as np
from pydantic import Field

from motion.segment import Segment
from studyapp.study.design.allocation import (
    PREFERENCES,
    Levels,
    StimulusPair,
    allocate_segments,
    even_quotas,
    number_trials,
    pair_trials,
    scatter_by_part,
    shuffled,
)
from studyapp.study.design.trial import (
    NO_VOTES,
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
"""Seconds by which mismatched speech may be shorter than the motion."""


class MismatchQuestion(Question):
    """A question about two players.

    Attributes
    ----------
    levels : {2, 3, 5}
        The number of answers: A or B; with 'no difference'; or each clearly and slightly.
    """

    levels: Levels = 3


class MismatchStudy(Study):
    """Whether motion fits its speech, and whether it looks real.

    Attributes
    ----------
    fit, realism : int
        Trials of each task; 0 leaves the task out.
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
            problems.append("realism compares conditions, but there is only one")
        if self.catch.trials and not self.realism:
            problems.append("catch trials belong to the task realism, which has no trials")
        return problems

    @property
    def parts(self) -> tuple[str, ...]:
        """The tasks."""
        tasks = {FIT: self.fit, REALISM: self.realism}
        return tuple(task for task, trials in tasks.items() if trials)

    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield every motion with its own speech, with other speech, and without sound."""
        mismatched = self._mismatched_speech(segments)
        for condition in self.conditions if self.fit else ():
            for segment in segments:
                for stimulus in _matched_and_mismatched(condition, segment, mismatched):
                    yield (stimulus,)
        compared = self.conditions if self.realism else ()
        in_catch_trials = (self.catch_against, self.catch.condition) if self.catch.trials else ()
        for condition in dict.fromkeys((*compared, *in_catch_trials)):
            for segment in segments:
                yield (_muted(condition, segment),)

    def plan(
        self, arm: Arm, number: int, segments: Sequence[Segment], votes: Tally = NO_VOTES
    ) -> tuple[PlannedTrial, ...]:
        """Return one task after the other, with catch trials and attention checks among them."""
        del arm, votes
        chance = np.random.default_rng([number + 1, self.seed])
        fit = self._fit_pairs(number, segments, chance)
        main = pair_trials("main", fit, chance, composed=False, part=FIT)
        realism = self._realism_pairs(number, segments, chance)
        main += pair_trials("main", realism, chance, composed=False, part=REALISM)
        catch, attention = self.draw_extra_segments(segments, main, chance)
        caught = partial(_muted_pair, self.catch_against, self.catch.condition)
        broken = [(segment, *caught(segment)) for segment in catch]
        extra = [
            *pair_trials("catch", broken, chance, composed=False, part=REALISM),
            *self._attention_checks(attention, main, segments, chance),
        ]
        return number_trials(scatter_by_part(extra, main, chance))

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the question's levels of preference."""
        del trial
        levels = next(each.levels for each in self.questions if each.name == question.name)
        return PREFERENCES[levels]

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Name the motions that are longer than their mismatched speech."""
        durations = {segment.name: segment.duration for segment in segments}
        long = [
            name
            for name, speech in self._mismatched_speech(segments).items()
            if durations[speech] < durations[name] - DURATION_TOLERANCE
        ]
        if not self.fit or not long:
            return ()
        return (f"no other speech is as long as {', '.join(long)}: the motion outlasts it",)

    def _mismatched_speech(self, segments: Sequence[Segment]) -> dict[str, str]:
        """Return the segment whose speech each segment's mismatched motion is shown with."""
        ring = shuffled(segments, np.random.default_rng([self.seed, len(segments)]))
        mismatched = {}
        for index, segment in enumerate(ring):
            others = [*ring[index + 1 :], *ring[:index]]
            enough = [s for s in others if s.duration >= segment.duration - DURATION_TOLERANCE]
            longest = sorted(others, key=lambda s: s.duration, reverse=True)
            for other in (enough or longest)[:1]:
                mismatched[segment.name] = other.name
        return mismatched

    def _fit_pairs(
        self, number: int, segments: Sequence[Segment], chance: np.random.Generator
    ) -> list[StimulusPair]:
        mismatched = self._mismatched_speech(segments)
        pairs = {
            condition: partial(_matched_and_mismatched, condition, mismatched=mismatched)
            for condition in self.conditions
        }
        return self._allocate(
            pairs, self.fit, number, [s for s in segments if s.name in mismatched], chance
        )

    def _realism_pairs(
        self, number: int, segments: Sequence[Segment], chance: np.random.Generator
    ) -> list[StimulusPair]:
        pairs = {
            f"{a} {b}": partial(_muted_pair, a, b) for a, b in combinations(self.conditions, 2)
        }
        return self._allocate(pairs, self.realism, number, segments, chance)

    def _allocate(
        self,
        pairs: Mapping[str, Callable[[Segment], tuple[Stimulus, Stimulus]]],
        trials: int,
        number: int,
        segments: Sequence[Segment],
        chance: np.random.Generator,
    ) -> list[StimulusPair]:
        """Return the pairs of one task, shuffled: each of `pairs` equally often over segments."""
        available = dict.fromkeys(pairs, len(segments))
        quotas = [even_quotas(available, trials, earlier) for earlier in range(number + 1)]
        return shuffled(
            [
                (segment, *stimuli(segment))
                for name, stimuli in pairs.items()
                for segment in allocate_segments(
                    segments,
                    quotas[number][name],
                    number=number,
                    seed=(self.seed, *name.encode()),
                    before=[quota[name] for quota in quotas[:number]],
                )
            ],
            chance,
        )

    def _attention_checks(
        self,
        drawn: Sequence[Segment],
        main: Sequence[PlannedTrial],
        segments: Sequence[Segment],
        chance: np.random.Generator,
    ) -> list[PlannedTrial]:
        """Return a check for each `drawn` segment that looks like one of the main trials."""
        templates = shuffled(main, chance)
        mismatched = self._mismatched_speech(segments)
        checks: list[PlannedTrial] = []
        for index, segment in enumerate(drawn if templates else ()):
            template = templates[index % len(templates)]
            first, second = template.conditions
            stimuli = _muted_pair(first, second, segment)
            if template.part == FIT:
                stimuli = _matched_and_mismatched(first, segment, mismatched)
            checks += pair_trials(
                "attention", [(segment, *stimuli)], chance, composed=False, part=template.part
            )
        return [replace(check, instructed=int(chance.choice((-1, 1)))) for check in checks]


def _matched_and_mismatched(
    condition: str, segment: Segment, mismatched: Mapping[str, str]
) -> tuple[Stimulus, Stimulus]:
    matched = Stimulus.own(condition, segment.name)
    return matched, replace(matched, speech=mismatched.get(segment.name))


def _muted_pair(first: str, second: str, segment: Segment) -> tuple[Stimulus, Stimulus]:
    return _muted(first, segment), _muted(second, segment)


def _muted(condition: str, segment: Segment) -> Stimulus:
    return Stimulus(condition=condition, segment=segment.name, speech=None)
