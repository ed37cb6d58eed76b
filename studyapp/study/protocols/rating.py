"""rating (s2ue): several motions of one speech on one page, each rated on every question.

After S2UE (Bhattacharya et al. 2024, section 7): sets of groups; a group is one speech, drawn at
random, with one motion of each condition of its set, in random order. What the paper leaves open
is decided here:

- Speech is drawn along a ring, so that all segments are judged equally often; no group of a
  participant has the speech of another one as long as there are enough.
- A catch trial puts the flawed motion in the place of one condition of a set. It is failed when
  the flawed motion is not rated below the ground truth on every question.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np
from pydantic import Field

from motion.segment import Segment
from studyapp.study.design.allocation import allocate_segments, shuffled
from studyapp.study.design.order import draw_segments
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
from studyapp.study.protocols.grouped import GroupedStudy, Part, part_problems
from studyapp.study.settings.conditions import Catch
from studyapp.study.settings.questions import SCALE_STEPS, Question, RatingQuestion


class RatingSet(Part):
    """Groups of motions of the same conditions.

    Attributes
    ----------
    groups : int
        Pages of this set that each participant rates; S2UE has eight.
    """

    groups: int = Field(8, ge=1, le=200)


class RatingStudy(GroupedStudy):
    """Ratings of single motions.

    Attributes
    ----------
    participants : int
        How many are wanted; S2UE has 90.
    sets : tuple of RatingSet
        Shown one after the other.
    """

    protocol: Literal["rating"] = "rating"
    participants: int = Field(90, ge=1, le=100_000)
    sets: tuple[RatingSet, ...] = Field(min_length=1, max_length=10, strict=False)
    catch: Catch = Catch(trials=0)
    questions: tuple[RatingQuestion, ...] = Field(min_length=1, max_length=8, strict=False)

    def problems(self) -> list[str]:
        """Return everything that does not fit together."""
        return [*super().problems(), *part_problems("sets", self.sets, self.conditions)]

    @property
    def parts(self) -> tuple[str, ...]:
        """The sets."""
        return tuple(part.name for part in self.sets)

    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield every motion that may be rated."""
        shown = dict.fromkeys(name for part in self.sets for name in part.conditions)
        if self.catch.trials:
            shown.update(dict.fromkeys((self.catch_against, self.catch.condition)))
        for condition in shown:
            for segment in segments:
                yield (Stimulus.own(condition, segment.name),)

    def plan(
        self, arm: Arm, number: int, segments: Sequence[Segment], votes: Tally = NO_VOTES
    ) -> tuple[PlannedTrial, ...]:
        """Return the sets one after the other, catch trials and attention checks among them."""
        del arm, votes
        chance = np.random.default_rng([number + 1, self.seed])
        wanted = sum(part.groups for part in self.sets)
        ring = shuffled(
            allocate_segments(segments, wanted, number=number, seed=(self.seed,)), chance
        )
        main: list[PlannedTrial] = []
        for part in self.sets:
            groups = min(part.groups, len(ring))
            ring = [*ring[groups:], *ring[:groups]] if groups else ring
            heard = ring[-groups:] if groups else []
            main += [self.trial("main", part, segment, chance) for segment in heard]
        drawn = draw_segments(
            segments,
            self.catch.trials + self.attention.trials,
            chance,
            heard=[trial.segment for trial in main],
        )
        catch, attention = drawn[: self.catch.trials], drawn[self.catch.trials :]
        return self.ordered(
            main, self._in_turn(catch, chance), self._in_turn(attention, chance), chance
        )

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the steps of the question's scale."""
        del trial
        return self._scale(question.name).values

    def prefers(self, answers: Answers, better: int, worse: int) -> bool:
        """Tell whether `better` is rated above `worse` on every question."""
        return all(
            value > answers[question, worse]
            for (question, number), value in answers.items()
            if number == better
        )

    def disobeys(self, trial: Trial, answers: Answers) -> bool:
        """Tell whether a rating is not under the label that an attention check asks for."""
        return any(
            self._scale(question).step(value) != trial.instructed
            for (question, _), value in answers.items()
        )

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Say where there are too few segments for groups of different speech."""
        wanted = sum(part.groups for part in self.sets)
        if len(segments) >= wanted:
            return ()
        return (
            f"{len(segments)} segments are fewer than the {wanted} groups each participant rates, "
            "so that the same speech comes in several sets, and no set has more groups than that",
        )

    def _scale(self, name: str) -> RatingQuestion:
        return next(question for question in self.questions if question.name == name)

    def instructions(self, part: Part) -> int:
        """Return the steps of a scale."""
        del part
        return SCALE_STEPS

    def _in_turn(
        self, segments: Sequence[Segment], chance: np.random.Generator
    ) -> Iterator[tuple[RatingSet, Segment]]:
        """Yield each segment with a set, these in turn beginning with any."""
        first = int(chance.integers(len(self.sets)))
        for index, segment in enumerate(segments, start=first):
            yield self.sets[index % len(self.sets)], segment
