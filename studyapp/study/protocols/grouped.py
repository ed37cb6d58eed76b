"""Protocols whose trials show several motions of one segment, one a video, in random order."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from pydantic import Field

from motion.segment import Segment
from studyapp.study.design.allocation import number_trials, scatter_by_part, shuffled
from studyapp.study.design.trial import Answers, Kind, PlannedTrial, Stimulus
from studyapp.study.settings.conditions import unknown_condition
from studyapp.study.settings.questions import SCALE_STEPS
from studyapp.study.settings.sections import Name, Section
from studyapp.study.settings.study import Study


class Part(Section):
    """One part of a study session.

    Attributes
    ----------
    name : str
        Its name in questions and in the export.
    conditions : tuple of str
        The conditions shown together on each of its pages.
    """

    name: Name
    conditions: tuple[Name, ...] = Field(min_length=2, max_length=8, strict=False)


class GroupedStudy(Study):
    """A study whose participants judge every motion of a trial.

    Attributes
    ----------
    key_of_parts : str
        The key of its parts in the study file.
    """

    asks_each_stimulus: ClassVar = True

    key_of_parts: ClassVar[str]

    def problems(self) -> list[str]:
        """Return everything that does not fit together."""
        problems = super().problems()
        parts: Sequence[Part] = getattr(self, self.key_of_parts)
        if len(set(self.parts)) != len(parts):
            problems.append(f"{self.key_of_parts}: two of them have the same name")
        for part in parts:
            key = f"{self.key_of_parts}.{part.name}"
            for name in part.conditions:
                problems += unknown_condition(f"{key}:", name, self.conditions)
            if len(set(part.conditions)) != len(part.conditions):
                problems.append(f"{key}: a condition is listed twice")
        return problems

    @property
    def parts(self) -> tuple[str, ...]:
        """The names of the sets or blocks."""
        return tuple(part.name for part in getattr(self, self.key_of_parts))

    @property
    def reference_condition(self) -> str | None:
        """The condition that trials show for comparison, and that nobody judges."""
        return None

    def prefers(self, answers: Answers, better: int, worse: int) -> bool:
        """Tell whether `better` is rated above, or ranked before, `worse` on every question."""
        higher, lower = (worse, better) if self.is_ordered else (better, worse)
        return all(
            value > answers[question, lower]
            for (question, number), value in answers.items()
            if number == higher
        )

    def trial(
        self,
        kind: Kind,
        part: Part,
        segment: Segment,
        chance: np.random.Generator,
        conditions: Sequence[str] = (),
    ) -> PlannedTrial:
        """Return a trial of `conditions`, by default those of `part`, without a position."""
        reference = self.reference_condition
        return PlannedTrial(
            position=0,
            kind=kind,
            part=part.name,
            segment=segment,
            reference=None if reference is None else Stimulus.own(reference, segment.name),
            videos=tuple(
                (Stimulus.own(condition, segment.name),)
                for condition in shuffled(conditions or part.conditions, chance)
            ),
        )

    def ordered(
        self,
        main: Sequence[PlannedTrial],
        catch: Iterable[tuple[Part, Segment]],
        attention: Iterable[tuple[Part, Segment]],
        chance: np.random.Generator,
    ) -> tuple[PlannedTrial, ...]:
        """Return the trials of all parts with catch trials and attention checks among them.

        A catch trial is as large as the others of its part: good, flawed and other motion.
        """
        extra: list[PlannedTrial] = []
        good = self.catch_against
        for part, segment in catch:
            others = shuffled([name for name in part.conditions if name != good], chance)
            conditions = (good, self.catch.condition, *others[: max(0, len(part.conditions) - 2)])
            trial = self.trial("catch", part, segment, chance, conditions)
            extra.append(replace(trial, expected=1 + trial.conditions.index(good)))
        for part, segment in attention:
            trial = self.trial("attention", part, segment, chance)
            answers = len(part.conditions) if self.is_ordered else SCALE_STEPS
            extra.append(replace(trial, instructed=int(chance.integers(1, answers + 1))))
        return number_trials(scatter_by_part(extra, main, chance))
