"""rating (s2ue): several motions of one segment on one page, each rated on every question.

After S2UE (Bhattacharya et al. 2024, section 7): sets of groups; a group is one randomly drawn
segment with one motion of each condition of its set, in random order. The paper leaves open:

- Segments are drawn along a ring, so that all are judged equally often; a participant's groups
  have different segments as long as there are enough.
- In a catch trial the flawed motion replaces one condition of a set. It is failed unless the
  flawed motion is rated below the ground truth on every question.
"""

from collections.abc import Iterator, Sequence
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from motion.errors import counted
from motion.segment import Segment
from studyapp.study.design.allocation import allocate_segments, shuffled
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
from studyapp.study.protocols.grouped import GroupedStudy, Part
from studyapp.study.settings.conditions import Catch
from studyapp.study.settings.questions import Question, RatingQuestion


class RatingSet(Part):
    """Groups of motions of the same conditions.

    Attributes
    ----------
    groups : int
        Pages of the set that each participant rates; S2UE has eight.
    """

    groups: int = Field(8, ge=1, le=200)


class RatingStudy(GroupedStudy):
    """Ratings of single motions.

    Attributes
    ----------
    sets : tuple of RatingSet
        Shown one after the other.
    """

    key_of_parts: ClassVar = "sets"

    protocol: Literal["rating"] = "rating"
    participants: int = Field(90, ge=1, le=100_000)
    sets: tuple[RatingSet, ...] = Field(min_length=1, max_length=10, strict=False)
    catch: Catch = Catch(trials=0)
    questions: tuple[RatingQuestion, ...] = Field(min_length=1, max_length=8, strict=False)

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
        """Return one set after the other, with catch trials and attention checks among them."""
        del arm, votes
        chance = np.random.default_rng([number + 1, self.seed])
        groups = sum(part.groups for part in self.sets)
        ring = shuffled(
            allocate_segments(segments, groups, number=number, seed=(self.seed,)), chance
        )
        main: list[PlannedTrial] = []
        for part in self.sets:
            drawn = ring[: part.groups]
            ring = [*ring[len(drawn) :], *drawn]
            main += [self.trial("main", part, segment, chance) for segment in drawn]
        catch, attention = self.draw_extra_segments(segments, main, chance)
        return self.ordered(
            main, self._in_turn(catch, chance), self._in_turn(attention, chance), chance
        )

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the steps of the question's scale."""
        del trial
        return self._scale(question.name).values

    def disobeys(self, trial: Trial, answers: Answers) -> bool:
        """Tell whether a rating has another label than the attention check asks for."""
        return any(
            self._scale(question).step(value) != trial.instructed
            for (question, _), value in answers.items()
        )

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Say whether there are too few segments for groups of different speech."""
        groups = sum(part.groups for part in self.sets)
        if len(segments) >= groups:
            return ()
        return (
            f"each participant should rate {groups} groups, but the study has only "
            f"{counted(len(segments), 'segment')}: sets share segments, and no set has more groups "
            "than there are segments",
        )

    def _scale(self, name: str) -> RatingQuestion:
        return next(question for question in self.questions if question.name == name)

    def _in_turn(
        self, segments: Sequence[Segment], chance: np.random.Generator
    ) -> Iterator[tuple[RatingSet, Segment]]:
        """Yield each segment with a set, taking turns from a random one on."""
        first = int(chance.integers(len(self.sets)))
        for index, segment in enumerate(segments, start=first):
            yield self.sets[index % len(self.sets)], segment
