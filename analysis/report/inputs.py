"""What a report is made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import pandas as pd

from analysis.metrics.segment_scores import Excerpt
from motion.errors import InputError
from motion.segment import Segment

Origin = Literal["participants", "rehearsal", "none"]


@dataclass(frozen=True, kw_only=True)
class KnownShare:
    """The win share that simulated raters were given, towards the reference, in [0, 1].

    Attributes
    ----------
    share : float
        Over all raters and all segments such as these: what the interval is an interval for.
    on_these_segments : float
        Over all raters, for the study's own segments, whose luck the estimate shares.
    """

    share: float
    on_these_segments: float


@dataclass(frozen=True, kw_only=True, eq=False)
class ReportInputs:
    """Everything that the report of one pairwise study needs.

    Attributes
    ----------
    title : str
        The study's title.
    origin : {'participants', 'rehearsal', 'none'}
        Who answered: people, simulated raters, or nobody yet.
    reference : str
        The condition that every other one is compared with.
    catch_reference, catch_condition : str
        What catch trials show: the side that is right, and the visibly broken one.
    conditions : tuple of str
        All compared conditions, in the order in which tables show them.
    questions : mapping of str to str
        Name of each question to its text, in the study's order.
    max_failed_catch : int
        More failed catch trials than this exclude a study session.
    max_failed_attention : int or None
        More failed attention checks than this exclude a study session; None without any.
    responses : DataFrame
        Tidy responses (`analysis.responses`); without rows where origin is 'none'.
    clips : mapping of condition to mapping of segment to path
        Motion files; empty where a study consists of finished videos.
    speech : mapping of segment to (recording, start, end)
        What each segment says.
    segments : tuple of Segment
        The study's segments.
    truth : mapping of (comparison, question) to KnownShare, or None
        Of a rehearsal: the win share that the simulated raters were given.
    notes : tuple of str
        What else a reader must know about this study.
    frozen : tuple of str
        Channels that the videos hold still; metrics then look at what participants saw.
    presentations : int or None
        Trials of a whole study session, of all kinds; None to take the longest one there is.
    study_sessions : mapping of str to int, or None
        Study sessions opened per comparison, those without any answer included.
    completed : frozenset of str
        Study sessions known to have reached their end; they count as complete even if a video
        that would not play left a question without an answer.
    """

    title: str
    origin: Origin
    reference: str
    catch_reference: str
    catch_condition: str
    conditions: tuple[str, ...]
    questions: Mapping[str, str]
    max_failed_catch: int
    responses: pd.DataFrame
    clips: Mapping[str, Mapping[str, Path]] = field(default_factory=dict)
    speech: Mapping[str, Excerpt] = field(default_factory=dict)
    segments: tuple[Segment, ...] = ()
    truth: Mapping[tuple[str, str], KnownShare] | None = None
    notes: tuple[str, ...] = ()
    frozen: tuple[str, ...] = ()
    presentations: int | None = None
    study_sessions: Mapping[str, int] | None = None
    completed: frozenset[str] = frozenset()
    max_failed_attention: int | None = None

    def __post_init__(self) -> None:
        if (self.origin == "none") != self.responses.empty:
            raise InputError(
                f"a report with origin {self.origin!r} has {len(self.responses)} answers",
                remedy="Give origin 'none' exactly where nobody has answered",
            )
        unknown = sorted(set(self.responses["question"]) - set(self.questions))
        if unknown:
            raise InputError(
                f"the responses hold question {unknown[0]!r}, which the study does not ask",
                remedy=f"Use the responses of this study; it asks {', '.join(self.questions)}",
            )
