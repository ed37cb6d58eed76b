"""What a report is about, beside its answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from markupsafe import Markup

from analysis.measurement.scores import StudyMetrics
from analysis.results.known_values import KnownValue
from analysis.results.preferred_pairs import PreferredPair

Origin = Literal["participants", "rehearsal", "table", "none"]


@dataclass(frozen=True, kw_only=True)
class Excerpt:
    """What is known of one segment of speech; empty where it is not known."""

    emotion: str = ""
    speaker: str = ""
    transcript: str = ""
    seconds: float | None = None


@dataclass(frozen=True, kw_only=True)
class Still:
    """One frame of what participants saw.

    Attributes
    ----------
    condition, segment : str
        Whose frame it is.
    seconds : float
        When, from the beginning of the video.
    word : str
        What is said there; empty where that is not known.
    image : str
        The picture as a ``data:`` address.
    """

    condition: str
    segment: str
    seconds: float
    word: str
    image: str


@dataclass(frozen=True, kw_only=True, eq=False)
class PlayableMotion:
    """Pairs of clips that can be played on the page, and what the page needs for it.

    Attributes
    ----------
    pairs : tuple of (PreferredPair, Markup)
        In the order of the page, with the element in which each plays.
    sources : str or Markup
        The elements that hold motion and speech; '' where there are none.
    scripts : tuple of str
        The scripts that play them, in this order.
    style : str
        Their style.
    left_out : tuple of str
        Sentences about pairs that cannot be played.
    """

    pairs: tuple[tuple[PreferredPair, Markup], ...] = ()
    sources: str = ""
    scripts: tuple[str, ...] = ()
    style: str = ""
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Subject:
    """What a report is about, beside its answers.

    Attributes
    ----------
    title : str
        The study's title, or the table's file.
    origin : {'participants', 'rehearsal', 'table', 'none'}
        Who answered: people, simulated raters, whoever filled a table, or nobody yet.
    protocol : str
        'pairwise', 'rating', 'ranking' or 'mismatch'.
    conditions : tuple of str
        What is compared, in the order of tables and figures.
    labels : mapping of str to str
        What a condition, or the comparison of two, is called where that is not its name.
    questions : mapping of str to str
        Name of each question to its text; '' where it is not known.
    reference : str or None
        Of a pairwise study: what all others are compared with.
    recorded : str or None
        The condition that is real recorded motion.
    broken : str or None
        The visibly broken motion of catch trials.
    generative : mapping of str to bool
        Whether a condition can move differently to one speech, where that is stated.
    scale_labels : mapping of str to tuple of str
        By question, what the points of its scale are called, worst first; () where unknown.
    excerpts : mapping of str to Excerpt
        By segment.
    notes : tuple of str
        What else a reader must know.
    frozen : tuple of str
        Channels that the videos hold still.
    study_sha256 : str
        Of the study's definition; '' for a table.
    seed : int or None
        Of the study's draws.
    truth : tuple of KnownValue
        Of a rehearsal: what its raters were given; () otherwise.
    metrics : StudyMetrics or None
        Automatic metrics of the conditions, where there are motions.
    stills : tuple of Still
        Frames of the conditions at chosen moments, by condition and then moment.
    no_stills : str
        Why there are none, in words that make a sentence; '' where there are some.
    motion : PlayableMotion or None
        The pairs that were preferred most and least; None where the page does not play any.
    """

    title: str
    origin: Origin
    protocol: str
    conditions: tuple[str, ...]
    questions: Mapping[str, str]
    labels: Mapping[str, str] = field(default_factory=dict)
    reference: str | None = None
    recorded: str | None = None
    broken: str | None = None
    generative: Mapping[str, bool] = field(default_factory=dict)
    scale_labels: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    excerpts: Mapping[str, Excerpt] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    frozen: tuple[str, ...] = ()
    study_sha256: str = ""
    seed: int | None = None
    truth: tuple[KnownValue, ...] = ()
    metrics: StudyMetrics | None = None
    stills: tuple[Still, ...] = ()
    no_stills: str = ""
    motion: PlayableMotion | None = None

    @property
    def people(self) -> str:
        """What to call those who answered."""
        return "simulated raters" if self.origin == "rehearsal" else "participants"

    @property
    def speakers(self) -> tuple[str, ...]:
        """Who speaks, as far as that is known."""
        return tuple(sorted({one.speaker for one in self.excerpts.values() if one.speaker}))

    @property
    def mark(self) -> str:
        """What must be said on every screen, every printed page and every figure; or ''."""
        return _MARKS[self.origin][0]

    @property
    def mark_short(self) -> str:
        """The same in a word or two, for headings and captions."""
        return _MARKS[self.origin][1]


_MARKS: Mapping[Origin, tuple[str, str]] = MappingProxyType(
    {
        "participants": ("", ""),
        "table": ("", ""),
        "rehearsal": ("Rehearsal: simulated raters, no person answered", "rehearsal"),
        "none": ("No participants yet: metrics only", "no participants yet"),
    }
)
