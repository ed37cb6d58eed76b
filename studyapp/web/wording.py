"""Words on the pages that depend on the study."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from motion.listing import listed
from studyapp.definition.questions import Question
from studyapp.definition.study import Study
from studyapp.services.taking_part import ShownTrial

SCALE: Final = (
    (-2, "clearly A"),
    (-1, "slightly A"),
    (0, "no difference"),
    (1, "slightly B"),
    (2, "clearly B"),
)
"""The five answers in the order of the videos, from left to right."""

CHANNEL_WORDS: Final = {
    "face": "face",
    "hands": "fingers",
    "lower_body": "legs",
    "root": "whole-body movement through space",
}


@dataclass(frozen=True, kw_only=True)
class AskedQuestion:
    """A question as a trial asks it.

    Attributes
    ----------
    parts : tuple of (str, bool)
        The text in pieces; True marks the emotion, which the page emphasises.
    """

    name: str
    parts: tuple[tuple[str, bool], ...]


def asked(question: Question, emotion: str) -> AskedQuestion:
    """Return `question` with the emotion of the segment in its place."""
    pieces = question.text.split("{emotion}")
    parts: list[tuple[str, bool]] = [(pieces[0], False)]
    for piece in pieces[1:]:
        parts += [(emotion, True), (piece, False)]
    return AskedQuestion(name=question.name, parts=tuple(part for part in parts if part[0]))


def asked_questions(study: Study, trial: ShownTrial) -> list[AskedQuestion]:
    """Return the questions of `trial`; those of an attention check say what to answer."""
    names = {ask.question for ask in trial.asks}
    questions = [question for question in study.questions if question.name in names]
    if trial.instructed is None:
        return [asked(question, trial.emotion) for question in questions]
    return [
        AskedQuestion(
            name=question.name,
            parts=(
                ("To show that you read each question, please answer this one with ", False),
                (dict(SCALE)[trial.instructed], True),
                (".", False),
            ),
        )
        for question in questions
    ]


def frozen_words(study: Study) -> str:
    """Return what the videos hold still, as a list in words; empty where nothing is."""
    return listed([CHANNEL_WORDS[channel] for channel in study.freeze])
