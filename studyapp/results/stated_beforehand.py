"""What a study stated before its first participant came: whom it leaves out, how it decides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import pandas as pd
from sqlalchemy import select
from sqlalchemy.orm import Session

from analysis.answers.exclusion_rules import ExclusionRule, excluded_by_hand
from motion.errors import InputError, listed
from studyapp.database.tables import StudyVersion
from studyapp.study.settings.exclusions import ExclusionSection
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.study import Study


def stated_study(session: Session, version: int) -> Study | None:
    """Return `version` of the study as it was when its first participant came.

    Returns
    -------
    Study or None
        None where there is no such version, or its study file cannot be read any more.
    """
    wanted = select(StudyVersion.definition).where(StudyVersion.number == version)
    return study_of(session.scalars(wanted).first(), version)


def study_of(definition: str | None, version: int) -> Study | None:
    """Return the study that a text of `version` defines; None where it cannot be read any more."""
    if definition is None:
        return None
    try:
        return parse_text(definition, where=f"version {version}")
    except InputError:
        return None


@dataclass(frozen=True, kw_only=True)
class StudyExclusions:
    """The rules of a study, for `analysis.answers.participants.leave_out`.

    Attributes
    ----------
    rules : tuple of ExclusionRule
        In order: of the study file, then of researchers who exclude by hand. Exploratory are the
        latter, and those that the study file did not state before the first participant came.
    planned : tuple of ExclusionRule
        Those that it did state then.
    notes : tuple of str
        How the rules have changed since, in sentences.
    """

    rules: tuple[ExclusionRule, ...]
    planned: tuple[ExclusionRule, ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class ByHand:
    """Whom researchers exclude one by one.

    Attributes
    ----------
    count : int
        How many participants.
    after_look : int
        How many of them were excluded after somebody had looked at results.
    """

    count: int
    after_look: int


def study_exclusions(
    stated: Sequence[ExclusionSection],
    before: Sequence[ExclusionSection] | None = None,
    by_hand: ByHand | None = None,
) -> StudyExclusions:
    """Return the exclusion rules of a study, and which of them are exploratory.

    Parameters
    ----------
    stated : sequence of ExclusionSection
        What the study file says, settled.
    before : sequence of ExclusionSection, optional
        What it said before the first participant came (see `stated_study`); without it, as in a
        rehearsal, everything stated counts as settled then.
    by_hand : ByHand, optional
        Whom researchers have excluded one by one.
    """
    planned = stated if before is None else before
    then = {each.shorthand() for each in planned}
    return StudyExclusions(
        rules=(
            *(
                each.to_rule() if each.shorthand() in then else each.to_rule().as_exploratory()
                for each in stated
            ),
            *((excluded_by_hand(),) if by_hand else ()),
        ),
        planned=tuple(each.to_rule() for each in planned),
        notes=(*_changes(planned, stated), *_decisions(by_hand)),
    )


def decided_by_hand(study_sessions: pd.DataFrame) -> ByHand | None:
    """Return how many participants researchers exclude; None where it is nobody.

    Parameters
    ----------
    study_sessions : DataFrame
        See `StoredAnswers`.
    """
    excluded = study_sessions[study_sessions["excluded_because"] != ""]
    if excluded.empty:
        return None
    return ByHand(count=len(excluded), after_look=int(excluded["excluded_after_look"].sum()))


def _decisions(by_hand: ByHand | None) -> tuple[str, ...]:
    if by_hand is None:
        return ()
    people = "1 participant" if by_hand.count == 1 else f"{by_hand.count} participants"
    seen = "before anybody had looked at results"
    if by_hand.after_look:
        whom = "" if by_hand.after_look == by_hand.count else f"{by_hand.after_look} of them "
        seen = f"{whom}after somebody had looked at results"
    return (f"Researchers excluded {people} by hand, {seen}.",)


def _changes(
    before: Sequence[ExclusionSection], stated: Sequence[ExclusionSection]
) -> tuple[str, ...]:
    then, today = ([each.shorthand() for each in rules] for rules in (before, stated))
    came = [rule for rule in today if rule not in then]
    went = [rule for rule in then if rule not in today]
    notes = []
    if came:
        notes.append(
            f"Exclusion by {listed(came)} was not in the study file when the first participant "
            "came: it is exploratory."
        )
    if went:
        notes.append(
            f"Exclusion by {listed(went)} was in the study file when the first participant came, "
            "and has been taken out of it since."
        )
    return tuple(notes)


def notes_on(key: str, study: Study, before: Study | None) -> tuple[str, ...]:
    """Say where a setting of the report was not stated beforehand, in sentences.

    Parameters
    ----------
    key : str
        Its name in the study file: ``margin`` or ``family``.
    before : Study or None
        The study as it was when its first participant came; None where that is not known.
    """
    value = getattr(study, key)
    if value is None or before is None or getattr(before, key) == value:
        return ()
    name = f"The margin of {value:g}" if key == "margin" else f"The {key} “{value}”"
    return (
        f"{name} was not in the study file when the first participant came: its tests are "
        "exploratory.",
    )
