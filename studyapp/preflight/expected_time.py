"""How long a study takes: from its videos, its questions and its texts, and from who took it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Final

from studyapp.preflight.material import Material
from studyapp.session.time_left import expected_seconds
from studyapp.study.design.planned_trial import PlannedTrial
from studyapp.study.design.stimulus import Content
from studyapp.study.settings.study import Study

SECONDS_FOR_A_FORM_QUESTION: Final = 8.0
SECONDS_FOR_INSTRUCTIONS: Final = 60.0
SECONDS_FOR_THE_SOUND_CHECK: Final = 25.0
WORDS_A_MINUTE: Final = 200
"""Careful silent reading: adults read 238 words a minute of English (Brysbaert 2019)."""

CHARACTERS_A_WORD: Final = 2.5
"""Of languages that write no spaces."""

PLACES: Final = 24
"""Places of each arm whose time is reckoned."""


@dataclass(frozen=True, kw_only=True)
class ExpectedTime:
    """What a participant needs.

    Attributes
    ----------
    videos : float
        Seconds of watching each video once.
    around : float
        Seconds of reading and answering.
    longest_page : float
        Seconds of the longest trial.
    """

    videos: float
    around: float
    longest_page: float

    @property
    def seconds(self) -> float:
        """All of it."""
        return self.videos + self.around


def expected_time(material: Material) -> ExpectedTime | None:
    """Return what the middle participant needs; None where there is no trial."""
    study = material.study
    known = [
        time
        for _, plans in material.planned
        for plan in plans[:PLACES]
        if (time := _of_plan(plan, material)) is not None
    ]
    if not known:
        return None
    return ExpectedTime(
        videos=median(time.videos for time in known),
        around=median(time.around for time in known) + _entrance_seconds(study, material),
        longest_page=max(time.longest_page for time in known),
    )


def _of_plan(plan: Sequence[PlannedTrial], material: Material) -> ExpectedTime | None:
    if not plan:
        return None
    videos = [[_lasts(content, material) for content in trial.shown] for trial in plan]
    pages = [
        expected_seconds(durations, len(material.study.asks(trial)))
        for trial, durations in zip(plan, videos, strict=True)
    ]
    watched = sum(map(sum, videos))
    return ExpectedTime(videos=watched, around=sum(pages) - watched, longest_page=max(pages))


def _entrance_seconds(study: Study, material: Material) -> float:
    questions = sum(len(study.form.asked(stage)) for stage in study.form.stages())
    heard = any(shown.speech is not None for content in material.contents for shown in content)
    return (
        SECONDS_FOR_INSTRUCTIONS
        + SECONDS_FOR_A_FORM_QUESTION * questions
        + 60 * words(study.page.consent) / WORDS_A_MINUTE
        + (SECONDS_FOR_THE_SOUND_CHECK if study.page.sound_check and heard else 0.0)
    )


def words(text: str) -> float:
    """Return how many words a text has; without spaces, as many as it would have."""
    unspaced = len(re.findall(r"[\u3040-\u30ff\u4e00-\u9fff]", text))
    spaced = len(re.sub(r"[\u3040-\u30ff\u4e00-\u9fff]", " ", text).split())
    return spaced + unspaced / CHARACTERS_A_WORD


def _lasts(content: Content, material: Material) -> float:
    """Return how long a video lasts, or will last once it is rendered."""
    video = material.shown.get(content)
    return video.duration if video else material.by_name[content[0].segment].duration
