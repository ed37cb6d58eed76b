"""The fields of a trial's form: read, and refused in words where they cannot be accepted."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from studyapp.session.refusal import UnacceptableError
from studyapp.study.design.asking import AnswerKey, Answers, Ask, Trial
from studyapp.study.design.message import Message
from studyapp.study.settings.study import Study

Fields = Mapping[str, Sequence[str]]
"""A form as it was sent: every value of every name."""

WHOLE_NUMBER: Final = re.compile(r"-?[1-9][0-9]{0,2}|0")


@dataclass(frozen=True, kw_only=True)
class Given:
    """The answers of one trial."""

    values: Answers
    reasons: Mapping[AnswerKey, tuple[str, ...]]

    def stored(self) -> dict[AnswerKey, tuple[int, tuple[str, ...]]]:
        """Return value and reasons of every answer."""
        return {key: (value, self.reasons.get(key, ())) for key, value in self.values.items()}


def read_fields(study: Study, trial: Trial, fields: Fields) -> Given:
    """Return the answers in `fields`.

    Raises
    ------
    UnacceptableError
        If one is missing, unknown or out of range, or they do not go together.
    """
    asks = study.asks(trial)
    known = {name for ask in asks for name in (ask.field, ask.reasons_field)}
    if set(fields) - known:
        raise UnacceptableError(
            "The form held an answer to a question that this study does not ask.",
            "Please reload the page and answer the questions shown.",
        )
    for ask in asks:
        if fields.get(ask.field):
            _check_value(ask, fields[ask.field])
    _check_complete(asks, fields)
    values = {ask.key: int(fields[ask.field][0]) for ask in asks}
    problem = study.problem(trial, values)
    if problem is not None:
        raise UnacceptableError(
            "{problem}", "Please look at it again; your answers are kept.", problem=problem
        )
    return Given(values=values, reasons={ask.key: _reasons(ask, fields) for ask in asks})


def _check_value(ask: Ask, given: Sequence[str]) -> None:
    right = len(given) == 1 and WHOLE_NUMBER.fullmatch(given[0]) and int(given[0]) in ask.values
    if not right:
        raise UnacceptableError(
            "An answer is not one of the choices.",
            "Please choose one of the choices for every question.",
        )


def _check_complete(asks: Sequence[Ask], fields: Fields) -> None:
    questions = list(dict.fromkeys(ask.question for ask in asks))
    missing = tuple(
        _named(ask, questions.index(ask.question) + 1) for ask in asks if not fields.get(ask.field)
    )
    if len(missing) == 1:
        raise UnacceptableError(
            "Question {number} is not answered yet.",
            "Please choose an answer; the others you gave are kept.",
            number=missing[0],
        )
    if missing:
        raise UnacceptableError(
            "Questions {numbers} are not answered yet.",
            "Please choose an answer to each; the others you gave are kept.",
            numbers=missing,
        )


def _named(ask: Ask, number: int) -> Message | int:
    """Return what an answer is called: its question's number, and the video it is about."""
    if ask.stimulus is None:
        return number
    letter = chr(ord("A") + ask.stimulus - 1)
    return Message("{number} about {letter}", number=number, letter=letter)


def _reasons(ask: Ask, fields: Fields) -> tuple[str, ...]:
    ticked = fields.get(ask.reasons_field, ())
    if not set(ticked) <= set(ask.reasons):
        raise UnacceptableError(
            "A reason was ticked that this question does not offer.",
            "Please reload the page and choose among the reasons shown.",
        )
    return tuple(name for name in ask.reasons if name in ticked)
