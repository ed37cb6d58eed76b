"""The words of a trial: its stimuli, its plan, what it asks for, and the arm it is planned for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, Protocol, Self, get_args

from motion.segment import Segment


@dataclass(frozen=True, kw_only=True)
class Stimulus:
    """One motion with the speech heard with it.

    Attributes
    ----------
    condition : str
        Whose motion.
    segment : str
        For which segment it was made.
    speech : str or None
        The segment that is heard: its own, another one, or None for silence.
    """

    condition: str
    segment: str
    speech: str | None

    @classmethod
    def own(cls, condition: str, segment: str) -> Self:
        """Return the motion of `condition` for `segment`, heard with its own speech."""
        return cls(condition=condition, segment=segment, speech=segment)


Content = tuple[Stimulus, ...]
"""What one video shows: one stimulus, or two side by side with one sound."""


Kind = Literal["practice", "main", "repeat", "catch", "attention"]

KINDS: Final[tuple[Kind, ...]] = get_args(Kind)


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
    def players(self) -> dict[int, Content]:
        """What each video shows, by its number; 0 shows the reference."""
        return dict(enumerate(self.shown, start=int(self.reference is None)))

    @property
    def stimuli(self) -> tuple[Stimulus, ...]:
        """What is judged, number 1 first."""
        return tuple(stimulus for video in self.videos for stimulus in video)

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first."""
        return tuple(stimulus.condition for stimulus in self.stimuli)


AnswerKey = tuple[str, int | None]
"""A question, and the number of the stimulus it is answered for: None for the whole trial."""

Answers = Mapping[AnswerKey, int]


@dataclass(frozen=True, kw_only=True)
class Ask:
    """One answer that a trial asks for.

    Attributes
    ----------
    question : str
        Name of the question.
    stimulus : int or None
        Number of the stimulus it is about, from 1; None where it is about the whole trial.
    values : sequence of int
        What may be answered.
    reasons : tuple of str
        Names of the reasons that may be ticked beside the answer.
    shares_reasons : bool
        Whether they are ticked once for all answers to the question, as beside an order.
    """

    question: str
    stimulus: int | None = None
    values: Sequence[int]
    reasons: tuple[str, ...] = ()
    shares_reasons: bool = False

    @property
    def key(self) -> AnswerKey:
        """What the answer is stored under."""
        return self.question, self.stimulus

    @property
    def field(self) -> str:
        """Name of the form's field; no question's name holds a colon."""
        return self.question if self.stimulus is None else f"{self.question}:{self.stimulus}"

    @property
    def reasons_field(self) -> str:
        """Name of the check boxes with reasons."""
        return f"{self.question if self.shares_reasons else self.field}:reasons"


class Trial(Protocol):
    """What must be known of a trial to judge its answers, planned or stored alike."""

    @property
    def kind(self) -> str:
        """Its kind."""

    @property
    def part(self) -> str:
        """The part of the study it belongs to."""

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first."""

    @property
    def expected(self) -> int | None:
        """Of a catch trial: the number of the plainly better stimulus."""

    @property
    def instructed(self) -> int | None:
        """Of an attention check: the value that the page asks to choose."""


Tally = Mapping[tuple[str, str], float]
"""How often the first condition was preferred to the second; a tie is half a win for both."""

NO_VOTES: Final[Tally] = MappingProxyType({})


@dataclass(frozen=True, kw_only=True)
class Arm:
    """One group of places.

    Attributes
    ----------
    name : str
        Names it in the database, the export and the report.
    conditions : tuple of str
        What its participants compare, the reference first.
    places : int
        How many participants it takes.
    """

    name: str
    conditions: tuple[str, ...]
    places: int
