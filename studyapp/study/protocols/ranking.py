"""ranking (diffsheg): several motions of one segment ranked, with the real one for comparison.

After DiffSHEG (Chen et al. 2024, section 4.3): blocks of shuffled videos of several conditions are
ranked on each question, beside the real recording. The paper leaves open:

- A block takes the segments whose duration lies in its range, so that one study can have a block
  of long and one of short videos.
- Every question needs a complete ranking. Motions share a rank only where the study allows ties;
  ranks then have no gaps (1, 1, 2).
- In a catch trial the flawed motion replaces one condition of a block. It is failed unless the
  flawed motion is ranked behind the good one on every question.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from motion.errors import counted
from motion.segment import Segment
from studyapp.study.design.allocation import allocate_segments, draw_segments, shuffled
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
from studyapp.study.settings.conditions import Catch, unknown_condition
from studyapp.study.settings.presentation import Message
from studyapp.study.settings.questions import Question
from studyapp.study.settings.sections import Name


class RankingBlock(Part):
    """Trials that rank the same conditions.

    Attributes
    ----------
    trials : int
        Trials of each participant.
    shortest, longest : float
        Range of the durations of its segments, in seconds.
    """

    trials: int = Field(8, ge=1, le=200)
    shortest: float = Field(0.0, ge=0, strict=False)
    longest: float = Field(3600.0, gt=0, strict=False)

    def segments(self, segments: Sequence[Segment]) -> list[Segment]:
        """Return those of `segments` that belong to the block."""
        return [s for s in segments if self.shortest <= s.duration <= self.longest]


class RankingStudy(GroupedStudy):
    """Rankings of the motions of one speech.

    Attributes
    ----------
    reference : str or None
        The condition that is shown for comparison and not ranked: the real recording.
    ties : bool
        Whether motions may share a rank.
    blocks : tuple of RankingBlock
        Shown one after the other.
    """

    is_ordered: ClassVar = True
    key_of_parts: ClassVar = "blocks"

    protocol: Literal["ranking"] = "ranking"
    participants: int = Field(22, ge=1, le=100_000)
    reference: Name | None = None
    ties: bool = False
    blocks: tuple[RankingBlock, ...] = Field(min_length=1, max_length=10, strict=False)
    catch: Catch = Catch(trials=0)

    def problems(self) -> list[str]:
        """Return everything that does not fit together."""
        problems = super().problems()
        problems += unknown_condition("reference", self.reference, self.conditions)
        for block in self.blocks:
            if self.reference in block.conditions:
                problems.append(f"blocks.{block.name}: the reference cannot be ranked")
        if self.catch.trials and self.catch_against == self.reference:
            problems.append("catch.against: the reference is not ranked (name another condition)")
        return problems

    @property
    def judged(self) -> tuple[str, ...]:
        """All conditions but the reference."""
        return tuple(name for name in self.conditions if name != self.reference)

    @property
    def roles(self) -> Mapping[str, str]:
        """The roles of the reference and of catch trials."""
        return ({self.reference: "reference"} if self.reference else {}) | dict(super().roles)

    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield every motion that may be ranked, and the reference beside it."""
        everywhere = [self.reference] if self.reference else []
        if self.catch.trials:
            everywhere += [self.catch_against, self.catch.condition]
        yield from dict.fromkeys(
            (Stimulus.own(condition, segment.name),)
            for block in self.blocks
            for condition in (*everywhere, *block.conditions)
            for segment in block.segments(segments)
        )

    def plan(
        self, arm: Arm, number: int, segments: Sequence[Segment], votes: Tally = NO_VOTES
    ) -> tuple[PlannedTrial, ...]:
        """Return one block after the other, with catch trials and attention checks among them."""
        del arm, votes
        chance = np.random.default_rng([number + 1, self.seed])
        main = []
        for block in self.blocks:
            allocated = allocate_segments(
                block.segments(segments),
                block.trials,
                number=number,
                seed=(self.seed, *block.name.encode()),
            )
            main += [
                self.trial("main", block, segment, chance)
                for segment in shuffled(allocated, chance)
            ]
        drawn = self._draw_extra(segments, [trial.segment for trial in main], chance)
        catch, attention = drawn[: self.catch.trials], drawn[self.catch.trials :]
        return self.ordered(main, catch, attention, chance)

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the ranks, 1 the best."""
        del question
        return range(1, len(trial.conditions) + 1)

    def problem(self, trial: Trial, answers: Answers) -> Message | None:
        """Name the first question whose ranks are not a ranking."""
        questions = [question for question in self.questions if question.belongs_to(trial.part)]
        for number, question in enumerate(questions, start=1):
            ranks = [value for (name, _), value in answers.items() if name == question.name]
            if not self.ties and len(set(ranks)) != len(ranks):
                return Message(
                    "In question {number}, two videos have the same rank.", number=number
                )
            if set(ranks) != set(range(1, len(set(ranks)) + 1)):
                return Message("In question {number}, a rank is left out.", number=number)
        return None

    def disobeys(self, trial: Trial, answers: Answers) -> bool:
        """Tell whether the motion that an attention check wants first is not first."""
        return any(rank != 1 for (_, number), rank in answers.items() if number == trial.instructed)

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Say which blocks have fewer segments than trials, and whether there is no reference."""
        notes = [
            f"block {block.name} has {counted(len(block.segments(segments)), 'segment')} for its "
            f"{counted(block.trials, 'trial')}, and shows each once"
            for block in self.blocks
            if len(block.segments(segments)) < block.trials
        ]
        if self.reference is None:
            notes.append("no reference is shown; the published design shows the real recording")
        return tuple(notes)

    @property
    def reference_condition(self) -> str | None:
        """The reference."""
        return self.reference

    def _draw_extra(
        self, segments: Sequence[Segment], used: Sequence[Segment], chance: np.random.Generator
    ) -> list[tuple[RankingBlock, Segment]]:
        """Return blocks in turn for all extra trials, each with a segment in its range."""
        blocks = [block for block in self.blocks if block.segments(segments)]
        count = self.catch.trials + self.attention.trials if blocks else 0
        first = int(chance.integers(len(blocks))) if count else 0
        drawn: list[tuple[RankingBlock, Segment]] = []
        for index in range(first, first + count):
            block = blocks[index % len(blocks)]
            taken = [*used, *(segment for _, segment in drawn)]
            (segment,) = draw_segments(block.segments(segments), 1, chance, used=taken)
            drawn.append((block, segment))
        return drawn
