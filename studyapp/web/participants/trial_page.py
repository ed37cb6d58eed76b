"""What the page of a trial shows: layout, players and questions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

from markupsafe import Markup, escape

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

PREFERENCE_LABELS: Final[Mapping[int, tuple[tuple[int, Message], ...]]] = {
    2: ((-1, Message("A")), (1, Message("B"))),
    3: ((-1, Message("A")), (0, NO_DIFFERENCE), (1, Message("B"))),
    5: (
        (-2, Message("clearly A")),
        (-1, Message("slightly A")),
        (0, NO_DIFFERENCE),
        (1, Message("slightly B")),
        (2, Message("clearly B")),
    ),
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


STRONG: Final = Markup('<strong class="emotion">{}</strong>')


@dataclass(frozen=True, kw_only=True)
class AskedQuestion:
    """A question as a trial asks it.

    Attributes
    ----------
    number : int
        Its number on the page, the same for every video that it asks about.
    stimulus : int or None
        The stimulus that it asks about; None for the whole trial.
    text : Markup
        What it asks, with the emotion emphasised.
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
    text: Markup
    widget: Widget
    asks: tuple[Ask, ...]
    labels: Labels
    reasons: tuple[tuple[str, str], ...]

    @property
    def letter(self) -> str:
        """The label of its stimulus; empty for the whole trial."""
        return "" if self.stimulus is None else letter(self.stimulus)


def letter(number: int) -> str:
    """Return the label of stimulus `number`: A for 1."""
    return chr(ord("A") + number - 1)


def emphasised(text: str, place: str, words: str) -> Markup:
    """Return `text` with emphasised `words` wherever it holds `place`."""
    return escape(text).replace(place, STRONG.format(words))


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
        text = emphasised(question.text, "{emotion}", say(EMOTION_WORDS[trial.emotion]))
    else:
        text = _instruction(widget, labels, trial.instructed, first=first)
    return AskedQuestion(
        name=question.name,
        number=number,
        stimulus=None if ranking else asks[0].stimulus,
        text=text,
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


def _instruction(widget: Widget, labels: Labels, instructed: int, *, first: bool) -> Markup:
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

REFERENCE: Final = (0,)


def trial_page(study: Study, trial: ShownTrial) -> dict[str, Any]:
    """Return what the template of a trial shows.

    Returns
    -------
    dict
        ``layout``; the player ``reference`` that is shown apart and not judged, or None; the
        ``players`` that are judged, in order, each with ``label``, ``video`` and the ``questions``
        about it alone; ``questions`` about the whole trial; ``widgets``, how all of them are
        answered; ``boxes``, how many videos stand beside each other; and whether all of them are
        ``muted``.
    """
    questions = asked_questions(study, trial)
    players = [
        {
            "label": _label(video),
            "video": video,
            "questions": [each for each in questions if (each.stimulus,) == video.shows],
        }
        for video in trial.videos
    ]
    first = 1 if trial.videos[0].shows == REFERENCE else 0
    return {
        "layout": _layout(trial, questions),
        "reference": players[0] if first else None,
        "players": players[first:],
        "questions": [question for question in questions if question.stimulus is None],
        "widgets": {question.widget for question in questions},
        "boxes": len(players),
        "muted": all(video.muted for video in trial.videos[first:]),
    }


def _label(video: ShownVideo) -> str:
    """Return A, B, … or Reference; nothing for a composed pair, whose picture holds its labels."""
    if video.shows == REFERENCE:
        return _("Reference")
    return letter(video.shows[0]) if len(video.shows) == 1 else ""


def _layout(trial: ShownTrial, questions: list[AskedQuestion]) -> Layout:
    if any(len(video.shows) > 1 for video in trial.videos):
        return "composed"
    if any(question.widget == "ranking" for question in questions):
        return "ranking"
    return "rating" if any(question.stimulus for question in questions) else "pair"
