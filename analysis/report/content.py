"""A report's subject, and the parts of its page: sections with text, figures and tables."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

from markupsafe import Markup

from analysis.results.heterogeneity import PreferredPair

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from analysis.metrics.scores import StudyMetrics
    from analysis.results.known_values import KnownValue
    from analysis.stats.clustered_mean import Estimate
    from motion.segment import Segment


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One table cell.

    Attributes
    ----------
    text : str
        The text that the page shows.
    value : float or None
        The number behind the text, by which rows are sorted and which files hold; None for words.
    best, second : bool
        Whether it is the best of its kind, shown bold, or the second best, underlined.
    """

    text: str
    value: float | None = None
    best: bool = False
    second: bool = False


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table with a caption that stands alone.

    Attributes
    ----------
    caption : str
        What the table shows.
    header : tuple of str
        Column headings; the first column heads the rows.
    rows : tuple of tuple of Cell
        As many cells per row as there are headings.
    groups : tuple of (str, int)
        Headings over several columns, with how many they span; empty for none.
    text_columns : int
        Number of columns, from the left, that hold text; the others hold numbers.
    notes : tuple of str
        Footnotes.
    name : str
        The table is also written as ``tables/<name>.tex`` and, unless `data` names another file,
        as ``tables/<name>.csv``; empty for the page alone.
    data : str
        File in the report's ``tables`` folder with the full data; empty for none.
    secondary : str
        A short title under which the page folds the table away; empty if it is shown.
    """

    caption: str
    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    groups: tuple[tuple[str, int], ...] = ()
    text_columns: int = 1
    notes: tuple[str, ...] = ()
    name: str = ""
    data: str = ""
    secondary: str = ""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A figure with a caption that stands alone.

    Attributes
    ----------
    svg : Markup
        The element that shows it on the page, with a text alternative.
    caption : str
        The text under the figure.
    data : str
        File in the report's ``tables`` folder with its numbers; empty for none.
    name : str
        Its files in the report's ``figures`` folder, without the extension; empty for none.
    figure : Figure or None
        The figure in these files.
    """

    svg: Markup
    caption: str
    data: str = ""
    name: str = ""
    figure: Figure | None = field(default=None, compare=False)


@dataclass(frozen=True, kw_only=True)
class FigureText:
    """The text around a figure.

    Attributes
    ----------
    name : str
        Name of its file, and prefix of its ids: letters, digits and '-'.
    title, caption : str
        A few words, and the text under the figure.
    data : str
        File in the report's ``tables`` folder with its numbers; empty for none.
    """

    name: str
    title: str
    caption: str
    data: str = ""


PlayablePair = tuple[Markup, str, Table | None]
"""Two motions that play side by side: their element, a caption, and their metrics if any."""


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading and its content, in order: paragraphs, figures, motions, tables."""

    anchor: str
    heading: str
    paragraphs: tuple[str, ...] = ()
    bullets: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = ()
    playable: tuple[PlayablePair, ...] = ()
    tables: tuple[Table, ...] = ()


def number_cell(value: float, text: str, *, best: bool = False, second: bool = False) -> Cell:
    """Return a cell that shows `text` and has the value `value`, none for NaN."""
    return Cell(
        text=text, value=None if math.isnan(value) else float(value), best=best, second=second
    )


def headline_section(
    set_name: str | None,
    suffix: str,
    heading: str,
    *,
    no_figure: str,
    pictures: Callable[[], tuple[Picture, ...]],
    tables: Iterable[Table],
    paragraph: str = "",
) -> Section:
    """Return the main results of a set.

    Parameters
    ----------
    set_name : str or None
        The set, named before the heading and in captions; None without sets.
    suffix : str
        End of the names of the set's tables; see `analysis.report.wording.set_suffix`.
    heading : str
        The section's heading.
    no_figure : str
        Why no figure is drawn, which replaces figures and paragraph; '' if there are figures.
    pictures : callable
        Draws the figures.
    tables : iterable of Table
        The tables.
    paragraph : str, optional
        Text before the figures.
    """
    if set_name is not None:
        heading = f"Set {set_name}: {heading[:1].lower()}{heading[1:]}"
    prefix = "" if set_name is None else f"Set {set_name}. "
    text = no_figure or paragraph
    return Section(
        anchor=f"headline{suffix}",
        heading=heading,
        paragraphs=(text,) if text else (),
        pictures=()
        if no_figure
        else tuple(replace(item, caption=f"{prefix}{item.caption}") for item in pictures()),
        tables=tuple(
            replace(table, name=f"{table.name}{suffix}", caption=f"{prefix}{table.caption}")
            for table in tables
        ),
    )


Origin = Literal["participants", "rehearsal", "table", "none"]


@dataclass(frozen=True, kw_only=True)
class Still:
    """One video frame.

    Attributes
    ----------
    condition, segment : str
        The video.
    seconds : float
        Time from the start of the video.
    image : str
        The picture as a ``data:`` address.
    """

    condition: str
    segment: str
    seconds: float
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
    """The subject of a report: everything it needs besides the results.

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
        The condition with which all others are compared, in a pairwise study.
    recorded : str or None
        The condition that is recorded motion.
    broken : str or None
        The visibly broken motion of catch trials.
    generative : mapping of str to bool
        Whether a condition can move differently to the same speech, if stated.
    scale_labels : mapping of str to tuple of str
        By question, the labels of its scale, worst first.
    excerpts : mapping of str to Segment
        By name.
    notes : tuple of str
        Further remarks for the reader.
    frozen : tuple of str
        Channels that the videos keep still.
    study_sha256 : str
        Hash of the study's definition; '' for a table.
    seed : int or None
        The study's seed.
    truth : tuple of (KnownValue, Estimate)
        The true values of a rehearsal's raters, with their estimates.
    metrics : StudyMetrics or None
        Automatic metrics of the conditions; None without motion files.
    stills : tuple of Still
        Frames by condition and then time.
    no_stills : str
        A sentence on why there are no stills; '' if there are some.
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
    excerpts: Mapping[str, Segment] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    frozen: tuple[str, ...] = ()
    study_sha256: str = ""
    seed: int | None = None
    truth: tuple[tuple[KnownValue, Estimate], ...] = ()
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
        return MARKS[self.origin][0]

    @property
    def mark_short(self) -> str:
        """The same in a word or two, for headings and captions."""
        return MARKS[self.origin][1]


MARKS: Mapping[Origin, tuple[str, str]] = {
    "participants": ("", ""),
    "table": ("", ""),
    "rehearsal": ("Rehearsal: simulated raters, no person answered", "rehearsal"),
    "none": ("No participants yet: metrics only", "no participants yet"),
}
"""The marks of a page in full and in a word or two, by who answered."""
