"""What a study stated before its first participant arrived, and what changed since."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import pandas as pd
from sqlalchemy import select
from sqlalchemy.orm import Session

from analysis.answers.exclusion_rules import ExclusionRule, excluded_by_hand
from motion.errors import InputError, listed
from studyapp.database.tables.study_session import StudyVersion
from studyapp.results.stored_answers import Answers
from studyapp.study.settings.exclusions import ExclusionSection
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.study import Study

UNREADABLE: Final = (
    "The study file of the first participant cannot be read: what it stated is not known, and no "
    "exclusion rule, margin or family counts as planned."
)


def stated_study(session: Session, version: int) -> Study | None:
    """Return `version` of the study as its first participant saw it; None if unreadable."""
    definition = select(StudyVersion.definition).where(StudyVersion.number == version)
    return parse_version(session.scalars(definition).one(), version)


def parse_version(definition: str, version: int) -> Study | None:
    """Return the study of `definition`; None if it is no longer readable."""
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
        The rules of the study file, then exclusions by hand. The latter, and rules that were added
        after the first participant arrived, are exploratory.
    planned : tuple of ExclusionRule
        The rules before the first participant arrived.
    notes : tuple of str
        Sentences about changes since then.
    """

    rules: tuple[ExclusionRule, ...]
    planned: tuple[ExclusionRule, ...]
    notes: tuple[str, ...]


def exclusions_of(study: Study, answers: Answers) -> StudyExclusions:
    """Return the exclusion rules of `study`, those before its first participant, and by hand.

    Of a rehearsal, all rules of the study file were planned. If the study file of the first
    participant cannot be read, none were.
    """
    stated = planned = study.settled_exclusions
    changes: tuple[str, ...] = ()
    if answers.origin == "participants":
        if answers.stated is None:
            planned, changes = (), (UNREADABLE,)
        else:
            planned = answers.stated.settled_exclusions
            changes = _changes(planned, stated)
    by_hand = () if answers.stored is None else _decisions(answers.stored.study_sessions)
    planned_names = {rule.shorthand() for rule in planned}
    return StudyExclusions(
        rules=(
            *(
                rule.to_rule()
                if rule.shorthand() in planned_names
                else rule.to_rule().as_exploratory()
                for rule in stated
            ),
            *((excluded_by_hand(),) if by_hand else ()),
        ),
        planned=tuple(rule.to_rule() for rule in planned),
        notes=(*changes, *by_hand),
    )


def _decisions(study_sessions: pd.DataFrame) -> tuple[str, ...]:
    """Say how many participants researchers exclude by hand, and when they decided it."""
    excluded = study_sessions["excluded_because"] != ""
    count = int(excluded.sum())
    after_look = int(study_sessions.loc[excluded, "excluded_after_look"].sum())
    if not count:
        return ()
    people = "1 participant" if count == 1 else f"{count} participants"
    seen = "before anybody had looked at results"
    if after_look:
        whom = "" if after_look == count else f"{after_look} of them "
        seen = f"{whom}after somebody had looked at results"
    return (f"Researchers excluded {people} by hand, {seen}.",)


def _changes(
    before: Sequence[ExclusionSection], stated: Sequence[ExclusionSection]
) -> tuple[str, ...]:
    old, new = ([rule.shorthand() for rule in rules] for rules in (before, stated))
    added = [rule for rule in new if rule not in old]
    removed = [rule for rule in old if rule not in new]
    notes = []
    if added:
        notes.append(
            f"Exclusion by {listed(added)} was added to the study file after the first participant "
            "arrived: it is exploratory."
        )
    if removed:
        notes.append(
            f"Exclusion by {listed(removed)} was removed from the study file after the first "
            "participant arrived."
        )
    return tuple(notes)


def change_notes(study: Study, before: Study | None) -> Iterator[str]:
    """Yield a note on each setting of the report that changed after the first participant arrived.

    `before` is the study as its first participant saw it, if known; otherwise the notes of
    `exclusions_of` say that nothing counts as planned.
    """
    for key in ("margin", "family"):
        value = getattr(study, key)
        if value is not None and before is not None and getattr(before, key) != value:
            name = f"The margin of {value:g}" if key == "margin" else f"The {key} “{value}”"
            yield (
                f"{name} was set after the first participant arrived: its tests are exploratory."
            )
