"""What the page of a trial shows: layout, players and questions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from studyapp.session.trials import ShownTrial, ShownVideo
from studyapp.study.design.trial import Ask
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.settings.presentation import Message
from studyapp.study.settings.questions import BAND_WIDTH, SCALE_STEPS, Question, RatingQuestion
from studyapp.study.settings.study import Study
from studyapp.web.language import _, page_language, say

Labels = tuple[tuple[int, str], ...]
"""Values, each with its words on the page."""

Widget = Literal["choices", "slider", "ranking"]
"""How a question is answered: one of a few labels, a number on a line, or an order."""

NO_DIFFERENCE: Final = Message("no difference")
SCALE: Final = (
    (-2, Message("clearly A")),
    (-1, Message("slightly A")),
    (0, NO_DIFFERENCE),
    (1, Message("slightly B")),
    (2, Message("clearly B")),
)
"""The five answers in the order of the videos, from left to right."""

PREFERENCE_LABELS: Final[Mapping[int, tuple[tuple[int, Message], ...]]] = {
    2: ((-1, Message("A")), (1, Message("B"))),
    3: ((-1, Message("A")), (0, NO_DIFFERENCE), (1, Message("B"))),
    5: SCALE,
}
"""By the number of answers, in the order of the videos."""

CATEGORY_LABELS: Final = (
    Message("bad"),
    Message("poor"),
    Message("fair"),
    Message("good"),
    Message("excellent"),
)
"""The words of `studyapp.study.settings.questions.QUALITY_CATEGORIES`."""

CHANNEL_WORDS: Final = {
    "face": Message("the face"),
    "hands": Message("the fingers"),
    "lower_body": Message("the legs"),
    "root": Message("whole-body movement through space"),
}

EMOTION_WORDS: Final = {
    "neutral": Message("neutral"),
    "happiness": Message("happiness"),
    "anger": Message("anger"),
    "sadness": Message("sadness"),
    "contempt": Message("contempt"),
    "surprise": Message("surprise"),
    "fear": Message("fear"),
    "disgust": Message("disgust"),
}


@dataclass(frozen=True, kw_only=True)
class AskedQuestion:
    """A question as a trial asks it.

    Attributes
    ----------
    number : int
        Its number on the page, the same for every video that it asks about.
    stimulus : int or None
        The stimulus that it asks about; None for the whole trial.
    parts : tuple of (str, bool)
        The text in pieces; True marks the emotion, which the page emphasises.
    widget : {'choices', 'slider', 'ranking'}
        How it is answered.
    asks : tuple of Ask
        Its answers: one, or in a ranking one for each stimulus.
    labels : tuple of (int, str)
        The choices, the upper ends of a slider's bands, or the ranks, with their words.
    reasons : tuple of (str, str)
        Names and words of the reasons that may be ticked beside the answer.
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
        """Its name in the checklist."""
        if self.stimulus is None:
            return str(self.number)
        return _("%(number)s for %(letter)s", number=self.number, letter=self.letter)

    @property
    def letter(self) -> str:
        """The label of its stimulus; empty for the whole trial."""
        return "" if self.stimulus is None else letter(self.stimulus)


def letter(number: int) -> str:
    """Return the label of stimulus `number`: A for 1."""
    return chr(ord("A") + number - 1)


def emphasised(text: str, place: str, words: str) -> tuple[tuple[str, bool], ...]:
    """Return `text` in pieces, with emphasised `words` wherever it holds `place`."""
    pieces = text.split(place)
    parts: list[tuple[str, bool]] = [(pieces[0], False)]
    for piece in pieces[1:]:
        parts += [(words, True), (piece, False)]
    return tuple(part for part in parts if part[0])


def asked_questions(study: Study, trial: ShownTrial) -> list[AskedQuestion]:
    """Return the questions of `trial`; in an attention check they say what to answer."""
    by_name = {question.name: question for question in study.questions}
    numbers = {name: n for n, name in enumerate(dict.fromkeys(a.question for a in trial.asks), 1)}
    asks_by_question: dict[tuple[str, int | None], list[Ask]] = {}
    ranking = isinstance(study, RankingStudy)
    for ask in trial.asks:
        key = (ask.question, None if ranking else ask.stimulus)
        asks_by_question.setdefault(key, []).append(ask)
    return [
        _asked(by_name[name], trial, tuple(asks), numbers[name], ranking=ranking, first=n == 0)
        for n, ((name, _stimulus), asks) in enumerate(asks_by_question.items())
    ]


def _asked(
    question: Question,
    trial: ShownTrial,
    asks: tuple[Ask, ...],
    number: int,
    *,
    ranking: bool,
    first: bool,
) -> AskedQuestion:
    widget: Widget = "ranking" if ranking else "choices"
    labels = ranks(asks[0].values) if ranking else _labels(question, asks[0].values)
    if isinstance(question, RatingQuestion) and question.scale == "slider":
        widget = "slider"
    if trial.instructed is None:
        parts = emphasised(question.text, "{emotion}", say(EMOTION_WORDS[trial.emotion]))
    else:
        parts = _instruction(widget, labels, trial.instructed, first=first)
    return AskedQuestion(
        name=question.name,
        number=number,
        stimulus=None if ranking else asks[0].stimulus,
        parts=parts,
        widget=widget,
        asks=asks,
        labels=labels,
        reasons=tuple((reason.name, reason.text) for reason in question.reasons),
    )


def ranks(values: Sequence[int]) -> Labels:
    """Return the ranks `values` with their words, 1st for 1."""
    words = {1: _("1st"), 2: _("2nd"), 3: _("3rd")}
    return tuple((rank, words.get(rank) or _("%(rank)sth", rank=rank)) for rank in values)


def _labels(question: Question, values: Sequence[int]) -> Labels:
    if not isinstance(question, RatingQuestion):
        return tuple((value, say(label)) for value, label in PREFERENCE_LABELS[len(values)])
    has_own_labels = "labels" in question.model_fields_set
    labels = question.labels if has_own_labels else tuple(say(label) for label in CATEGORY_LABELS)
    if question.scale == "slider":
        values = range(BAND_WIDTH, SCALE_STEPS * BAND_WIDTH + 1, BAND_WIDTH)
    return tuple(zip(values, labels, strict=True))


def _instruction(
    widget: Widget, labels: Labels, instructed: int, *, first: bool
) -> tuple[tuple[str, bool], ...]:
    """Return the instruction of an attention check; only the first one explains why."""
    if widget == "ranking":
        why = _("To show that you read each question, please put {answer} first here.")
        text, answer = why if first else _("And {answer} first here."), letter(instructed)
    elif widget == "slider":
        why = _("To show that you read each question, please move this slider to {answer}.")
        text = why if first else _("And this slider to {answer}.")
        answer = labels[instructed - 1][1]
    else:
        why = _("To show that you read each question, please answer this one with {answer}.")
        text = why if first else _("And this one with {answer}.")
        answer = dict(labels)[instructed]
    return emphasised(text, "{answer}", answer)


def frozen_words(study: Study) -> str:
    """Return the frozen channels as a list in words; empty if there are none."""
    return page_language().listed([say(CHANNEL_WORDS[channel]) for channel in study.freeze])


Layout = Literal["composed", "pair", "rating", "ranking"]
"""One video with both sides; two players; players with questions under each; cards to order."""


@dataclass(frozen=True, kw_only=True)
class Player:
    """One video of the page with its label.

    Attributes
    ----------
    label : str
        A, B, … or Reference; empty for a composed pair, whose picture holds its labels.
    questions : tuple of AskedQuestion
        Those about this video alone.
    """

    label: str
    video: ShownVideo
    questions: tuple[AskedQuestion, ...]


@dataclass(frozen=True, kw_only=True)
class TrialPage:
    """A trial as its page shows it.

    Attributes
    ----------
    reference : Player or None
        What is shown apart and not judged.
    players : tuple of Player
        What is judged, in order.
    questions : tuple of AskedQuestion
        Those about the whole trial.
    widgets : frozenset of {'choices', 'slider', 'ranking'}
        How all its questions are answered.
    """

    layout: Layout
    reference: Player | None
    players: tuple[Player, ...]
    questions: tuple[AskedQuestion, ...]
    widgets: frozenset[Widget]

    @property
    def boxes(self) -> int:
        """How many videos stand beside each other."""
        return len(self.players) + (self.reference is not None)

    @property
    def muted(self) -> bool:
        """Whether all videos are to be seen without sound."""
        return all(player.video.muted for player in self.players)


def trial_page(study: Study, trial: ShownTrial) -> TrialPage:
    """Return what the page of `trial` shows."""
    questions = asked_questions(study, trial)
    players = [
        Player(
            label=_label(video),
            video=video,
            questions=tuple(each for each in questions if (each.stimulus,) == video.shows),
        )
        for video in trial.videos
    ]
    return TrialPage(
        layout=_layout(questions, players),
        reference=next((player for player in players if player.video.shows == (0,)), None),
        players=tuple(player for player in players if player.video.shows != (0,)),
        questions=tuple(question for question in questions if question.stimulus is None),
        widgets=frozenset(question.widget for question in questions),
    )


def _label(video: ShownVideo) -> str:
    if video.shows == (0,):
        return _("Reference")
    return letter(video.shows[0]) if len(video.shows) == 1 else ""


def _layout(questions: list[AskedQuestion], players: list[Player]) -> Layout:
    if any(not player.label for player in players):
        return "composed"
    if any(question.widget == "ranking" for question in questions):
        return "ranking"
    return "rating" if any(question.stimulus for question in questions) else "pair"
