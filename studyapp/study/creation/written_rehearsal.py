"""Whom a rehearsal simulates, written in single words, as on the command line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pydantic import ValidationError

from motion.errors import InputError
from studyapp.study.settings.rehearsal import EVERY_QUESTION, SHARES, Rehearsal
from studyapp.study.settings.study import Study
from studyapp.study.settings.validation import explain

SHARE_REMEDY = f"Write KIND=SHARE, with one of {', '.join(SHARES)} and a number from 0 to 1"
STRENGTH_REMEDY = "Write CONDITION=LOGITS, or CONDITION:QUESTION=LOGITS for one question"


def with_others(study: Study, shares: Sequence[str], strengths: Sequence[str]) -> Study:
    """Return `study` with another ``[rehearsal]`` than its file states.

    Parameters
    ----------
    shares : sequence of str
        Such as ``careless=0.2``.
    strengths : sequence of str
        Such as ``static=-0.5``, or ``static:emotion=-0.5`` for one question.

    Raises
    ------
    InputError
        If one is not written like that, or cannot be simulated.
    """
    if not shares and not strengths:
        return study
    stated: dict[str, Any] = study.rehearsal.model_dump()
    for text in shares:
        kind, share = _parts(text, "--share", SHARE_REMEDY)
        kind = kind.replace("-", "_")
        if kind not in SHARES:
            raise InputError(f"unknown kind {kind!r}", where=f"--share {text}", remedy=SHARE_REMEDY)
        stated[kind] = share
    for text in strengths:
        about, logits = _parts(text, "--strength", STRENGTH_REMEDY)
        condition, _, question = about.partition(":")
        own = stated["strength"].get(condition, {}) if question else {}
        stated["strength"][condition] = {**own, (question or EVERY_QUESTION): logits}
    try:
        made = Rehearsal.model_validate(stated)
    except ValidationError as error:
        raise InputError(
            explain(error), where="--share, --strength", remedy="Correct these options"
        ) from None
    conditions = (*study.conditions, study.catch.condition)
    if problems := made.problems(conditions, [question.name for question in study.questions]):
        raise InputError(
            "; ".join(problems), where="--strength", remedy="Name what is in the study file"
        )
    return study.model_copy(update={"rehearsal": made})


def _parts(text: str, option: str, remedy: str) -> tuple[str, float]:
    name, sign, number = text.partition("=")
    try:
        value = float(number)
    except ValueError:
        sign, value = "", 0.0
    if not sign or not name.strip():
        raise InputError(f"{text!r} cannot be read", where=option, remedy=remedy)
    return name.strip(), value
