"""Words on the pages that depend on the study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from motion.listing import listed
from studyapp.definition.protocols.ranking import RankingStudy
from studyapp.definition.questions import Question
from studyapp.definition.scales import BAND, STEPS, RatingQuestion
from studyapp.definition.study import Study
from studyapp.design.asking import Ask
from studyapp.services.taking_part import ShownTrial

Labels = tuple[tuple[int, str], ...]
"""Values, each with the words that stand for it on the page."""

Widget = Literal["choices", "slider", "ranking"]
"""How a question is answered: one of a few labels, a number on a line, or an order."""

SCALE: Final[Labels] = (
    (-2, "clearly A"),
    (-1, "slightly A"),
    (0, "no difference"),
    (1, "slightly B"),
    (2, "clearly B"),
)
"""The five answers in the order of the videos, from left to right."""

PREFERENCE_LABELS: Final[Mapping[int, Labels]] = MappingProxyType(
    {2: ((-1, "A"), (1, "B")), 3: ((-1, "A"), (0, "no difference"), (1, "B")), 5: SCALE}
)
"""By how many answers there are, in the order of the videos."""

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
    number : int
        Its number on the page, the same for every video it is asked about.
    stimulus : int or None
        The one that it is about; None where it is about the whole trial.
    parts : tuple of (str, bool)
        The text in pieces; True marks the emotion, which the page emphasises.
    widget : {'choices', 'slider', 'ranking'}
        How it is answered.
    asks : tuple of Ask
        Its answers: one, or in a ranking one for each stimulus.
    labels : tuple of (int, str)
        The choices, or the upper ends of a slider's bands, with their words.
    reasons : tuple of (str, str)
        Names and words of what may be ticked beside the answer.
    """

    name: str
    number: int
    stimulus: int | None
    parts: tuple[tuple[str, bool], ...]
    widget: Widget
    asks: tuple[Ask, ...]
    labels: Labels
    reasons: tuple[tuple[str, str], ...]

    @property
    def needed(self) -> str:
        """What a checklist calls it."""
        return str(self.number) if self.stimulus is None else f"{self.number} for {self.letter}"

    @property
    def letter(self) -> str:
        """The label of the stimulus it is about; empty where it is about the whole trial."""
        return "" if self.stimulus is None else letter(self.stimulus)


def letter(number: int) -> str:
    """Return the label of stimulus `number`: A for 1."""
    return chr(ord("A") + number - 1)


def emphasised(text: str, emotion: str) -> tuple[tuple[str, bool], ...]:
    """Return `text` in pieces, with the emotion of the segment in its place."""
    pieces = text.split("{emotion}")
    parts: list[tuple[str, bool]] = [(pieces[0], False)]
    for piece in pieces[1:]:
        parts += [(emotion, True), (piece, False)]
    return tuple(part for part in parts if part[0])


def asked_questions(study: Study, trial: ShownTrial) -> list[AskedQuestion]:
    """Return the questions of `trial`; those of an attention check say what to answer."""
    by_name = {question.name: question for question in study.questions}
    numbers = {name: n for n, name in enumerate(dict.fromkeys(a.question for a in trial.asks), 1)}
    asked: dict[tuple[str, int | None], list[Ask]] = {}
    ranking = isinstance(study, RankingStudy)
    for ask in trial.asks:
        asked.setdefault((ask.question, None if ranking else ask.stimulus), []).append(ask)
    return [
        _asked(by_name[name], trial, stimulus, tuple(asks), numbers[name], ranking=ranking)
        for (name, stimulus), asks in asked.items()
    ]


def _asked(
    question: Question,
    trial: ShownTrial,
    stimulus: int | None,
    asks: tuple[Ask, ...],
    number: int,
    *,
    ranking: bool,
) -> AskedQuestion:
    widget: Widget = "ranking" if ranking else "choices"
    labels = () if ranking else _labels(question, asks[0].values)
    if isinstance(question, RatingQuestion) and question.scale == "slider":
        widget = "slider"
    if trial.instructed is None:
        parts = emphasised(question.text, trial.emotion)
    else:
        parts = _instruction(widget, labels, trial.instructed)
    return AskedQuestion(
        name=question.name,
        number=number,
        stimulus=stimulus,
        parts=parts,
        widget=widget,
        asks=asks,
        labels=labels,
        reasons=tuple((reason.name, reason.text) for reason in question.reasons),
    )


def _labels(question: Question, values: Sequence[int]) -> Labels:
    if not isinstance(question, RatingQuestion):
        return PREFERENCE_LABELS[len(values)]
    if question.scale == "slider":
        return tuple(zip(range(BAND, STEPS * BAND + 1, BAND), question.labels, strict=True))
    return tuple(zip(values, question.labels, strict=True))


def _instruction(widget: Widget, labels: Labels, instructed: int) -> tuple[tuple[str, bool], ...]:
    """Return what an attention check asks for in place of its question."""
    reason = "To show that you read each question, please "
    if widget == "ranking":
        return ((f"{reason}put ", False), (letter(instructed), True), (" first here.", False))
    if widget == "slider":
        _, label = labels[instructed - 1]
        return (
            (f"{reason}move this slider into the part ", False),
            (label, True),
            (".", False),
        )
    return (
        (f"{reason}answer this one with ", False),
        (dict(labels)[instructed], True),
        (".", False),
    )


def frozen_words(study: Study) -> str:
    """Return what the videos hold still, as a list in words; empty where nothing is."""
    return listed([CHANNEL_WORDS[channel] for channel in study.freeze])
