"""One trial as it is planned, before anybody has seen it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from motion.segment import Segment
from studyapp.study.design.stimulus import Content, Stimulus

Kind = Literal["practice", "main", "repeat", "catch", "attention"]

KINDS: Final[tuple[Kind, ...]] = ("practice", "main", "repeat", "catch", "attention")


@dataclass(frozen=True, kw_only=True)
class PlannedTrial:
    """One presentation of one or more stimuli.

    Attributes
    ----------
    position : int
        Place within the study session, from 1.
    kind : {'practice', 'main', 'repeat', 'catch', 'attention'}
        Practice is discarded, repeat is a practice trial shown again and analysed like main,
        catch has a right answer that is seen at once, attention one that the page asks for.
    part : str
        The part of the study it belongs to: a set, a block or a task; empty where there are none.
    segment : Segment
        The speech it is about.
    videos : tuple of Content
        What is judged, video by video, in the order shown. Counted through all videos, the
        stimuli have the numbers 1, 2, … and the labels A, B, …
    reference : Stimulus or None
        What is shown apart as a yardstick and not judged.
    expected : int or None
        Of a catch trial: the number of the stimulus that is plainly better.
    instructed : int or None
        Of an attention check: the value that the page asks to choose.
    repeats : int or None
        Position of the practice trial that a repeat shows again.
    """

    position: int
    kind: Kind
    part: str = ""
    segment: Segment
    videos: tuple[Content, ...]
    reference: Stimulus | None = None
    expected: int | None = None
    instructed: int | None = None
    repeats: int | None = None

    @property
    def shown(self) -> tuple[Content, ...]:
        """All its videos, the reference's first."""
        return self.videos if self.reference is None else ((self.reference,), *self.videos)

    @property
    def stimuli(self) -> tuple[Stimulus, ...]:
        """What is judged, number 1 first."""
        return tuple(stimulus for video in self.videos for stimulus in video)

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first."""
        return tuple(stimulus.condition for stimulus in self.stimuli)
