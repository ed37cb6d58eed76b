"""Protocols whose trials show several motions of one segment, one a video, in random order."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np
from pydantic import Field

from motion.segment import Segment
from studyapp.study.design.allocation import shuffled
from studyapp.study.design.order import number_trials, scatter_by_part
from studyapp.study.design.trial import Kind, PlannedTrial, Stimulus
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


def part_problems(key: str, parts: Sequence[Part], conditions: Collection[str]) -> list[str]:
    """Return what is wrong with `parts`, the value of `key`, in a study with these conditions."""
    problems = []
    names = [part.name for part in parts]
    if len(set(names)) != len(names):
        problems.append(f"{key}: two of them have the same name")
    for part in parts:
        unknown = [name for name in part.conditions if name not in conditions]
        if unknown:
            known = ", ".join(conditions)
            problems.append(f"{key}.{part.name}: {unknown[0]!r} is not a condition ({known})")
        if len(set(part.conditions)) != len(part.conditions):
            problems.append(f"{key}.{part.name}: a condition is listed twice")
    return problems


class GroupedStudy(Study):
    """A study whose participants judge every motion of a trial."""

    @property
    def asks_each_stimulus(self) -> bool:
        """Every motion is rated or ranked."""
        return True

    @property
    def reference_condition(self) -> str | None:
        """The condition that trials show for comparison, and that nobody judges."""
        return None

    @abstractmethod
    def instructions(self, part: Part) -> int:
        """Return the number of answers that an attention check in `part` can ask for."""

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

    def catch_trial(
        self, part: Part, segment: Segment, chance: np.random.Generator
    ) -> PlannedTrial:
        """Return a catch trial as large as those of `part`: good, flawed and other motion."""
        good = self.catch_against
        others = shuffled([name for name in part.conditions if name != good], chance)
        conditions = (good, self.catch.condition, *others[: max(0, len(part.conditions) - 2)])
        trial = self.trial("catch", part, segment, chance, conditions)
        return replace(trial, expected=1 + trial.conditions.index(good))

    def attention_check(
        self, part: Part, segment: Segment, chance: np.random.Generator
    ) -> PlannedTrial:
        """Return a trial that asks for one particular answer."""
        trial = self.trial("attention", part, segment, chance)
        return replace(trial, instructed=int(chance.integers(1, self.instructions(part) + 1)))

    def ordered(
        self,
        main: Sequence[PlannedTrial],
        catch: Iterable[tuple[Part, Segment]],
        attention: Iterable[tuple[Part, Segment]],
        chance: np.random.Generator,
    ) -> tuple[PlannedTrial, ...]:
        """Return the trials of all parts with catch trials and attention checks among them."""
        extra = [self.catch_trial(part, segment, chance) for part, segment in catch]
        extra += [self.attention_check(part, segment, chance) for part, segment in attention]
        return number_trials(scatter_by_part(extra, main, chance))
