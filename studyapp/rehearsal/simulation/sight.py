"""What a simulated rater's eyes tell it of one trial."""

from __future__ import annotations

from dataclasses import dataclass

from studyapp.study.design.stimulus import Stimulus


@dataclass(frozen=True, kw_only=True)
class SeenTrial:
    """One presentation, with what its page hides.

    Attributes
    ----------
    position : int
        Which presentation of the study session it is.
    kind, part : str
        As they were planned.
    segment : str
        The speech it is about.
    stimuli : tuple of Stimulus
        What is judged, number 1 (A) first.
    expected : int or None
        Of a catch trial: the number of the plainly better stimulus.
    instructed : int or None
        The answer that the page asks for, on an attention check.
    """

    position: int
    kind: str = "main"
    part: str = ""
    segment: str
    stimuli: tuple[Stimulus, ...]
    expected: int | None = None
    instructed: int | None = None

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first."""
        return tuple(stimulus.condition for stimulus in self.stimuli)


@dataclass(frozen=True, kw_only=True)
class Sight:
    """What a page shows, and to whom.

    Attributes
    ----------
    rater : str
        Names the rater by its place, whoever holds it: a place's answers are the same in every
        rehearsal with the same seed. Whoever replaces somebody who was excluded, or who left, is
        another rater.
    trial : SeenTrial
        What is to be judged.
    trials : int
        How many there are in the whole study session.
    """

    rater: str
    trial: SeenTrial
    trials: int
