"""Trials: their stimuli, plans and answers, and the arms they are planned for."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
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
        The segment it was made for.
    speech : str or None
        The segment that is heard: the same, another one, or None for silence.
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


def has_sound(contents: Iterable[Content]) -> bool:
    """Tell whether any of the videos has sound."""
    return any(shown.speech is not None for content in contents for shown in content)


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
        Practice is discarded; repeat shows a practice trial again and is analysed like main;
        catch has an obvious right answer, attention one that the page asks for.
    part : str
        The set, block or task it belongs to; empty in a study without parts.
    segment : Segment
        The speech it is about.
    videos : tuple of Content
        What is judged, in the order shown. Counted through all videos, the stimuli have the
        numbers 1, 2, … and the labels A, B, …
    reference : Stimulus or None
        Shown for comparison and not judged.
    expected : int or None
        Number of the obviously better stimulus of a catch trial.
    instructed : int or None
        The value that an attention check asks for.
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
        """What each video shows, by number; 0 is the reference."""
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
"""A question and the number of its stimulus: None for the whole trial."""

Answers = Mapping[AnswerKey, int]


@dataclass(frozen=True, kw_only=True)
class Ask:
    """One answer that a trial asks for.

    Attributes
    ----------
    question : str
        Name of the question.
    stimulus : int or None
        Number of the stimulus it is about, from 1; None for the whole trial.
    values : sequence of int
        The possible answers.
    reasons : tuple of str
        Names of the reasons that may be ticked.
    shares_reasons : bool
        Whether reasons are ticked once for all answers to the question, as in a ranking.
    """

    question: str
    stimulus: int | None = None
    values: Sequence[int]
    reasons: tuple[str, ...] = ()
    shares_reasons: bool = False

    @property
    def key(self) -> AnswerKey:
        """The key under which the answer is stored."""
        return self.question, self.stimulus

    @property
    def field(self) -> str:
        """Name of the form field; names of questions contain no colon."""
        return self.question if self.stimulus is None else f"{self.question}:{self.stimulus}"

    @property
    def reasons_field(self) -> str:
        """Name of the check boxes with reasons."""
        return f"{self.question if self.shares_reasons else self.field}:reasons"


class Trial(Protocol):
    """What judges need to know of a trial, planned or stored."""

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
        """Number of the obviously better stimulus of a catch trial."""

    @property
    def instructed(self) -> int | None:
        """The value that an attention check asks for."""


Tally = Mapping[tuple[str, str], float]
"""How often the first condition was preferred to the second; a tie counts half for both."""

NO_VOTES: Final[Tally] = {}


@dataclass(frozen=True, kw_only=True)
class Arm:
    """One group of places.

    Attributes
    ----------
    name : str
        Its name in the database, the export and the report.
    conditions : tuple of str
        The conditions that its participants compare, the reference first.
    places : int
        Number of participants.
    """

    name: str
    conditions: tuple[str, ...]
    places: int
