"""What a study stated before its first participant arrived, and what changed since."""

from dataclasses import dataclass

from sqlalchemy import select
from sqlalchemy.orm import Session

from analysis.answers.exclusion_rules import ExclusionRule, excluded_by_hand
from analysis.report.texts import paragraphs
from motion.errors import InputError
from studyapp.database.tables.study_session import StudyVersion
from studyapp.results.stored_answers import Answers
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.study import Study


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
    is_known = answers.origin != "participants" or answers.stated is not None
    if answers.origin == "participants":
        planned = () if answers.stated is None else answers.stated.settled_exclusions
    old, new = ([rule.shorthand() for rule in rules] for rules in (planned, stated))
    after_look: list[bool] = []
    if answers.stored is not None:
        sessions = answers.stored.study_sessions
        after_look = sessions.loc[
            sessions["excluded_because"] != "", "excluded_after_look"
        ].tolist()
    return StudyExclusions(
        rules=(
            *(
                rule.to_rule() if name in old else rule.to_rule().as_exploratory()
                for name, rule in zip(new, stated, strict=True)
            ),
            *((excluded_by_hand(),) if after_look else ()),
        ),
        planned=tuple(rule.to_rule() for rule in planned),
        notes=paragraphs(
            "beforehand.exclusions",
            is_known=is_known,
            added=[rule for rule in new if rule not in old],
            removed=[rule for rule in old if rule not in new],
            by_hand=len(after_look),
            after_look=sum(after_look),
        ),
    )


def change_notes(study: Study, before: Study | None) -> tuple[str, ...]:
    """Return a note on each setting of the report that changed after the first participant arrived.

    `before` is the study as its first participant saw it, if known; otherwise the notes of
    `exclusions_of` say that nothing counts as planned.
    """
    changed = {
        key: None if before is None or getattr(before, key) == value else value
        for key, value in (("margin", study.margin), ("family", study.family))
    }
    return paragraphs("beforehand.settings", **changed)
