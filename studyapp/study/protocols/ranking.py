"""ranking (diffsheg): several motions of one speech put in order, the real one as a yardstick.

After DiffSHEG (Chen et al. 2024, section 4.3): blocks of videos of several conditions, shuffled,
are put in order on each question, with the real recording shown apart. What the paper leaves
open is decided here:

- A block takes the segments whose length lies in its range, so that one study can have a block
  of long and one of short videos.
- Every question needs a whole order. Two motions share a rank only where the study allows ties;
  then ranks are counted without gaps (1, 1, 2).
- A catch trial puts the flawed motion in the place of one condition of a block. It is failed when
  the flawed motion is not ranked behind the unflawed one it is shown beside on every question.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
from studyapp.study.settings.presentation import Message
from studyapp.study.settings.questions import Question
from studyapp.study.settings.sections import Name


class RankingBlock(Part):
    """Trials that rank the same conditions.

    Attributes
    ----------
    trials : int
        How many each participant ranks.
    shortest, longest : float
        Only segments of at least and at most so many seconds belong to the block.
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
    participants : int
        How many are wanted; DiffSHEG has 22.
    reference : str or None
        The condition that is shown apart and not ranked, the real recording.
    ties : bool
        Whether two motions may share a rank.
    blocks : tuple of RankingBlock
        Shown one after the other.
    """

    protocol: Literal["ranking"] = "ranking"
    participants: int = Field(22, ge=1, le=100_000)
    reference: Name | None = None
    ties: bool = False
    blocks: tuple[RankingBlock, ...] = Field(min_length=1, max_length=10, strict=False)
    catch: Catch = Catch(trials=0)

    def problems(self) -> list[str]:
        """Return everything that does not fit together."""
        problems = [*super().problems(), *part_problems("blocks", self.blocks, self.conditions)]
        if self.reference is not None and self.reference not in self.conditions:
            known = ", ".join(self.conditions)
            problems.append(f"reference {self.reference!r} is not a condition ({known})")
        for block in self.blocks:
            if self.reference in block.conditions:
                problems.append(f"blocks.{block.name}: the reference is not ranked")
            if block.shortest > block.longest:
                problems.append(f"blocks.{block.name}: shortest is above longest")
        if self.catch.trials and self.catch_against == self.reference:
            problems.append("catch.against: the reference is shown apart (name a ranked condition)")
        return problems

    @property
    def parts(self) -> tuple[str, ...]:
        """The blocks."""
        return tuple(block.name for block in self.blocks)

    @property
    def roles(self) -> Mapping[str, str]:
        """The reference, and what all protocols have."""
        return {**dict.fromkeys(self._apart, "reference"), **super().roles}

    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield every motion that may be ranked, and the reference beside it."""
        yield from dict.fromkeys(
            (Stimulus.own(condition, segment.name),)
            for block in self.blocks
            for condition in (*self._apart, *block.conditions, *self._caught)
            for segment in block.segments(segments)
        )

    def plan(
        self, arm: Arm, number: int, segments: Sequence[Segment], votes: Tally = NO_VOTES
    ) -> tuple[PlannedTrial, ...]:
        """Return the blocks one after the other, catch trials and attention checks among them."""
        del arm, votes
        chance = np.random.default_rng([number + 1, self.seed])
        main = []
        for block in self.blocks:
            heard = allocate_segments(
                block.segments(segments),
                block.trials,
                number=number,
                seed=(self.seed, *block.name.encode()),
            )
            main += [
                self.trial("main", block, segment, chance) for segment in shuffled(heard, chance)
            ]
        drawn = self._extra(segments, [trial.segment for trial in main], chance)
        catch, attention = drawn[: self.catch.trials], drawn[self.catch.trials :]
        return self.ordered(main, catch, attention, chance)

    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the ranks, 1 the best."""
        del question
        return range(1, len(trial.conditions) + 1)

    @property
    def is_ordered(self) -> bool:
        """The ranks of all motions make one order."""
        return True

    def problem(self, trial: Trial, answers: Answers) -> Message | None:
        """Say on which question the ranks make no order."""
        asked = [question for question in self.questions if question.belongs_to(trial.part)]
        for place, question in enumerate(asked, start=1):
            ranks = [value for (name, _), value in answers.items() if name == question.name]
            whole = set(ranks) == set(range(1, len(set(ranks)) + 1))
            if not self.ties and len(set(ranks)) != len(ranks):
                return Message("In question {number}, two videos have the same rank.", number=place)
            if not whole:
                return Message("In question {number}, a rank is left out.", number=place)
        return None

    def prefers(self, answers: Answers, better: int, worse: int) -> bool:
        """Tell whether `better` is ranked before `worse` on every question."""
        return all(
            rank < answers[question, worse]
            for (question, number), rank in answers.items()
            if number == better
        )

    def disobeys(self, trial: Trial, answers: Answers) -> bool:
        """Tell whether the motion that an attention check asks to put first is not first."""
        return any(rank != 1 for (_, number), rank in answers.items() if number == trial.instructed)

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Say which blocks have fewer segments than trials, and that no reference is shown."""
        unseen = "no reference is shown; the published design shows the real recording apart"
        return (*self._short(segments), *((unseen,) if self.reference is None else ()))

    def _short(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        return tuple(
            f"block {block.name} has {len(block.segments(segments))} segments for its "
            f"{block.trials} trials, and shows each of them once"
            for block in self.blocks
            if len(block.segments(segments)) < block.trials
        )

    @property
    def shown_apart(self) -> str | None:
        """The reference."""
        return self.reference

    def instructions(self, part: Part) -> int:
        """Return the motions that may be asked to be put first."""
        return len(part.conditions)

    @property
    def _apart(self) -> tuple[str, ...]:
        return () if self.reference is None else (self.reference,)

    @property
    def _caught(self) -> tuple[str, ...]:
        return (self.catch_against, self.catch.condition) if self.catch.trials else ()

    def _extra(
        self, segments: Sequence[Segment], heard: Sequence[Segment], chance: np.random.Generator
    ) -> list[tuple[RankingBlock, Segment]]:
        """Return blocks in turn for all extra trials, each with a segment of its own range."""
        blocks = [block for block in self.blocks if block.segments(segments)]
        count = self.catch.trials + self.attention.trials if blocks else 0
        first = int(chance.integers(len(blocks))) if count else 0
        drawn: list[tuple[RankingBlock, Segment]] = []
        for index in range(first, first + count):
            block = blocks[index % len(blocks)]
            taken = [*heard, *(segment for _, segment in drawn)]
            (segment,) = draw_segments(block.segments(segments), 1, chance, heard=taken)
            drawn.append((block, segment))
        return drawn
