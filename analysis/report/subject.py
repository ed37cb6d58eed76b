"""What a report is about: everything it needs besides the results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from markupsafe import Markup

from analysis.metrics.scores import StudyMetrics
from analysis.results.known_values import KnownValue
from analysis.results.preferred_pairs import PreferredPair

Origin = Literal["participants", "rehearsal", "table", "none"]


@dataclass(frozen=True, kw_only=True)
class Excerpt:
    """One segment of speech; unknown fields are empty."""

    emotion: str = ""
    speaker: str = ""
    transcript: str = ""
    seconds: float | None = None


@dataclass(frozen=True, kw_only=True)
class Still:
    """One video frame.

    Attributes
    ----------
    condition, segment : str
        The video.
    seconds : float
        Time from the start of the video.
    word : str
        The word spoken at that time; empty if unknown.
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
    """Pairs of clips that play on the page.

    Attributes
    ----------
    pairs : tuple of (PreferredPair, Markup)
        In the order of the page, each with the element in which it plays.
    sources : str or Markup
        The elements that hold motion and speech; '' for none.
    scripts : tuple of str
        The scripts that play them, in order.
    style : str
        CSS.
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
    """What a report is about: everything it needs besides the results.

    Attributes
    ----------
    title : str
        The study's title, or the table's file.
    origin : {'participants', 'rehearsal', 'table', 'none'}
        Who answered: people, simulated raters, the participants of a table, or nobody yet.
    protocol : str
        'pairwise', 'rating', 'ranking' or 'mismatch'.
    conditions : tuple of str
        In the order of tables and figures.
    labels : mapping of str to str
        Display names of conditions and comparisons that have one.
    questions : mapping of str to str
        The text of each question by its name; '' if unknown.
    reference : str or None
        Of a pairwise study: the condition with which all others are compared.
    recorded : str or None
        The condition that is recorded motion.
    broken : str or None
        The visibly broken motion of catch trials.
    generative : mapping of str to bool
        Whether a condition can move differently to the same speech, if stated.
    scale_labels : mapping of str to tuple of str
        By question, the labels of its scale, worst first.
    excerpts : mapping of str to Excerpt
        By segment.
    notes : tuple of str
        Further remarks for the reader.
    frozen : tuple of str
        Channels that the videos keep still.
    study_sha256 : str
        Of the study's definition; '' for a table.
    seed : int or None
        Of the study.
    truth : tuple of KnownValue
        Of a rehearsal: the true values of its raters.
    metrics : StudyMetrics or None
        Automatic metrics of the conditions; None without motion files.
    stills : tuple of Still
        Frames by condition and then time.
    no_stills : str
        A sentence that says why there are none; '' if there are some.
    motion : PlayableMotion or None
        The most and least preferred pairs; None if the page plays none.
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
        """A word for those who answered."""
        return "simulated raters" if self.origin == "rehearsal" else "participants"

    @property
    def speakers(self) -> tuple[str, ...]:
        """The known speakers."""
        return tuple(sorted({e.speaker for e in self.excerpts.values() if e.speaker}))

    @property
    def mark(self) -> str:
        """A warning for every screen, printed page and figure; '' for real answers."""
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
